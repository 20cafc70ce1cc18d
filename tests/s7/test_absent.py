"""What a source does not write: every reader and writer gives it one meaning."""

import itertools

import pytest

import plcgen
from plcgen.s7.cpu.program import Program
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.types.blocks import OF_BLOCKS, OF_MEMBERS
from plcgen.s7.xml.spelling import VERSIONS

STATED = {
    "absent": "",
    "standard": "{ S7_Optimized_Access := 'FALSE' }\n",
    "optimized": "{ S7_Optimized_Access := 'TRUE' }\n",
}
BLOCKS = {
    "DB": 'DATA_BLOCK "B"\n{}VERSION : 0.1\nSTRUCT\na : Int;\nb : DInt;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n',
    "FB": 'FUNCTION_BLOCK "B"\n{}VERSION : 0.1\nVAR_INPUT\na : Int;\nEND_VAR\nBEGIN\n;\nEND_FUNCTION_BLOCK\n',
    "FC": 'FUNCTION "B" : Void\n{}VERSION : 0.1\nVAR_INPUT\na : Int;\nEND_VAR\nBEGIN\n;\nEND_FUNCTION\n',
}
MEANS = {
    (False, "absent"): "optimized", (False, "standard"): "standard", (False, "optimized"): "optimized",
    (True, "absent"): "standard", (True, "standard"): "standard",
}  # fmt: skip
"""By target (S7-300/400 or not) and what is written: help of the TIA Portal, "Blocks with optimized access"."""


def written(folder, kind, said):
    folder.mkdir()
    (folder / f"b.{'db' if kind == 'DB' else 'scl'}").write_text(
        BLOCKS[kind].format(STATED[said]), encoding="utf-8-sig"
    )
    return folder


@pytest.mark.parametrize("kind", BLOCKS)
@pytest.mark.parametrize(("classic", "old", "new"), [
    (classic, old, new)
    for classic in (False, True)
    for old, new in itertools.product([said for target, said in MEANS if target == classic], repeat=2)
])  # fmt: skip
def test_diff_and_lock_answer_alike(kind, classic, old, new, tmp_path):
    """Access has changed where it means something else, whether or not it is written, in diff and in a lock."""
    before, after = written(tmp_path / "old", kind, old), written(tmp_path / "new", kind, new)
    wanted = ["access-changed"] if MEANS[classic, old] != MEANS[classic, new] else []
    assert [change.kind for change in plcgen.diff(before, after, classic=classic).changes] == wanted
    lock = tmp_path / "x.lock.json"
    assert plcgen.lock(before, out=lock, classic=classic).ok
    assert [change.kind for change in plcgen.check_lock(after, lock=lock, classic=classic).changes] == wanted


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize(("classic", "said"), MEANS)
def test_convert_answers_alike(version, classic, said, tmp_path):
    """A document says what its source means, and is read again as the same."""
    folder = written(tmp_path / "old", "DB", said)
    assert plcgen.convert(folder, to="xml", out=tmp_path / "xml", version=version, classic=classic).ok
    (document,) = (tmp_path / "xml").rglob("*.xml")
    layout = document.read_text("utf-8").partition("<MemoryLayout>")[2].partition("<")[0].lower()
    assert layout == ("" if classic else MEANS[classic, said])
    assert plcgen.convert(tmp_path / "xml", to="scl", out=tmp_path / "scl", classic=classic).ok
    assert plcgen.diff(folder, tmp_path / "scl", classic=classic).changes == ()


@pytest.mark.parametrize(("classic", "said"), MEANS)
def test_layout_and_cpu_answer_alike(classic, said, tmp_path):
    """Offsets without a warning are those of standard access; the soft CPU has the same one."""
    folder = written(tmp_path / "old", "DB", said)
    (table,) = plcgen.layout(folder, family="s7-300" if classic else "s7-1500").blocks
    sure = table.size is not None and not table.unsaid
    assert sure == (MEANS[classic, said] == "standard")
    dialect = Dialect.TIA_300_400 if classic else Dialect.TIA_1200_1500
    link = Program.load([("b.db", BLOCKS["DB"].format(STATED[said]))], dialect).link
    entry = link.find("B")
    assert entry is not None
    assert link.optimized(entry) == (MEANS[classic, said] == "optimized")


@pytest.mark.parametrize("said", STATED)
def test_check_answers_alike(said):
    """AT over a member is refused where the access is optimized, on S7-1200/1500."""
    text = BLOCKS["FB"].format(STATED[said]).replace("a : Int;", "a : Int;\nv AT a : Word;")
    program = Program.load([("b.scl", text)], Dialect.TIA_1200_1500)
    refused = any("AT in a block with optimized access" in d.message for d in program.diagnostics)
    assert refused == (MEANS[False, said] == "optimized")


@pytest.mark.parametrize("name", OF_BLOCKS)
def test_attributes_of_blocks(name, tmp_path):
    """An attribute with the value that it has when absent is no difference; with another value it is."""
    found = {}
    for number, value in enumerate((OF_BLOCKS[name], "9.9" if name == "VERSION" else "FALSE")):
        if name == "VERSION":
            old, new = "", f"VERSION : {value}\n"
        else:
            old, new = "", f"{{ {name} := '{value}' }}\n"
        block = 'DATA_BLOCK "B"\n{}STRUCT\na : Int;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n'
        folders = []
        for side, text in (("old", old), ("new", new)):
            folders.append(tmp_path / f"{side}{number}")
            folders[-1].mkdir()
            (folders[-1] / "b.db").write_text(block.format(text), encoding="utf-8-sig")
        found[value] = bool(plcgen.diff(*folders).changes)
    assert not found[OF_BLOCKS[name]]
    assert all(found[value] for value in found if value != OF_BLOCKS[name])


@pytest.mark.parametrize("name", [name for name in OF_MEMBERS if name != "RETAIN"])
def test_attributes_of_members(name, tmp_path):
    """The same of what stands in braces at a member."""
    default = OF_MEMBERS[name]
    other = "TRUE" if default == "FALSE" else "FALSE"
    block = 'DATA_BLOCK "B"\nSTRUCT\na{} : Int;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n'
    for side, braces in (("old", ""), ("same", f" {{{name} := '{default}'}}"), ("new", f" {{{name} := '{other}'}}")):
        (tmp_path / side).mkdir()
        (tmp_path / side / "b.db").write_text(block.format(braces), encoding="utf-8-sig")
    assert plcgen.diff(tmp_path / "old", tmp_path / "same").changes == ()
    assert len(plcgen.diff(tmp_path / "old", tmp_path / "new").changes) == 1


def test_an_instance_follows_its_function_block(tmp_path):
    """An instance that says nothing has the access of its function block, in every tool."""
    fb = BLOCKS["FB"].format(STATED["standard"])
    instance = 'DATA_BLOCK "I"\n{}"B"\nBEGIN\nEND_DATA_BLOCK\n'
    for side, said in (("old", "absent"), ("new", "standard")):
        (tmp_path / side).mkdir()
        (tmp_path / side / "b.scl").write_text(fb + instance.format(STATED[said]), encoding="utf-8-sig")
    assert plcgen.diff(tmp_path / "old", tmp_path / "new").changes == ()
