"""A verification in parts: on executors of the caller's, on a Dask cluster."""

from __future__ import annotations

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

from plcgen import api
from plcgen.base.diagnostics import DiagnosticError
from plcgen.cli.main import run as run_main
from plcgen.proof.checks import Verification
from plcgen.proof.sharing import Sharing

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
        assert Sharing(executor=executor).results(task, 8) == list(range(8))
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
                assert Sharing(executor=executor).results(task, 4) == list(range(4))
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
