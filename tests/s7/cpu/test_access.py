"""Structured IN_OUT parameters between standard and optimised access: a copy, and what its copy-back overwrites.

Help of the TIA Portal, "Parameter transfer with S7-1200/1500", and FAQ 109478253: by pointer if the memory of the
actual parameter and the called block have the same access setting, else by copy.
"""

import pytest

from plcgen.s7.cpu.testing import load_scl

PROGRAM = """TYPE "Pair"
STRUCT a : Int; b : Int; END_STRUCT;
END_TYPE
DATA_BLOCK "Shared"
{ S7_Optimized_Access := '%(data)s' }
STRUCT pair : "Pair"; END_STRUCT;
BEGIN
END_DATA_BLOCK
FUNCTION_BLOCK "Inner"
{ S7_Optimized_Access := '%(inner)s' }
VAR_IN_OUT
pair : "Pair";
END_VAR
VAR
n : Int;
END_VAR
BEGIN
#n := #n + 1;
#pair.a := #pair.a + 1;
END_FUNCTION_BLOCK
FUNCTION_BLOCK "Outer"
{ S7_Optimized_Access := '%(outer)s' }
VAR_IN_OUT
pair : "Pair";
END_VAR
VAR
inner : "Inner";
END_VAR
BEGIN
#inner(pair := #pair);
END_FUNCTION_BLOCK
FUNCTION "Direct" : Void
{ S7_Optimized_Access := '%(outer)s' }
VAR_IN_OUT
pair : "Pair";
END_VAR
BEGIN
#pair.a := #pair.a + 1;
END_FUNCTION
DATA_BLOCK "Outer_DB"
{ S7_Optimized_Access := '%(outer)s' }
"Outer"
BEGIN
END_DATA_BLOCK
ORGANIZATION_BLOCK "Main"
{ S7_Optimized_Access := 'FALSE' }
BEGIN
%(call)s
END_ORGANIZATION_BLOCK
ORGANIZATION_BLOCK "Fast"
{ S7_Optimized_Access := 'FALSE' }
BEGIN
"Shared".pair.b := 7;
END_ORGANIZATION_BLOCK
"""
NESTED, DIRECT = '"Outer_DB"(pair := "Shared".pair);', '"Direct"(pair := "Shared".pair);'


def program(*, data, outer, inner, call=NESTED):
    """A CPU with these access settings, True for optimised."""
    names = {"data": data, "outer": outer, "inner": inner}
    return load_scl(PROGRAM % ({name: str(value).upper() for name, value in names.items()} | {"call": call})).cpu


def lost(**settings):
    """Whether what Fast writes is lost at some point of Main; what Main writes arrives in any case."""
    count = len(program(**settings).run("Main", interrupt={}).points)
    found = set()
    for number in range(count):
        cpu = program(**settings)
        cpu.run("Main", interrupt={number: "Fast"})
        assert cpu["Shared.pair.a"] == 1
        assert cpu.misuses == []
        found.add(cpu["Shared.pair.b"])
    assert found <= {0, 7}
    return 0 in found


@pytest.mark.parametrize("optimized", [False, True])
def test_the_same_access_is_a_pointer(optimized):
    """Nothing is copied, nothing is lost."""
    assert lost(data=optimized, outer=optimized, inner=optimized) is False
    assert lost(data=optimized, outer=optimized, inner=optimized, call=DIRECT) is False


@pytest.mark.parametrize(
    ("data", "outer", "inner"), [(True, False, False), (False, True, True), (False, False, True), (True, True, False)]
)
def test_mixed_access_is_a_copy(data, outer, inner):
    """The copy-back overwrites what another OB wrote meanwhile, also where a parameter is handed on."""
    assert lost(data=data, outer=outer, inner=inner) is True


@pytest.mark.parametrize("data", [True, False])
def test_a_function_with_mixed_access(data):
    """An FC gets a copy likewise."""
    assert lost(data=data, outer=not data, inner=data, call=DIRECT) is True


def test_a_copied_record_lies_in_local_data():
    """RECORD behind a hidden copy is local data: asynchronous blocks refuse it (help, asynchronous instructions)."""
    source = """DATA_BLOCK "Buffer"
{ S7_Optimized_Access := 'TRUE' }
STRUCT q : Array[0..9] of Byte; END_STRUCT;
BEGIN
END_DATA_BLOCK
FUNCTION_BLOCK "Send"
{ S7_Optimized_Access := 'FALSE' }
VAR_IN_OUT
q : Array[0..9] of Byte;
END_VAR
VAR
w : WRREC;
END_VAR
BEGIN
#w(REQ := TRUE, ID := 271, INDEX := 47, LEN := 10, RECORD := #q);
END_FUNCTION_BLOCK
DATA_BLOCK "Send_DB"
{ S7_Optimized_Access := 'FALSE' }
"Send"
BEGIN
END_DATA_BLOCK
ORGANIZATION_BLOCK "Main"
{ S7_Optimized_Access := 'FALSE' }
BEGIN
"Send_DB"(q := "Buffer".q);
END_ORGANIZATION_BLOCK
"""
    mixed, same = load_scl(source).cpu, load_scl(source.replace("'TRUE'", "'FALSE'")).cpu
    mixed.scan()
    same.scan()
    assert ([m.code for m in mixed.misuses], [m.code for m in same.misuses]) == (["PG831"], [])


TWO = """DATA_BLOCK "Other"
{ S7_Optimized_Access := 'TRUE' }
STRUCT pair : "Pair"; END_STRUCT;
BEGIN
END_DATA_BLOCK
FUNCTION_BLOCK "Both"
{ S7_Optimized_Access := 'FALSE' }
VAR_IN_OUT
one : "Pair"; two : "Pair";
END_VAR
BEGIN
#one.a := #one.a + 1; #two.a := #two.a + 1;
END_FUNCTION_BLOCK
DATA_BLOCK "Both_DB"
{ S7_Optimized_Access := 'FALSE' }
"Both"
BEGIN
END_DATA_BLOCK
"""


def test_copies_are_known_until_their_call_ends():
    """However many there were before: 6000 calls with two copies each."""
    call = '"Both_DB"(one := "Shared".pair, two := "Other".pair);'
    cpu = load_scl(PROGRAM % {"data": "TRUE", "outer": "TRUE", "inner": "TRUE", "call": call} + TWO).cpu
    for _ in range(6000):
        cpu.call("Main", 1)
    assert (cpu["Shared.pair.a"], cpu["Other.pair.a"], cpu.misuses) == (6000, 6000, [])
