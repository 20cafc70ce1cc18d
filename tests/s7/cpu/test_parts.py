"""Parts of a value, wherever the variable lies: members of a DTL, slices, characters, and bytes that others write."""

import pytest

from plcgen.s7.cpu.testing import load_scl

MOMENT = "DTL#2012-03-04-05:06:07.000000008"
"""The 4 March 2012 was a Sunday: WEEKDAY 1."""
READ = [
    *(("DTL", MOMENT, f"#p.{part}", type_, value) for part, type_, value in (
        ("YEAR", "UInt", 2012), ("MONTH", "USInt", 3), ("DAY", "USInt", 4), ("WEEKDAY", "USInt", 1),
        ("HOUR", "USInt", 5), ("MINUTE", "USInt", 6), ("SECOND", "USInt", 7), ("NANOSECOND", "UDInt", 8),
    )),
    ("Byte", "16#81", "#p.%X7", "Bool", True), ("Word", "16#1234", "#p.%X2", "Bool", True),
    ("Word", "16#1234", "#p.%B1", "Byte", 0x12), ("Int", "-2", "#p.%X0", "Bool", False),
    ("DWord", "16#12345678", "#p.%W1", "Word", 0x1234), ("DInt", "16#12345678", "#p.%B0", "Byte", 0x78),
    ("LWord", "16#123456789ABCDEF0", "#p.%D1", "DWord", 0x12345678),
    ("String", "'abc'", "#p[2]", "Char", "b"), ("WString", "WSTRING#'abc'", "#p[2]", "WChar", "b"),
    ("Struct a : Byte; d : DTL; END_STRUCT", f"(1, {MOMENT})", "#p.d.DAY", "USInt", 4),
    ("Array[1..2] of DTL", f"[{MOMENT}, {MOMENT}]", "#p[2].YEAR", "UInt", 2012),
]  # fmt: skip
"""Type, value, part, type of the part, its value."""
WRITTEN = [
    ("DTL", MOMENT, "#p.MONTH", "USInt", 11, "11"), ("DTL", MOMENT, "#p.NANOSECOND", "UDInt", 70000, "70000"),
    ("Word", "16#1234", "#p.%X0", "Bool", True, "TRUE"), ("DWord", "16#12345678", "#p.%B3", "Byte", 1, "16#01"),
    ("String", "'abc'", "#p[2]", "Char", "z", "'z'"), ("WString", "WSTRING#'abc'", "#p[3]", "WChar", "z", "WCHAR#'z'"),
]  # fmt: skip
"""The same with what is written there first."""
PLACES = [
    *(("FUNCTION_BLOCK", section) for section in ("VAR_INPUT", "VAR_OUTPUT", "VAR_IN_OUT", "VAR", "VAR_TEMP")),
    *(("FUNCTION", section) for section in ("VAR_INPUT", "VAR_OUTPUT", "VAR_IN_OUT", "VAR_TEMP", "RETURN")),
]
ACCESS = ("TRUE", "FALSE")


def outcome(kind, section, access, type_, value, part, part_type, written=""):
    """The part as the block with the variable saw it, and as its caller found it behind the call."""
    if "Struct" in type_:
        udt = f'TYPE "u"\nSTRUCT\n{type_[7:-10]}\nEND_STRUCT;\nEND_TYPE\n'
        type_ = '"u"'
    else:
        udt = ""
    attribute = f"{{ S7_Optimized_Access := '{access}' }}\n"
    local = "#B" if section == "RETURN" else "#p"
    given = section in {"VAR_INPUT", "VAR_IN_OUT"}
    body = "" if given else f"{local} := #d;\n"
    body += f"{part.replace('#p', local)} := {written};\n" if written else ""
    body += f"#y := {part.replace('#p', local)};\n"
    declared = "" if section == "RETURN" else f"{section}\np : {type_};\nEND_VAR\n"
    passed = f"VAR_INPUT\nd : {type_};\nEND_VAR\n" if not given else ""
    returned = f" : {type_}" if section == "RETURN" else " : Void" if kind == "FUNCTION" else ""
    block = f'{kind} "B"{returned}\n{attribute}{passed}VAR_OUTPUT\ny : {part_type};\nEND_VAR\n{declared}BEGIN\n'
    block += f"{body}END_{kind}\n"
    arguments = f"{'p' if given else 'd'} := #q, y => #y{', p => #q' if section == 'VAR_OUTPUT' else ''}"
    called = '"B"' if kind == "FUNCTION" else "#i"
    call = f"{'#q := ' if section == 'RETURN' else ''}{called}({arguments});"
    start = "" if udt else f" := {value}"
    fill = f"#q.a := 1; #q.d := {MOMENT};\n" if udt else ""
    instance = 'i : "B";' if kind == "FUNCTION_BLOCK" else ""
    caller = (
        f'FUNCTION_BLOCK "Test"\n{attribute}VAR\nq : {type_}{start}; y : {part_type}; z : {part_type}; {instance}\n'
        f"END_VAR\nBEGIN\n{fill}{call}\n#z := {part.replace('#p', '#q')};\nEND_FUNCTION_BLOCK\n"
        f'DATA_BLOCK "Test_DB"\n{attribute}"Test"\nBEGIN\nEND_DATA_BLOCK\n'
    )
    bench = load_scl(udt + block + caller)
    bench.call("Test_DB")
    assert bench.cpu.misuses == []
    return bench.cpu["Test_DB.y"], bench.cpu["Test_DB.z"]


@pytest.mark.parametrize(("kind", "section"), PLACES)
@pytest.mark.parametrize("access", ACCESS)
def test_reading_a_part(kind, section, access):
    """A part has the value that the bytes of the whole say, inside of the block and behind the call."""
    for type_, value, part, part_type, wanted in READ:
        found = outcome(kind, section, access, type_, value, part, part_type)
        assert found == (wanted, wanted), (type_, part)


@pytest.mark.parametrize(("kind", "section"), [place for place in PLACES if place[1] != "VAR_INPUT"])
@pytest.mark.parametrize("access", ACCESS)
def test_writing_a_part(kind, section, access):
    """A part that was written is read again; behind the call it is so where the variable goes back to the caller."""
    back = section in {"VAR_OUTPUT", "VAR_IN_OUT", "RETURN"}
    for type_, value, part, part_type, wanted, written in WRITTEN:
        seen, behind = outcome(kind, section, access, type_, value, part, part_type, written)
        assert (seen, behind == wanted) == (wanted, back), (type_, part)


@pytest.mark.parametrize("access", ACCESS)
def test_parts_from_outside(access):
    """A path of Python goes into a DTL, to read and to write."""
    text = f"d : DTL := {MOMENT}; s : Struct e : Array[0..1] of DTL; END_STRUCT;"
    attribute = f"{{ S7_Optimized_Access := '{access}' }}\n"
    cpu = load_scl(f'DATA_BLOCK "x"\n{attribute}VAR\n{text}\nEND_VAR\nBEGIN\nEND_DATA_BLOCK\n').cpu
    assert [cpu[f"x.d.{part}"] for part in ("YEAR", "month", "NANOSECOND")] == [2012, 3, 8]
    cpu["x.s.e[1].HOUR"] = 23
    assert (cpu["x.s.e[1].HOUR"], cpu["x.s.e[0].HOUR"]) == (23, 0)
    with pytest.raises(KeyError, match="no member YEARS"):
        cpu["x.d.YEARS"]


MOVED = {
    "Bool": ("FALSE", "TRUE", True), "Byte": ("0", "16#A5", 0xA5), "Int": ("0", "-2", -2), "DWord": ("0", "16#1", 1),
    "Real": ("0.0", "1.5", 1.5), "LReal": ("0.0", "-2.5", -2.5), "Char": ("'a'", "'b'", "b"),
    "Time": ("T#0s", "T#1s", 1000), "DTL": (MOMENT, "DTL#1970-01-01-00:00:00", 0),
}  # fmt: skip


@pytest.mark.parametrize(("type_", "row"), MOVED.items(), ids=MOVED)
@pytest.mark.parametrize("place", ["temp of an FB", "temp of an FC", "output of an FC"])
def test_local_variables_take_what_a_reference_writes(type_, row, place):
    """A block or instruction that is given a variable as a pointer writes into that variable, not into a copy."""
    first, second, wanted = row
    fc = place.endswith("FC")
    section = "VAR_OUTPUT" if place.startswith("output") else "VAR_TEMP"
    name = "v" if section == "VAR_OUTPUT" else "y"
    other = "" if section == "VAR_OUTPUT" else f"VAR_OUTPUT\ny : {type_};\nEND_VAR\n"
    head = f"VAR_INPUT\nd : {type_};\nEND_VAR\n{other}{section}\nv : {type_}; n : Int;\nEND_VAR\n"
    body = f"#v := {first}; #n := BLKMOV(SRCBLK := #d, DSTBLK => #v);" + ("" if name == "v" else " #y := #v;")
    kind, returned = ("FUNCTION", " : Void") if fc else ("FUNCTION_BLOCK", "")
    call = (
        f'"B"(d := #d, {"n => #n, " if section == "VAR_OUTPUT" else ""}{name} => #y);'
        if fc
        else "#i(d := #d, y => #y);"
    )
    inner = "" if fc else 'i : "B";'
    text = (
        f'{kind} "B"{returned}\n{head}BEGIN\n{body}\nEND_{kind}\n'
        f'FUNCTION_BLOCK "Test"\nVAR\nd : {type_} := {second}; y : {type_}; n : Int; {inner}\nEND_VAR\n'
        f'BEGIN\n{call}\nEND_FUNCTION_BLOCK\nDATA_BLOCK "Test_DB"\n"Test"\nBEGIN\nEND_DATA_BLOCK\n'
    )
    bench = load_scl(text)
    bench.call("Test_DB")
    assert bench.cpu["Test_DB.y"] == wanted
