"""What 1 KB of YAML can ask for: little work, or a refusal. Work is counted in calls, files and bytes, not in time."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest

from plcgen import api
from plcgen.project.opening import open_spec
from tests.bench.specs import grid, many_jobs
from tests.work import calls_of

LENGTH = 1024
PLC = "plc: {name: P, family: s7-1500, toolchain: tia-v19}\n"
CALLS = 1_000_000
"""So many calls of Python are about 0.1 s of a machine of 2024: check of 1 KB takes less."""
FILES, BYTES = 2_000, 25_000_000
"""At most four files for each telegram there can be, and some for the project; 3 ms of work each."""


def filled(head: str, job: str) -> str:
    """As many jobs as there is room for in 1 KB."""
    text = head
    while len(text) + len(job) < LENGTH - 4:
        text += job.replace("{n}", str(text.count("\n")))
    return text


def ranges(parameters: str, what: str) -> str:
    """Jobs on one drive whose parameters are long arrays."""
    drive = f"drives: {{d: {{device: sinamics-s120, hardware_id: 3, parameters: {{{parameters}}}}}}}"
    return filled(f"{PLC}{drive}\njobs:\n", f"  j{{n}}: {{drive: d, {what}}}\n")


def arrays(what: str, type_: str = "FloatingPoint") -> str:
    """The same with one array of every index there can be."""
    return ranges(f"P4900: {{type: {type_}, array: 65535}}", what)


def drives(places: str, count: int) -> str:
    """All jobs on all drives: one list, named again and again."""
    names = [f"a{i}" for i in range(count)]
    rows = "".join(f"  {name}: {places.format(number=i + 1)}\n" for i, name in enumerate(names))
    first = f"  j: {{drive: &all [{', '.join(names)}], read: [P1120]}}\n"
    return filled(f"{PLC}drives:\n{rows}jobs:\n{first}", "  j{n}: {drive: *all, read: [P1120]}\n")


def doubled() -> str:
    """A text of 40 characters, doubled 30 times."""
    rows = "".join(f"  a{i + 1}: $(a{i})$(a{i})\n" for i in range(30))
    return f"variables:\n  a0: {'x' * 40}\n{rows}{PLC.replace('name: P', 'name: $(a30)')}drives: {{}}\njobs: {{}}\n"


SHORT = {
    "the longest ranges": arrays('read: ["P4900[0..14000]"]'),
    "ranges that have room": arrays('read: ["P4900[0..999]"]'),
    "inputs": arrays('write: {"P4900[0..999]": null}'),
    "one value for a whole range": arrays('write: {"P4900[0..50000]": 1}', "Unsigned8"),
    "ranges that are read back": arrays('write: {"P4900[0..999]": null}, verify: readback'),
    "ranges that are compared": arrays('compare: {"P4900[0..999]": 1}'),
    "bits": arrays('read: ["P4900[0..50000]"]', "Boolean"),
    "buffers in data blocks": arrays('write: {"P4900[0..999]": null}, buffers: db'),
    "a list of drives, named again": drives("{{device: sinamics-g120, hardware_id: {number}}}", 11),
    "one unit under many names": drives("{{device: sinamics-g120, hardware_id: 1}}", 11),
    "variables that double": doubled(),
    "a variable for a list of ranges": "variables:\n  v: ['P4900[0..999]', 'P4901[0..999]', 'P4902[0..999]']\n"
    + ranges("P4900: &p {type: FloatingPoint, array: 65535}, P4901: *p, P4902: *p", "read: $(v)"),
    "nested aliases": "x: &a [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n"
    + "".join(f"{b}: &{b} [{', '.join(['*' + a] * 10)}]\n" for a, b in pairwise("abcdefgh")),
    "stations of PPI": filled(
        "plc: {name: P, family: s7-1200, toolchain: tia-v19}\nppi:\n  m:\n    module: cm1241\n    port: 269\n"
        "    stations: {s: {address: 2, cpu: '226'}}\n    jobs:\n",
        "      j{n}: {station: s, read: ['VB0[1000]']}\n",
    ),
}
REFUSED = {
    "the longest ranges": "PG307",
    "one value for a whole range": "PG206",
    "ranges that are read back": "PG307",
    "bits": "PG206",
    "buffers in data blocks": "PG223",
    "one unit under many names": "PG225",
    "variables that double": "PG114",
    "a variable for a list of ranges": "PG307",
    "nested aliases": "PG109",
}


@pytest.mark.parametrize("name", SHORT)
def test_a_short_spec_is_little_work(name: str, tmp_path: Path) -> None:
    """Refused, or generated with few files and bytes."""
    text = SHORT[name]
    spec = tmp_path / "job.yaml"
    spec.write_text(text)
    open_spec(spec)  # what is loaded once for every spec
    opened, calls = calls_of(lambda: open_spec(spec))
    errors = {d.code for d in opened.diagnostics if d.severity.label == "error"}
    assert calls < CALLS
    assert errors >= {REFUSED[name]} if name in REFUSED else errors == set()
    if name in REFUSED:
        return
    api.generate(spec, tmp_path / "out")
    found = [path.stat().st_size for path in (tmp_path / "out").rglob("*") if path.is_file()]
    assert (len(found) < FILES, sum(found) < BYTES) == (True, True)


@pytest.mark.parametrize("text", [many_jobs(1000), grid(100, 20), arrays('read: ["P4900[0..999]"]')], ids=len)
def test_what_somebody_needs_is_allowed(text: str, tmp_path: Path) -> None:
    """1,000 different jobs, 100 jobs on each of 20 drives, 20 recipes of 1,000 numbers."""
    (tmp_path / "job.yaml").write_text(text)
    assert "PG307" not in {d.code for d in open_spec(tmp_path / "job.yaml").diagnostics}
