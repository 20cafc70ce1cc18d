"""``python -m tests.evidence`` on SCL sources: what it counts, and the rows of ``scl.toml``."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

from plcgen.build.convert import convert
from plcgen.s7.cpu.program import Program
from plcgen.s7.scl.dialect import BY_NAME
from plcgen.s7.scl.parser import parse
from tests.evidence import scl
from tests.evidence.faults import TOKEN, TYPE, Fault, faults, found

GOOD = """FUNCTION_BLOCK "Pump"
{ S7_Optimized_Access := 'TRUE' }
VAR
  n : Int;
  r : Real;
  on : Bool;
END_VAR
BEGIN
IF #on THEN
  #n := #n + 1;
END_IF;
FOR #n := 1 TO 3 DO
  #r := 2.0;
END_FOR;
#on := #n > 5;
END_FUNCTION_BLOCK
"""


@pytest.fixture
def corpus(tmp_path: Path) -> Path:
    """Two repositories: one with a type that only the IEC check forbids, a BOOL in an INT, a file that is none."""
    mine, other = tmp_path / "me+mine", tmp_path / "you+yours"
    mine.mkdir()
    other.mkdir()
    (mine / "pump.scl").write_text(GOOD)
    (mine / "types.udt").write_text('TYPE "T"\nSTRUCT\n  a : INT;\nEND_STRUCT;\nEND_TYPE\n')
    (other / "mixed.scl").write_text(GOOD.replace('"Pump"', '"Mixed"').replace("#n + 1", "#r"))
    (other / "wrong.scl").write_text(GOOD.replace('"Pump"', '"Wrong"').replace("#n + 1", "#on").replace("> 5", '> "x"'))
    (other / "notes.scl").write_text("a list of files\n")
    return tmp_path


def test_what_is_counted(corpus: Path) -> None:
    """Files, refused ones, names that are missing, types without and with IEC check, seeded faults."""
    lines = list(scl.report(corpus))
    assert lines[:2] == [
        "SCL sources: 4 files of 2 repositories",
        "  never looked at before: 4 files of 2 repositories",
    ]
    assert "  refused: 1, 1 of them valid as far as anybody knows" in lines
    assert "    you/yours notes.scl: not judged" in lines
    assert "  names that no file declares: 1" in lines
    types = lines.index("  types: 1 without IEC check, 1 more with the IEC check of the target")
    assert lines[types + 1] == "    more, not judged: 1"
    assert "    not judged: you/yours wrong.scl:10 PG821" in lines
    assert "  seeded token faults: 6 of 6 found, 100.0 %" in lines
    assert "  seeded type faults: 6 of 6 found, 100.0 %" in lines


def test_a_file_that_breaks_the_check_ends_nothing(corpus: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A mistake of plcgen in one file is told with its place; the others are measured as before."""
    before = list(scl.report(corpus))
    (corpus / "you+yours" / "breaks.scl").write_text(GOOD.replace('"Pump"', '"Breaks"'))
    load = Program.load.__func__  # type: ignore[attr-defined]

    def breaking(cls: type[Program], sources: object, *arguments: object, **options: object) -> Program:
        given = list(sources)  # type: ignore[call-overload]
        if any("breaks.scl" in str(source) for source in given):
            raise KeyError("VARIANT")
        return load(cls, given, *arguments, **options)  # type: ignore[no-any-return]

    monkeypatch.setattr(Program, "load", classmethod(breaking))
    lines = list(scl.report(corpus))
    told = lines.index("  not checked, a mistake of plcgen: 1")
    assert lines[told + 1] == "    you/yours breaks.scl: KeyError: 'VARIANT'"
    assert [*lines[2:told], *lines[told + 2 :]] == before[2:]


def test_the_code_of_documents_is_counted(tmp_path: Path) -> None:
    """An export without IEC check may put a WORD into an INT, but no BOOL; a tag that nobody declares is a name."""
    place = tmp_path / "me+mine"
    source = GOOD.replace("r : Real;", "w : Word;\n  m : Int;").replace("#r := 2.0", '#m := #w; #m := "level"')
    for name, text in (
        ("Pump", source),
        ("Wrong", source.replace('"Pump"', '"Wrong"').replace("#m := #w", "#m := #on")),
    ):
        found = convert([_written(tmp_path / f"{name}.scl", text)], "xml", version="V19")
        place.mkdir(exist_ok=True)
        (place / f"{name}.xml").write_bytes(found.files[0].data)
    lines = list(scl.report(tmp_path))
    first = lines.index("  documents of compiled blocks: 2 blocks in SCL of 1 repositories")
    assert lines[first + 1 : first + 3] == ["    types: 1, names: 1", "    not judged: 1"]
    assert lines[first + 3].startswith("    not judged: me/mine Wrong.scl:")


def _written(path: Path, text: str) -> Path:
    path.write_text(text)
    return path


def test_every_kind_of_fault_is_found_in_a_plain_block() -> None:
    """Each deleted word and each wrong type brings a message that was not there before."""
    result = parse(GOOD, "a.scl")

    def check(source: str) -> frozenset[tuple[str, str]]:
        return frozenset(
            (d.code, d.message) for d in Program.load([("a.scl", source)], BY_NAME["tia-1500"]).diagnostics
        )

    seeded = faults(result, 1000, "")
    assert {fault.kind for fault in seeded} == {TOKEN, TYPE}
    assert len({fault.name for fault in seeded}) > 10
    assert [fault for fault in seeded if not found(GOOD, fault, check(GOOD), check)] == []


def test_a_fault_that_changes_nothing_is_not_found() -> None:
    """The measure can fail."""
    nothing = Fault(TOKEN, "a blank", 0, 0, " ")
    assert not found(GOOD, nothing, frozenset(), lambda _: frozenset())


def test_the_decided_rows_say_what_is_needed_and_nothing_else() -> None:
    """Places, codes, verdicts and reasons in words of our own: no line of a source is kept."""
    data = tomllib.loads(scl.KEPT.read_text(encoding="utf-8"))
    names = {row["name"] for row in data["repository"]}
    assert len(names) == len(data["repository"])
    for row in data["repository"]:
        assert row.keys() <= {"name", "seen", "compiled", "why", "targets"}
        assert "why" in row or not row.get("compiled")
        assert set(row.get("targets", {}).values()) <= BY_NAME.keys()
    for row in [*data["refused"], *data["judged"]]:
        assert row.keys() <= {"repository", "path", "lines", "code", "verdict", "why"}
        assert not re.search(r":=|;\s*$", row["why"])
    for row in data["judged"]:
        assert row["verdict"] in {"right", "false", "open", "check"}
        assert row["code"] in scl.TYPES | scl.NAMES
        assert row["lines"]
