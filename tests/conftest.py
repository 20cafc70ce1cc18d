"""What all tests have in common: nothing depends on how busy the machine is (work.py counts calls instead)."""

from __future__ import annotations

import gc
import json
import os
import shutil
import signal
import sys
from collections.abc import Callable, Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

from plcgen.__main__ import collect_rarely
from plcgen.s7.cpu import program
from plcgen.s7.cpu.compiler import block
from tests.sarif_rules import refused

settings.register_profile("plcgen", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("plcgen")
collect_rarely()  # as the command line does
# A shell starts jobs in the background with SIGINT ignored, and their children inherit it.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

Install = Callable[[str, str, str, str | Path], None]
PROOF = Path(__file__).parent / "proof"
QUICK = {"test_idle.py", "test_independence.py", "test_reach.py", "test_twins.py"}
"""Of the tests there, those that run no matrix."""
ON_EVERY_PYTHON = "test_every_project_passes_every_scenario_with_full_coverage[s7-1500_s210_restore]"
"""One whole matrix is among the fast tests: every Python verifies a project."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Whatever runs fault matrices is slow."""
    for item in items:
        if PROOF in item.path.parents and item.path.name not in QUICK and item.name != ON_EVERY_PYTHON:
            item.add_marker(pytest.mark.slow)


def pytest_collection_finish() -> None:
    """The tests themselves stay to the end: nobody looks for garbage among them."""
    gc.collect()
    gc.freeze()


@pytest.fixture(autouse=True, scope="session")
def _one_process() -> Iterator[None]:
    """The tests share out the cores among themselves: what one of them verifies stays in its process."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "cpu_count", lambda: 1)
        yield


@pytest.fixture(autouse=True, scope="session")
def _nothing_is_kept() -> Iterator[None]:
    """No verdict comes from a cache, and the user's own is left alone; a test of the cache names a folder."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PLCGEN_CACHE", "off")
        yield


_parse, _compile = lru_cache(100)(program.parse), lru_cache(500)(compile)


@pytest.fixture(autouse=True)
def _proofs_parse_nothing_again(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where folders are proven that differ in one file, a source that was parsed and compiled is known."""
    if "proof" in request.path.parts:
        monkeypatch.setattr(program, "parse", _parse)
        monkeypatch.setattr(block, "compile", _compile, raising=False)


LARGEST = 200_000
"""Characters of a JSON result beyond which nobody looks at its shape: a run of thousands of scans takes minutes."""


@pytest.fixture(autouse=True, scope="session")
def _results_have_their_shape() -> Iterator[None]:
    """Every JSON result of every test is what ``plcgen schema output`` says, every SARIF result what GitHub takes."""
    from plcgen.report.registry import OutputFormat

    render, known = OutputFormat.render, []

    def checked(self: OutputFormat, kind: str, result: Any, view: Any) -> str:
        text = render(self, kind, result, view)
        if self.name == "json" and len(text) <= LARGEST:
            if not known:
                from jsonschema import Draft202012Validator

                from plcgen.report.shapes import output_schema

                known.append(Draft202012Validator(output_schema()))
            wrong = [f"{list(one.absolute_path)}: {one.message}" for one in known[0].iter_errors(json.loads(text))]
            assert not wrong, wrong[:5]
        if self.name == "sarif" and len(text) <= LARGEST:
            refusals = [*refused(json.loads(text))]
            assert not refusals, refusals[:5]
        return text

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(OutputFormat, "render", checked)
        yield


@pytest.fixture
def distribution(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Callable[[str, str, str, str | Path], None]]:
    """Returns what installs a distribution: a module, as text or as the folder of a package, with an entry point."""
    from plcgen.base.plugins import offered
    from plcgen.ds47.registry import kinds
    from plcgen.ds47.schema import drive_sections
    from plcgen.project.registry import protocols
    from plcgen.project.shape import spec_model

    site, modules = tmp_path / "site", set[str]()
    site.mkdir()
    monkeypatch.syspath_prepend(str(site))
    caches = (offered, kinds, drive_sections, spec_model, protocols)

    def forget() -> None:
        for cached in caches:
            cached.cache_clear()
        for module in modules:
            sys.modules.pop(module, None)

    def install(module: str, group: str, entry: str, code: str | Path) -> None:
        if isinstance(code, Path):
            shutil.copytree(code, site / module)
        else:
            (site / f"{module}.py").write_text(code, "utf-8")
        info = site / f"{module}-1.0.dist-info"
        info.mkdir(exist_ok=True)
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {module}\nVersion: 1.0\n")
        (info / "entry_points.txt").write_text(f"[{group}]\n{entry}\n")
        modules.add(module)
        forget()

    yield install
    forget()
