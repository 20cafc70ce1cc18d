"""The engine of documents: a protocol that nobody knows hands over nouns and gets every kind of file."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

from plcgen.build.control import signals
from plcgen.build.engine import emit
from plcgen.build.environment import render_all
from plcgen.build.members import assignments, buffer_member, initializer, plain
from plcgen.build.nouns import CallerValue, Command, Contribution, DataBlock, FunctionBlock, MemberRow, TypeBlock
from plcgen.project.nouns import BlockRef, BufferField, Plan, PlannedJob, PlannedTrigger, Project
from plcgen.project.target import target
from plcgen.s7.types.address import parse_address
from plcgen.s7.types.data_types import ELEMENTARY, ArrayType, Elementary
from tests.projects import ROOT

TEMPLATE = """FUNCTION_BLOCK "{{ name }}"
TITLE = A toy
VERSION : 0.1
VAR_INPUT
  execute : Bool;
  speed : Real;
END_VAR
VAR_OUTPUT
  busy : Bool;
  done : Bool;
  error : Bool;
  status : Word;
END_VAR
BEGIN
REGION Work
#busy := #execute;
END_REGION
END_FUNCTION_BLOCK
"""


def ref(kind: str, name: str, number: int) -> BlockRef:
    return BlockRef(kind, name, number, pinned=False, path=())


class Toy:
    """A protocol with one block, one buffer and one job."""

    key = "toy"

    def documents(self, plan: Plan) -> Contribution:
        """One of each noun."""
        buffer, type_ = ref("DB", "Frame", 5), ref("UDT", "FrameType", 6)
        word = BufferField("code", "code", ELEMENTARY["WORD"], 0, 2, b"\x12\x34")
        array = BufferField("data", "data", ArrayType(((0, 1),), ELEMENTARY["BYTE"]), 2, 2, b"\x00\x07")
        members = [
            buffer_member(plan, buffer, field, {"en-US": text}, text, starts=True)
            for field, text in ((word, "what it is"), (array, ""))
        ]
        speed = plain(plan, "speed", "REAL" if plan.target.v5 else "Real", "set point", start="1.5")
        controls = ref("DB", "Toys", 9)
        command = Command(
            controls, "move", "Move it", {"execute": parse_address("M50.0")}, signals(plan),
            [CallerValue(speed, (("", "FloatingPoint"),))], [],
        )  # fmt: skip
        program = FunctionBlock(
            ref("FB", "Toy", 7), ref("DB", "Toy_DB", 8), "Toy of all", "toy_protocol:templates/toy.scl.j2",
            {"name": "Toy"}, "a toy",
            [(TypeBlock(type_, members), DataBlock(buffer, "Frame", members, assignments(members)))],
            [command], ["frame 12 34"],
        )  # fmt: skip
        return Contribution(
            "TOY", "toy jobs", (), (), iter([program]), {controls: "All toys"}, "ToyTags",
            lambda: ([], []), lambda: {"toys": 1}, symbols=[("LIB", "FB 1", "FB 1", "library")],
        )  # fmt: skip


def files(family: str, toolchain: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, str]:
    """Texts of all files; the template lies in a package of its own, as that of another distribution would."""
    package = folder / "toy_protocol"
    (package / "templates").mkdir(parents=True)
    (package / "__init__.py").touch()
    (package / "templates" / "toy.scl.j2").write_text(TEMPLATE)
    monkeypatch.syspath_prepend(str(folder))
    loaded = SimpleNamespace(spec=SimpleNamespace(plc=SimpleNamespace(sources="per_block"), model_dump=lambda **_: {}))
    frame: tuple[Any, ...] = (cast("Any", loaded), "Toys", target(family, toolchain), ("en-US",))
    blocks = (ref("FB", "Toy", 7), ref("DB", "Toy_DB", 8))
    job = cast("PlannedJob", SimpleNamespace(trigger=PlannedTrigger()))
    plan = Plan(*frame, protocol=cast("Any", Toy()), jobs=[job], blocks=blocks)
    made = render_all(emit(Project(*frame, plans=(plan,))))
    return {file.path: file.data.decode("utf-8-sig").replace("\r\n", "\n") for file in made if b"\0" not in file.data}


@pytest.mark.parametrize("toolchain", ["step7-v5", "tia-v16"])
def test_sources_are_spelled_for_the_compiler(toolchain: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One template, one noun: the texts of STEP 7 V5 and of the TIA Portal."""
    made = files("s7-300", toolchain, tmp_path, monkeypatch)
    if toolchain == "step7-v5":
        assert "TITLE = 'A toy'\nVERSION : '0.1'\nVAR_INPUT\n  execute : BOOL;" in made["scl/Toy.scl"]
        assert "// ---- Work ----\nbusy := execute;\nEND_FUNCTION_BLOCK" in made["scl/Toy.scl"]
        assert '"Toy"."Toy_DB"(execute := "moveExecute",\n    speed := "Toys".move.speed);' in made["scl/Main.scl"]
        assert made["udt/FrameType.scl"].split("STRUCT")[1] == (
            "\n    code : WORD;  // what it is\n    data : ARRAY[0..1] OF BYTE;\n  END_"
        )
        assert made["compile.inp"] == "FrameType\nFrame\nToys\nToy\nToy_DB\n"
        assert made["symbols.sdf"].splitlines() == [  # the columns of STEP 7's own SYMBOL.SDF
            f'"LIB                     ","FB      1   ","FB      1 ","{"library":80}"',
            f'"Toy                     ","FB      7   ","FB      7 ","{"":80}"',
            f'"Toy_DB                  ","DB      8   ","FB      7 ","{"":80}"',
            f'"moveExecute             ","M      50.0 ","BOOL      ","{"execute: Move it":80}"',
        ]
    else:
        assert "// ---- Work ----\n#busy := #execute;\nEND_FUNCTION_BLOCK" in made["scl/Toy.scl"]
        assert (
            '"Toy_DB"(execute := "moveExecute",\n    speed := "Toys".move.speed,\n    busy =>' in made["scl/Main.scl"]
        )
        assert "    code : Word := 16#1234;  // what it is\n    data : Array[0..1] of Byte;\n" in made["db/Frame.db"]
        assert "BEGIN\n  data[1] := 16#07;\nEND_DATA_BLOCK\n" in made["db/Frame.db"]
        assert "    move : STRUCT  // Move it\n      busy : Bool;  // the job is running\n" in made["db/Toys.db"]
        assert "      speed : Real := 1.5;  // set point\n    END_STRUCT;\n" in made["db/Toys.db"]


def test_tables_come_from_the_same_nouns(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Watch table, tags, layout sheet, guide and SimaticML of an S7-1500."""
    made = files("s7-1500", "tia-v19", tmp_path, monkeypatch)
    assert made["watch/Toy.csv"].splitlines()[1:] == [
        '"""moveExecute""";M50.0;Bool;',
        '"""Toys"".move.busy";;Bool;',
        '"""Toys"".move.done";;Bool;',
        '"""Toys"".move.error";;Bool;',
        '"""Toys"".move.status";;Hex;',
        '"""Toys"".move.speed";;FloatingPoint;',
        '"""Frame"".code";DB5.DBW0;Hex;',
        '"""Frame"".data[0]";DB5.DBB2;Hex;',
        '"""Frame"".data[1]";DB5.DBB3;Hex;',
    ]
    assert made["tags.csv"].splitlines()[1:] == ["moveExecute;Bool;%M50.0;execute: Move it"]
    assert '## Toy: Toy of all\n\n- frame 12 34\n\n### DB5 "Frame", 4 bytes\n' in made["LAYOUT.md"]
    assert "| 0 | DB5.DBW0 | code | Word | 2 | 16#1234 | what it is |" in made["LAYOUT.md"]
    assert (
        "1. `udt/FrameType.udt`\n2. `db/Frame.db`\n3. `db/Toys.db`\n4. `scl/Toy.scl`\n5. `db/Toy_DB.db`"
        in made["IMPORT.md"]
    )
    twins = "FrameType Frame Toys Toy Toy_DB Main Watch_Toy ToyTags".split()
    written = {name for name in made if name.startswith("xml/")}
    assert written == {f"xml/{name}.xml" for name in twins} | {"xml/IMPORT.md", "xml/import.json", "xml/import.ps1"}
    values = made["xml/Frame.xml"].split('<Subelement Path="1">')[1]
    assert values.split()[0] == "<StartValue>16#07</StartValue>"


def test_start_values_of_arrays_that_follow_each_other_are_written_once() -> None:
    """``[3(2)]`` in the TIA Portal, ``3(2)`` in STEP 7 V5; nothing for zeros."""
    three = ArrayType(((0, 2),), ELEMENTARY["INT"])
    alike, different = bytes.fromhex("000200020002"), bytes.fromhex("000200020003")
    assert [initializer(three, alike, v5=v5) for v5 in (False, True)] == ["[3(2)]", "3(2)"]
    assert [initializer(three, different, v5=v5) for v5 in (False, True)] == ["[2(2), 3]", "2(2), 3"]
    assert initializer(three, bytes(6), v5=False) == ""
    assert initializer(cast("Elementary", ELEMENTARY["INT"]), b"\x00\x05", v5=True) == "5"


def test_the_members_of_a_page_are_plain_data() -> None:
    """A member says nothing that it was not told."""
    assert MemberRow("a", "Int") == ("a", "Int", "", "", (), (), (), (), 0, 0, "", ())


def _imports(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def test_the_room_is_blind_to_protocols() -> None:
    """No module of it imports a protocol, inside functions neither."""
    modules = sorted((ROOT / "plcgen" / "build").glob("*.py"))
    assert len(modules) > 10
    assert [
        name
        for path in modules
        for name in _imports(path)
        if name.startswith(("plcgen.ds47", "plcgen.ppi", "plcgen.protocol"))
    ] == []
