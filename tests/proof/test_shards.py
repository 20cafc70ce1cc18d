"""A verification in shares: on machines of a CI matrix, on executors of the caller's, on a Dask cluster."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from jsonschema import Draft202012Validator

from plcgen import api
from plcgen.base.diagnostics import DiagnosticError
from plcgen.cli.main import run as run_main
from plcgen.proof.checks import Verification
from plcgen.proof.sharing import Sharing
from plcgen.report.shapes import output_schema

SPEC = """
plc: {name: Plant, family: s7-1500, toolchain: tia-v19}
drives:
  one: {device: sinamics-g120, hardware_id: 270}
jobs:
  get: {drive: one, read: [P1121]}
"""


@pytest.fixture(scope="module")
def plant(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Verification]:
    """A generated spec, and what one process says of it."""
    spec = tmp_path_factory.mktemp("plant") / "plant.yaml"
    spec.write_text(SPEC, "utf-8")
    assert api.generate(spec).ok
    with ThreadPoolExecutor(1) as executor:
        return spec, api.verify(spec, executor=executor)


@dataclass(frozen=True)
class Done:
    """How a call of the command line ended, and what it said."""

    exit_code: int
    output: str
    errors: str


def run(*arguments: object) -> Done:
    with CliRunner().isolation() as streams:
        code = run_main([str(each) for each in arguments])
        return Done(code, *(stream.getvalue().decode() for stream in streams[:2]))


@pytest.fixture(scope="module")
def shards(plant: tuple[Path, Verification]) -> Path:
    """The three files of three shards."""
    folder = plant[0].parent / "shards"
    folder.mkdir()
    for number in (1, 2, 3):
        done = run("verify", plant[0], "--shard", f"{number}/3", "--output", folder / f"{number}.json")
        assert done.exit_code == 0, done.output
    return folder


def test_merged_shards_are_the_whole(plant: tuple[Path, Verification], shards: Path) -> None:
    """The same report as without shards; nothing is executed; the files have the published shape."""
    files = sorted(shards.iterdir())
    assert api.verify(plant[0], shards=files) == plant[1]
    done = run("verify", plant[0], "--merge", shards, "--json")
    assert done.exit_code == 0
    assert json.loads(done.output)["summary"] == json.loads(run("verify", plant[0], "--json").output)["summary"]
    known = Draft202012Validator(output_schema())
    sizes = []
    for path in files:
        known.validate(json.loads(path.read_text()))
        sizes.append(len(json.loads(path.read_text())["parts"]))
    assert max(sizes) - min(sizes) <= 1  # equal shares


def test_shards_that_make_no_whole_are_an_error(plant: tuple[Path, Verification], shards: Path, tmp_path: Path) -> None:
    """One is missing, there twice, of other options or files, of another number, or none: each is named."""
    files = sorted(shards.iterdir())

    def said(*chosen: Path, **options: Any) -> str:
        found = api.verify(plant[0], shards=chosen, **options)
        assert {d.code for d in found.diagnostics} == {"PG625"}
        assert not found.ok
        return " | ".join(d.message for d in found.diagnostics)

    assert said(*files[:2]) == "missing: shard 3/3"
    assert said(*files, files[0]).startswith("shard 1/3 is given twice")
    assert said(*files, faults="full").count("made from another spec, other files or options") == 3
    other = json.loads(files[2].read_text()) | {"shard": 4, "of": 4}
    (tmp_path / "4.json").write_text(json.dumps(other))
    assert said(*files[:2], tmp_path / "4.json") == "shard 4/4 together with shards of 3"
    (tmp_path / "4.json").write_text("[]")
    assert said(tmp_path / "4.json") == "not the file of a shard"
    source = plant[0].parent / "plant_generated/scl/Get.scl"
    before = source.read_bytes()
    source.write_bytes(before + b"\n")
    try:
        assert "other files" in said(*files)
    finally:
        source.write_bytes(before)


def test_a_shard_that_finds_something_fails(tmp_path: Path) -> None:
    """Exit code 1; the merged report says what, at the file of the folder that is merged."""
    spec = tmp_path / "plant.yaml"
    spec.write_text(SPEC, "utf-8")
    assert api.generate(spec).ok
    source = tmp_path / "plant_generated/scl/Get.scl"
    text = source.read_text("utf-8-sig")
    source.write_text(text.replace("#unit.expected[1] := DW#16#0801", "#unit.expected[1] := DW#16#0601"), "utf-8-sig")
    codes = [
        run("verify", spec, "--shard", f"{n}/2", "--faults", "none", "-o", tmp_path / f"{n}.json").exit_code
        for n in (1, 2)
    ]
    assert codes == [1, 0]
    merged = api.verify(spec, faults="none", shards=[tmp_path / "1.json", tmp_path / "2.json"])
    assert merged == api.verify(spec, faults="none")
    assert any(c.diagnostic and c.diagnostic.span.file == str(source) for c in merged.checks() if c.id == "run.get")


@pytest.mark.parametrize("text", ["0/3", "4/3", "3", "a/b", "1/9999", "1/3/3"])
def test_a_shard_that_cannot_be_is_wrong_use(text: str, tmp_path: Path) -> None:
    """Exit code 2 before anything runs."""
    (tmp_path / "a.yaml").write_text(SPEC)
    done = run("verify", tmp_path / "a.yaml", "--shard", text)
    assert done.exit_code == 2
    assert "shard" in done.errors


def test_the_format_of_a_shard_is_json(tmp_path: Path) -> None:
    """A pipeline that asks for JUnit must not get JSON with that name."""
    (tmp_path / "a.yaml").write_text(SPEC)
    done = run("verify", tmp_path / "a.yaml", "--shard", "1/2", "--format", "junit", "--output", tmp_path / "a.xml")
    assert (done.exit_code, (tmp_path / "a.xml").exists()) == (2, False)
    assert "not junit" in done.errors


def test_an_executor_of_the_caller(plant: tuple[Path, Verification]) -> None:
    """Processes of Python's own pool, which know nothing of the project, give the same report."""
    import multiprocessing

    with ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as executor:
        assert api.verify(plant[0], executor=executor) == plant[1]


# --- Dask -----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def cluster() -> Iterator[str]:
    """Address of a scheduler with two worker processes on this machine."""
    distributed = pytest.importorskip("distributed", reason="the extra cluster is not installed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as made:
        yield made.scheduler_address


def test_a_cluster_says_the_same(plant: tuple[Path, Verification], cluster: str) -> None:
    """Two worker processes behind a scheduler: the same report, byte for byte."""
    assert api.verify(plant[0], scheduler=cluster) == plant[1]
    reports = [run("verify", plant[0], *more).output for more in ((), ("--scheduler", cluster))]
    assert reports[0] == reports[1]


def ended_once(index: int, place: Path) -> int:
    if index == 2 and not place.exists():
        place.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return index


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_a_lost_worker_of_a_cluster_is_told(cluster: str, tmp_path: Path) -> None:
    """Another worker does its part, and a warning names it."""
    from plcgen.proof.cluster import cluster as connected

    notes: list[Any] = []
    with connected(cluster, notes) as executor:
        task: Any = partial(ended_once, place=tmp_path / "dead")
        assert Sharing(executor=executor).results("test", task, 8) == list(range(8))
    assert [(d.code, d.severity.label) for d in notes] == [("PG623", "warning")]


@pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl is not installed")
def test_a_cluster_behind_tls(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Dask's configuration names the certificates of both sides; who has others is told, and nothing runs."""
    distributed = pytest.importorskip("distributed", reason="the extra cluster is not installed")
    import dask

    from plcgen.proof.cluster import cluster as connected

    def certified(name: str) -> dict[str, str]:
        key, certificate = (str(tmp_path / f"{name}.{end}") for end in ("key", "pem"))
        kind = ["req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-subj", "/CN=localhost"]
        subprocess.run(
            ["openssl", *kind, "-nodes", "-days", "1", "-keyout", key, "-out", certificate],
            check=True,
            capture_output=True,
        )
        tls = {f"distributed.comm.tls.{who}.{what}": path
               for who in ("client", "scheduler", "worker")
               for what, path in (("key", key), ("cert", certificate))}  # fmt: skip
        return {**tls, "distributed.comm.tls.ca-file": certificate, "distributed.comm.require-encryption": "true"}

    monkeypatch.setattr("plcgen.proof.cluster.PATIENCE", 3)
    own, other = certified("own"), certified("other")
    with dask.config.set(own):
        made = distributed.LocalCluster(
            n_workers=1, threads_per_worker=1, processes=False, protocol="tls://", dashboard_address=":0",
            security=distributed.Security(),
        )  # fmt: skip
        with made:
            assert made.scheduler_address.startswith("tls://")
            with connected(made.scheduler_address, []) as executor:
                task: Any = partial(ended_once, place=tmp_path)
                assert Sharing(executor=executor).results("test", task, 4) == list(range(4))
            with (
                dask.config.set(other),
                pytest.raises(DiagnosticError, match="cannot be reached"),
                connected(made.scheduler_address, []),
            ):
                raise AssertionError


def test_nobody_at_the_address(plant: tuple[Path, Verification], monkeypatch: pytest.MonkeyPatch) -> None:
    """A diagnostic, no traceback."""
    pytest.importorskip("distributed", reason="the extra cluster is not installed")
    monkeypatch.setattr("plcgen.proof.cluster.PATIENCE", 1)
    found = api.verify(plant[0], scheduler="tcp://127.0.0.1:1")
    assert [d.code for d in found.diagnostics] == ["PG626"]
