"""PPI masters: the telegrams of the seed document lie in the generated data blocks, byte for byte."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from plcgen import api
from plcgen.ppi.plan.jobs import request_fields
from plcgen.ppi.plan.nouns import PpiPlan
from plcgen.proof.folder import read_folder
from plcgen.s7.layout.image import image
from tests.projects import ROOT
from tests.yaml_files import read_yaml

VECTORS = read_yaml((ROOT / "tests" / "vectors" / "ppi.yaml").read_text("utf-8"))["frames"]
TARGETS = {
    "t15": ("s7-1500", "tia-v19", "cm-ptp", "port: 270"),
    "t12": ("s7-1200", "tia-v17", "cm1241", "port: 270"),
    "t3": ("s7-300", "tia-v16", "cp341", "address: 256"),
    "v5": ("s7-300", "step7-v5", "cp341", "address: 256"),
}
_VALUES = {"01": "true", "00": "false", "10": "16", "FF": "255", "FF FF": "65535", "FF FF FF FF": "4294967295"}


def seed_requests() -> dict[str, tuple[str, str]]:
    """Requests of the seed with 6Ch: job as a spec writes it, and the telegram in hexadecimal digits."""
    found: dict[str, tuple[str, str]] = {}
    for row in VECTORS:
        kind, pdu = next(iter(row["frame"])), row.get("pdu")
        if kind != "variable" or row["frame"][kind] != [2, 0, 0x6C] or row["id"].endswith("unpadded"):
            continue
        addresses = row.get("text", [])
        if isinstance(pdu, str):
            job = f"{pdu}: true"
        elif "read" in pdu:
            job = f"read: {addresses}, merge: false"
        elif "write" in pdu:
            job = f"write: {{{addresses[0]}: {_VALUES[pdu['write'][0][1]]}}}"
        else:
            continue
        found[row["id"]] = job, row["hex"]
    return found


SEED = seed_requests()


def spec_of(target: str) -> str:
    """A spec with one job for each request of the seed."""
    family, toolchain, module, port = TARGETS[target]
    jobs = "".join(f"      j{n}: {{station: s, {job}}}\n" for n, (job, _) in enumerate(SEED.values()))
    return (
        f"plc: {{name: Seed, family: {family}, toolchain: {toolchain}}}\n"
        f"ppi:\n  m:\n    module: {module}\n    {port}\n    stations: {{s: {{address: 2}}}}\n    jobs:\n{jobs}"
    )


def generated(target: str, folder: Path) -> Any:
    spec = folder / "seed.yaml"
    spec.write_text(spec_of(target), encoding="utf-8")
    result = api.generate(spec, folder / "out")
    assert result.ok, [f"{d.span} {d.code} {d.message}" for d in result.diagnostics]
    return api.check(spec).project


def test_the_seed_has_its_requests() -> None:
    """Nine reads, seven writes, three more reads, RUN and STOP: nothing is left out by accident."""
    assert len(SEED) == 21


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
def test_the_requests_of_the_seed_lie_in_the_tables(target: str, tmp_path: Path) -> None:
    """Text sources and SimaticML: length in byte 0, then exactly the bytes that the document prints."""
    project = generated(target, tmp_path)
    folder = read_folder(tmp_path / "out", project.target)
    tables = [folder.text] if project.target.v5 else [folder.text, folder.xml]
    for job, (_, text) in zip(project.plan(PpiPlan).masters[0].jobs, SEED.values(), strict=True):
        expected = bytes.fromhex(text)
        for blocks in tables:
            data = bytes(image(blocks[job.telegrams[0].request.db.name.upper()], blocks))
            assert data[0] == len(expected)
            assert data[1 : 1 + len(expected)].hex(" ") == expected.hex(" ")


@pytest.mark.parametrize("target", TARGETS)
def test_every_word_of_a_table_has_an_even_offset(target: str, tmp_path: Path) -> None:
    """Otherwise a compiler would put a gap in front of it."""
    project = generated(target, tmp_path)
    for telegram in project.plan(PpiPlan).masters[0].telegrams:
        for field in (field for buffer in telegram.buffers for field in buffer.fields):
            assert field.size == 1 or field.offset % 2 == 0, field.name
        ends = [(f.offset, f.offset + f.size) for f in request_fields(telegram.request.data, telegram.items)]
        assert [end for _, end in ends[:-1]] == [start for start, _ in ends[1:]]
        assert ends[-1][1] == len(telegram.request.data) + 1


def test_a_spec_without_masters_does_not_import_them() -> None:
    """Start-up and drive jobs pay nothing for PPI."""
    import subprocess
    import sys

    code = (
        "import sys\n"
        "from pathlib import Path\n"
        "from plcgen import api\n"
        f"assert api.check(Path({str(ROOT / 'specs' / 's7-300_mm440_dp.yaml')!r})).ok\n"
        "print([name for name in sys.modules if '.ppi.' in name])\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
