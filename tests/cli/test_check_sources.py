"""check on PLC sources: as the compiler of a target reads them, file by file or as a program."""

import json

import pytest

GOOD = """\
FUNCTION_BLOCK "Add"
{ S7_Optimized_Access := 'FALSE' }
VAR_INPUT
  first : Int;
END_VAR
VAR_OUTPUT
  total : Int;
END_VAR
BEGIN
#total := #first + 1;
END_FUNCTION_BLOCK
"""
CLASSIC = """\
FUNCTION_BLOCK FB 1
VAR_INPUT
  first : INT;
END_VAR
CONST
  STEP := 2;
END_CONST
VAR
  total : INT;
END_VAR
BEGIN
total := first + STEP;
END_FUNCTION_BLOCK
"""


@pytest.fixture
def sources(tmp_path):
    """A folder with one source of TIA and one of STEP 7 V5."""
    folder = tmp_path / "src"
    (folder / "deep").mkdir(parents=True)
    (folder / "add.scl").write_text(GOOD)
    (folder / "deep" / "CLASSIC.SCL").write_text(CLASSIC)
    (folder / "notes.txt").write_text("no source")
    return folder


def test_any_target(plcgen, sources):
    """Without a target everything is right that some compiler accepts; a folder stands for its sources."""
    result = plcgen("check", sources)
    assert (result.code, result.out, result.err) == (0, "", "no problems in 2 files (2 blocks)\n")


def test_a_target_names_each_line_it_refuses(plcgen, sources):
    """TIA has no CONST section: PG803 at line 5 of the V5 source, nothing about the other file."""
    result = plcgen("check", sources, "--target", "tia-1500", "--json")
    data = json.loads(result.out)
    found = [(d["code"], d["line"], d["file"].rpartition("/")[2]) for d in data["diagnostics"]]
    assert result.code == 1
    assert ("PG803", 5, "CLASSIC.SCL") in found
    assert {file for _, _, file in found} == {"CLASSIC.SCL"}
    assert len(data["specs"]) == 2


def test_errors_of_syntax_come_with_their_line(plcgen, tmp_path):
    """A missing semicolon is found where the statement ends."""
    (tmp_path / "bad.scl").write_text(GOOD.replace("+ 1;", "+ 1"))
    result = plcgen("check", "bad.scl")
    assert result.code == 1
    assert "error[PG801]" in result.out
    assert "bad.scl:10:" in result.out
    assert result.err == "\n1 error in bad.scl (1 block)\n"


def test_a_program_is_compiled(plcgen, tmp_path):
    """Names are checked only if the files are the whole program; tags come from a table."""
    source = GOOD.replace("#first + 1", '#first + "level"')
    (tmp_path / "add.scl").write_text(source)
    assert plcgen("check", "add.scl").code == 0
    result = plcgen("check", "add.scl", "--program", "--target", "tia-1500")
    assert result.code == 1
    assert "level" in result.out
    assert "add.scl:10:" in result.out
    (tmp_path / "tags.csv").write_text("Name,Data Type,Logical Address,Comment\nlevel,Int,%MW10,\n")
    result = plcgen("check", "add.scl", "--program", "--target", "tia-1500", "--tags", "tags.csv")
    assert (result.code, result.err) == (0, "no problems in add.scl (1 block)\n")


def test_specs_and_sources_together(plcgen, good, sources):
    """One call may check both."""
    result = plcgen("check", good, sources / "add.scl")
    assert (result.code, result.err) == (0, "no problems in 2 files (1 block)\n")


@pytest.mark.parametrize(
    ("args", "message"),
    [
        (["src", "--program"], "--program needs --target: one of v5, tia-300, tia-1500"),
        (["job.yaml", "--program", "--target", "v5"], "--program needs PLC sources"),
        (["src", "--tags", "x.csv"], "--tags belongs to --program"),
        (["empty"], "there is no PLC source (.scl .udt .db .awl) below empty"),
    ],
)
@pytest.mark.usefixtures("sources")
def test_usage(plcgen, tmp_path, args, message):
    """A call that makes no sense says what is missing."""
    (tmp_path / "empty").mkdir()
    result = plcgen("check", *args)
    assert result.code == 2
    assert message in result.err


@pytest.mark.parametrize("name", ["gone.scl", "gone.sdf"])
@pytest.mark.usefixtures("sources")
def test_files_that_are_not_there(plcgen, name):
    """A missing source is a diagnostic; a missing tag table ends the call with its name."""
    more = [name] if name.endswith("scl") else ["src/add.scl", "--program", "--target", "tia-1500", "--tags", name]
    result = plcgen("check", *more)
    assert result.code == 1
    assert name in result.out + result.err
    assert "internal" not in result.err


def test_a_block_in_two_files_is_told(plcgen, tmp_path):
    """A warning at the second place, in any letter case, with a note of the first; exit code 0."""
    (tmp_path / "a.scl").write_text(GOOD)
    (tmp_path / "b.scl").write_text("\n" + GOOD.replace('"Add"', '"ADD"').replace("+ 1", "+ 2"))
    result = plcgen("check", tmp_path / "a.scl", tmp_path / "b.scl", "--json")
    (found,) = json.loads(result.out)["diagnostics"]
    assert (result.code, found["code"], found["severity"], found["line"]) == (0, "PG805", "warning", 2)
    assert found["file"].endswith("b.scl")
    assert [(n["message"], n["line"], n["file"][-5:]) for n in found["notes"]] == [("first declared here", 1, "a.scl")]
    assert json.loads(plcgen("check", tmp_path / "a.scl", "--json").out)["diagnostics"] == []
