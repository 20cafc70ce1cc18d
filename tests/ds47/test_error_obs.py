"""Which error OBs a CPU needs, in IMPORT.md and in check --program.

Expected: TIA Portal information system, "Organization blocks (S7-300, S7-400)" (STOP without OB82, OB83, OB86, OB121,
OB122; on S7-300 OB83 only with CPUs 31x PN/DP) and "OB start events" of the S7-1500 (STOP without OB121 alone).
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from plcgen import api
from plcgen.s7.cpu.sources import check_program, find_documents, find_sources
from plcgen.s7.scl.dialect import Dialect

SPEC = """
plc: {{name: Lost, family: {family}, toolchain: {toolchain}{cpu}}}
drives: {{pump: {{device: sinamics-s120, {address}: 256}}}}
jobs: {{read_speed: {{drive: pump, read: [r21]}}}}
"""
ALL = ["82", "83", "86", "121", "122"]


def generated(folder: Path, family: str, toolchain: str, cpu: str = "") -> Path:
    """A project with one job for a CPU."""
    key = "address" if family in {"s7-300", "s7-400"} else "hardware_id"
    text = SPEC.format(family=family, toolchain=toolchain, cpu=f", cpu: {cpu}" if cpu else "", address=key)
    (folder / "lost.yaml").write_text(text, "utf-8")
    made = api.generate(folder / "lost.yaml", folder / "out")
    assert made.ok, made.diagnostics
    return folder / "out"


@pytest.mark.parametrize(
    ("family", "toolchain", "cpu", "obs"),
    [
        ("s7-300", "step7-v5", "", ALL),
        ("s7-300", "tia-v16", "315-2DP", ["82", "86", "121", "122"]),
        ("s7-300", "tia-v16", "319-3 PN/DP", ALL),
        ("s7-400", "tia-v16", "414-2", ALL),
        ("s7-1500", "tia-v19", "", []),
        ("s7-1200", "tia-v17", "", []),
    ],
)
def test_the_guide_lists_what_the_cpu_needs(
    family: str, toolchain: str, cpu: str, obs: list[str], tmp_path: Path
) -> None:
    """A row for each OB without which the CPU stops; the others name OB121 of the S7-1500 and stay in RUN."""
    text = (generated(tmp_path, family, toolchain, cpu) / "IMPORT.md").read_text("utf-8")
    assert re.findall(r"^\| OB(\d+) \|", text, re.MULTILINE) == obs
    plain = " ".join(text.split())
    assert ("Without OB121 this CPU goes to STOP" in plain) == (family == "s7-1500")
    assert ("has no OB121 and no OB122" in plain) == (family == "s7-1200")
    assert ("OB85 as well" in plain) == bool(obs)


def test_a_document_of_an_ob_counts(tmp_path: Path) -> None:
    """OB86 in ladder logic, exported under a German name: only its number tells."""
    out = generated(tmp_path, "s7-300", "tia-v16")

    def missing() -> list[str]:
        found = check_program(find_sources(out), Dialect.TIA_300_400, documents=find_documents(out)).diagnostics
        return [d.message.split(": ")[0] for d in found if d.code == "PG845"]

    assert missing() == ["the program has no OB82, OB83, OB86, OB121, OB122"]
    (out / "Ausfall.xml").write_text(
        '<Document><Engineering version="V16" /><SW.Blocks.OB ID="0"><AttributeList><Interface>'
        '<Sections xmlns="http://www.siemens.com/automation/Openness/SW/Interface/v3"><Section Name="Temp" />'
        "</Sections></Interface><Name>Stationsausfall</Name><Number>86</Number>"
        "<ProgrammingLanguage>LAD</ProgrammingLanguage>"
        "</AttributeList></SW.Blocks.OB></Document>",
        "utf-8",
    )
    assert missing() == ["the program has no OB82, OB83, OB121, OB122, unless Stationsausfall is one of them"]
