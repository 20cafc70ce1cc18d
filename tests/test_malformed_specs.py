"""Damaged specs: whatever is done to a good spec, the answer is a diagnostic at a place, never an exception.

The mutations are deterministic, so that a failure can be repeated by its name.
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from plcgen import api
from plcgen.base.resources import specs_dir

pytestmark = pytest.mark.slow
Mutate = Callable[[str], Iterator[tuple[str, str]]]
GOOD = {path.stem: path.read_text("utf-8") for path in sorted(specs_dir().glob("*.yaml"))}
_KEY = re.compile(r"(?<=[\s{,])[A-Za-z_][\w]*(?=: )")
_VALUE = re.compile(r"(?<=: )[^\s{}\[\],#][^{}\[\],#\n]*(?=[,}\]\n])")
_VALUES = {
    "nothing": "",
    "a list": "[1, 2]",
    "a mapping": "{a: {b: c}}",
    "a truth value": "true",
    "yes": "yes",
    "octal": "0777",
    "base 60": "12:30:45",
    "negative": "-1",
    "zero": "0",
    "huge": "9" * 60,
    "too long for an int": "1" * 5000,
    "a large float": "1e400",
    "not a number": ".nan",
    "infinite": "-.inf",
    "a path": "../x",
    "an absolute path": "/etc/passwd",
    "a NUL": r'"a\0b"',
    "a line break": r'"a\nb"',
    "a right-to-left mark": r'"a\u202Eb"',
    "a lone surrogate": r'"\uD800"',
    "an emoji": "😀",
    "a device": "NUL",
    "a reserved word": "END_IF",
    "a quote": "'a''b\"c'",
    "a comment end": '"*) END_FUNCTION_BLOCK (*"',
    "a template": '"{{ 7 * 7 }}{% raw %}"',
    "a tag": "!!python/object/apply:os.system [ls]",
    "an unknown alias": "*nothing",
    "a long text": "x" * 300,
    "a blank": '" "',
    "hexadecimal": "16#FFFF_FFFF_FFFF",
    "a wrong hexadecimal": "16#XY",
}


def _truncated(text: str) -> Iterator[tuple[str, str]]:
    for step in range(24):
        cut = len(text) * step // 24
        yield f"cut off at {cut}", text[:cut]


def _keys(text: str) -> Iterator[tuple[str, str]]:
    for number, match in enumerate(_KEY.finditer(text)):
        start, end = match.span()
        name = f"{match.group()} {number}"
        yield f"key renamed: {name}", f"{text[:start]}{match.group()}x{text[end:]}"
        yield f"key in capitals: {name}", f"{text[:start]}{match.group().upper()}{text[end:]}"


def _values(text: str) -> Iterator[tuple[str, str]]:
    found = list(_VALUE.finditer(text))
    kinds = list(_VALUES.items())
    for number, match in enumerate(found):
        for offset in range(2):
            kind, value = kinds[(2 * number + offset) % len(kinds)]
            yield f"value {number} is {kind}", text[: match.start()] + value + text[match.end() :]


def _lines(text: str) -> Iterator[tuple[str, str]]:
    lines = text.splitlines(keepends=True)
    for number, line in enumerate(lines):
        if not line.strip() or line.startswith("#"):
            continue
        before, after = "".join(lines[:number]), "".join(lines[number + 1 :])
        if number % 2:
            yield f"line {number + 1} missing", before + after
            yield f"line {number + 1} further in", f"{before} {line}{after}"
        else:
            yield f"line {number + 1} twice", before + line + line + after
            yield f"line {number + 1} with a tab", f"{before}\t{line}{after}"


def _whole(text: str) -> Iterator[tuple[str, str]]:
    middle = len(text) // 2
    odd = {"NUL": "\0", "BEL": "\a", "DEL": "\x7f", "BOM": "\ufeff", "NEL": "\x85", "LS": "\u2028"}
    for name, char in odd.items():
        yield f"{name} in the middle", text[:middle] + char + text[middle:]
    yield "CR LF", text.replace("\n", "\r\n")
    yield "CR", text.replace("\n", "\r")
    yield "deep list", text + "extra: " + "[" * 2000
    yield "deep mapping", text + "extra: " + "{a: " * 2000
    yield "deep indentation", text + "".join(f"{' ' * depth}a:\n" for depth in range(500))
    bomb = "".join(f"x{n}: &x{n} [{', '.join([f'*x{n - 1}'] * 9)}]\n" for n in range(1, 10))
    yield "alias bomb", f"x0: &x0 [a, a]\n{bomb}{text}"
    yield "merge bomb", text + "a: &a {b: c}\nd: &d {<<: [*a, *a], e: *a}\nf: {<<: *d, <<: *d}\n"
    yield "two documents", f"{text}\n---\n{text}"
    yield "a directive", f"%YAML 1.1\n%TAG ! tag:x,2000:\n---\n{text}"
    yield "twice", text + text
    yield "a list of it", "- " + text.replace("\n", "\n  ")
    yield "only a comment", "# nothing\n"
    yield "nothing", ""
    yield "a colon", ":"
    yield "a question mark", "? "
    yield "a complex key", text + "? {a: b}\n: c\n"
    yield "an unfinished string", text + '"'
    yield "a version of tomorrow", text + "version: 2\n"
    yield "names of members", text.replace("names: faq", "names: none")


MUTATIONS = (_truncated, _keys, _values, _lines, _whole)
DAMAGED = {stem: text for stem, text in GOOD.items() if stem not in {"s7-1200_plant", "s7-1500_plant"}}
"""These two are s7-300_plant_v5 again but for the address of each drive."""


@pytest.fixture(scope="module")
def output(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, bytes]]:
    """An output folder of a good spec, and what it holds."""
    folder = tmp_path_factory.mktemp("output")
    result = api.generate(specs_dir() / f"{next(iter(GOOD))}.yaml", folder)
    assert result.ok, result.diagnostics
    return folder, _contents(folder)


def _contents(folder: Path) -> dict[str, bytes]:
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def malformed(stem: str, mutate: Mutate) -> Iterator[tuple[str, str]]:
    return ((name, changed) for name, changed in mutate(DAMAGED[stem]) if changed != DAMAGED[stem])


def test_there_are_enough_of_them() -> None:
    """At least 200, from every kind of good spec."""
    assert sum(1 for stem in DAMAGED for mutate in MUTATIONS for _ in malformed(stem, mutate)) >= 200
    assert len(DAMAGED) >= 2


@pytest.mark.parametrize("text", GOOD.values(), ids=GOOD)
def test_the_unchanged_specs_are_good(text: str, tmp_path: Path) -> None:
    """The mutations start from specs without any finding."""
    path = tmp_path / "spec.yaml"
    path.write_text(text, encoding="utf-8")
    assert [str(d) for d in api.check(path).diagnostics if d.severity.label == "error"] == []


@pytest.mark.parametrize("mutate", MUTATIONS, ids=lambda mutate: mutate.__name__.strip("_"))
@pytest.mark.parametrize("stem", DAMAGED)
def test_a_malformed_spec_is_valid_or_diagnosed(
    stem: str, mutate: Mutate, tmp_path: Path, output: tuple[Path, dict[str, bytes]]
) -> None:
    """Diagnostics stand inside the file and say something; output of a good spec is not touched on errors.

    ``check`` and ``generate`` say the same of one kind of each changed value, and of one change in eight of the others.
    """
    folder, before = output
    wrong: dict[str, str] = {}
    for number, (name, text) in enumerate(malformed(stem, mutate)):
        own = tmp_path / str(number)
        own.mkdir()
        try:
            is_valid_or_diagnosed(text, own, folder if number % (2 if mutate is _values else 8) == 0 else None)
        except Exception as problem:  # noqa: BLE001 - all that fail are told, by name
            wrong[name] = repr(problem)
    assert wrong == {}
    assert _contents(folder) == before


def is_valid_or_diagnosed(text: str, own: Path, output: Path | None) -> None:
    """Check and generate a spec: into a folder of its own if it is valid, else over ``output``, that of a good one."""
    path = own / "spec.yaml"
    path.write_bytes(text.encode("utf-8", "surrogatepass"))
    checked = api.check(path)
    last = len(re.split("\r\n|[\n\r\x85\u2028\u2029]", text))
    for diagnostic in checked.diagnostics:
        assert re.fullmatch(r"PG[1-4]\d\d", diagnostic.code), diagnostic
        assert diagnostic.message
        assert diagnostic.message.isprintable(), diagnostic.message
        assert len(diagnostic.message) < 400, diagnostic.message
        assert 1 <= diagnostic.span.line <= last + 1, diagnostic
        assert diagnostic.span.column >= 1, diagnostic
        assert (diagnostic.span.end_line, diagnostic.span.end_column) >= (diagnostic.span.line, diagnostic.span.column)
    if output is None:
        return
    result = api.generate(path, own / "new" if checked.ok else output)
    assert result.ok == checked.ok, result.diagnostics
    assert checked.ok or result.diagnostics == checked.diagnostics
    assert {child.name for child in own.iterdir()} == ({"spec.yaml", "new"} if checked.ok else {"spec.yaml"})
    if checked.ok:
        shutil.rmtree(own)
