"""Files of the user: what a verb may replace, what it leaves behind when it is ended, what it never touches."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import click
import pytest

from plcgen.build.environment import RenderedFile
from plcgen.build.staging import STAGE
from plcgen.cli.main import cli
from plcgen.report import registry
from tests.projects import ROOT

DB = 'DATA_BLOCK "B"\nSTRUCT\n  a : Int;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n'
WRITES = {
    "check": (["job.yaml"], "findings"),
    "verify": (["job.yaml", "--faults", "none"], "verification"),
    "simulate": (["job.yaml", "--scans", "3"], "trace"),
    "layout": (["job.yaml"], "layout"),
    "review": (["job.yaml", "--faults", "none"], "review"),
    "diff": (["a.db", "b.db"], "comparison"),
    "lock": (["b.db", "--check"], "comparison"),
    "audit": (["a.db", "--spec", "job.yaml"], "verification"),
    "schema": (["output"], ""),
    "devices": ([], "answer"),
}
"""Verbs with --output: how they are called, and the kind of their result."""
FOREIGN = {
    "notes.docx": b"PK\3\4 a day of work",
    "data.json": b'{"tool": "another", "measured": [1, 2]}\n',
    "page.html": b"<!DOCTYPE html><title>mine</title>\n",
    "log.txt": b"2026-11-01 plcgen result, as far as I remember\n",
    "no_end": b"one line",
    "binary": bytes(range(256)),
}


def verbs(group: click.Group = cli, path: str = "") -> Iterator[tuple[str, click.Command]]:
    """Every verb with its path."""
    for name in group.list_commands(click.Context(group)):
        found = group.get_command(click.Context(group), name)
        if isinstance(found, click.Group):
            yield from verbs(found, f"{path}{name} ")
        elif found is not None:
            yield f"{path}{name}", found


@pytest.fixture
def work(plcgen, good, tmp_path):
    """A folder with everything that the verbs read."""
    (tmp_path / "a.db").write_text(DB)
    (tmp_path / "b.db").write_text(DB.replace("Int", "Word"))
    assert plcgen("generate", good, "-q").code == 0
    assert plcgen("lock", "a.db", "-q").code == 0
    return tmp_path


def test_every_output_has_a_force() -> None:
    """There is no verb that writes to a file of a name and cannot be told to replace it; the tables here know all."""
    options = {verb: {o for p in found.params for o in p.opts} for verb, found in verbs()}
    with_station = {"ppi backup"}  # tests/ppi: what it does with a file that exists
    assert {verb for verb, own in options.items() if "--output" in own} == set(WRITES) | with_station
    assert all("--force" in options[verb] for verb in {*WRITES, *with_station})
    assert {verb for verb, own in options.items() if "--force" in own} - set(WRITES) - with_station == {
        "new", "generate", "texts", "convert", "catalogue import", "live backup", "ppi migrate",
    }  # fmt: skip


@pytest.mark.parametrize("verb", list(WRITES))
def test_a_foreign_file_is_not_replaced(work: Path, plcgen: Callable, verb: str) -> None:
    """Whatever its name and content; refused with PG501 before any work is done. --force replaces it."""
    args, _ = WRITES[verb]
    for name, data in FOREIGN.items():
        (work / name).write_bytes(data)
        refused = plcgen(verb, *args, "-o", name)
        assert (refused.code, refused.out) == (1, "")
        assert f"error[PG501]: the file exists, and plcgen did not write it\n --> {name}\n" in refused.err
        assert (work / name).read_bytes() == data
    assert plcgen(verb, *args, "-o", name, "--force").code in {0, 1, 2}
    assert (work / name).read_bytes() != data
    assert plcgen(verb, *args, "-o", "/dev/null").code in {0, 1, 2}
    (work / "empty").touch()
    plcgen(verb, *args, "-o", "empty")
    assert (work / "empty").stat().st_size


@pytest.mark.slow
@pytest.mark.parametrize(
    ("verb", "format_"),
    [(verb, name) for verb, (_, kind) in WRITES.items() for name in registry.formats_for(kind)],
)
def test_our_own_results_are_replaced(work: Path, plcgen: Callable, verb: str, format_: str) -> None:
    """A second run writes the same file again, whatever git makes of its line ends; one that was edited is kept.

    CSV has no comments, so no mark: it is replaced with --force only.
    """
    args, _ = WRITES[verb]
    line = [verb, *args, "-f", format_, "-o", "result"]
    result = work / "result"
    first = plcgen(*line)
    assert "wrote result" in first.err
    data = result.read_bytes()
    again = plcgen(*line)
    if format_ == "csv":
        assert "PG501" in again.err
        return
    assert again.err == first.err
    assert result.read_bytes() == data
    result.write_bytes(data.replace(b"\n", b"\r\n"))
    assert "wrote result" in plcgen(*line).err
    assert result.read_bytes() == data
    if format_ in {"json", "sarif"}:
        return
    middle = len(data) // 2
    for edited in (data + b"signed\n", b"signed\n" + data, data[:middle] + b"signed" + data[middle:]):
        result.write_bytes(edited)
        refused = plcgen(*line)
        assert refused.code == 1
        assert "error[PG50" in refused.err
        assert result.read_bytes() == edited


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="/dev as POSIX has it")
def test_stdout_as_a_file(process: Callable, good: str, tmp_path: Path) -> None:
    """``-o /dev/stdout`` into a pipe, or into a file that the shell has opened."""
    piped = process("schema", "-o", "/dev/stdout")
    assert (piped.returncode, json.loads(piped.stdout)["$id"]) == (0, "urn:plcgen:spec:1")
    command = f"exec {sys.executable} -m plcgen schema -q -o /dev/stdout > s.json"
    done = subprocess.run(["sh", "-c", command], cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(ROOT)}, check=False)
    assert done.returncode == 0
    assert (tmp_path / "s.json").read_bytes() == piped.stdout
    assert good


def test_a_file_that_comes_meanwhile_is_kept(work: Path, plcgen: Callable, monkeypatch: pytest.MonkeyPatch) -> None:
    """Somebody saves a file of the name between the look at it and the end of the work."""
    real = registry.OutputFormat.render

    def slowly(*args: object) -> str:
        (work / "report.json").write_text("mine")
        return real(*args)

    monkeypatch.setattr(registry.OutputFormat, "render", slowly)
    refused = plcgen("check", "job.yaml", "--json", "-o", "report.json")
    assert refused.code == 1
    assert "error[PG501]" in refused.err
    assert (work / "report.json").read_text() == "mine"


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
@pytest.mark.parametrize("verb", ["generate", "convert", "texts"])
def test_a_signal_ends_tidily(
    good: str, plcgen: Callable, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, verb: str, number: int, code: int
) -> None:
    """A run into a new folder leaves what others have put there, no stage, and the exit code of the signal."""
    (tmp_path / "a.db").write_text(DB)
    out = tmp_path / "new"
    real = RenderedFile.__init__

    def ended(self: RenderedFile, *args: object, **more: object) -> None:
        real(self, *args, **more)
        if list(out.glob(f"{STAGE}*")) or verb != "generate":
            out.mkdir(exist_ok=True)
            (out / "notes.txt").write_text("a day of work")
            signal.raise_signal(number)

    monkeypatch.setattr(RenderedFile, "__init__", ended)
    args = {"generate": [good, "--out"], "convert": ["a.db", "--to", "xml", "--out"], "texts": ["--out"]}[verb]
    assert plcgen(verb, *args, out).code == code
    assert [each.name for each in out.rglob("*")] == ["notes.txt"]
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL


OTHER_WRITERS = {
    "new": ["FILE"],
    "generate": ["job.yaml", "--out", "FILE"],
    "texts": ["--out", "FILE"],
    "convert": ["a.db", "--to", "xml", "--out", "FILE"],
    "lock": ["a.db", "--out", "FILE"],
    "catalogue import": ["list.csv", "--device", "sinamics-g120", "--profile", "FILE"],
    "demo": ["FILE"],
}
"""How verbs that write something else than a result are called."""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="limits of files as POSIX has them")
def test_no_room_for_a_file(work: Path, plcgen: Callable) -> None:
    """Whoever writes tells which file does not fit, exit code 1, and leaves nothing of it behind."""
    import resource

    (work / "list.csv").write_text("Parameter;Parameter text;Minimum;Maximum\np2940;Wobble;0;9\n")
    writers = {verb for verb, found in verbs() for param in found.params if {"--out", "--output"} & {*param.opts}}
    others = {"verify", "simulate", "ppi backup", "ppi log", "ppi migrate"}
    assert writers - set(WRITES) - set(OTHER_WRITERS) <= others, "these read --out, or have a test of their own"
    calls = {f"{verb} -o": [*verb.split(), *args, "-o", "FILE"] for verb, (args, _) in WRITES.items()}
    calls |= {verb: [*verb.split(), *args] for verb, args in OTHER_WRITERS.items()}
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    for number, (verb, args) in enumerate(calls.items()):
        name = f"full{number}{'.yaml' if verb in {'new', 'catalogue import', 'lock'} else ''}"
        resource.setrlimit(resource.RLIMIT_FSIZE, (20, before[1]))
        try:
            ended = plcgen(*(name if arg == "FILE" else arg for arg in args))
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, before)
        assert (ended.code, "PG902" in ended.err) == (1, False), (verb, ended.err)
        assert "File too large" in ended.err, (verb, ended.err)
        assert name in ended.err, (verb, ended.err)
        assert not [each for each in (work / name).rglob("*") if each.is_file()]
        assert not (work / name).is_file()
    assert not list(work.glob(".plcgen-draft-*"))
