"""Which documented instructions the soft CPU knows, checks and executes: found by compiling a call of each."""

from __future__ import annotations

import enum
from collections.abc import Mapping
from functools import cache
from types import MappingProxyType

from plcgen.s7.cpu.program import Program
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.scl.instructions import S7_300, S7_1500, documented

DIALECTS = {S7_300: Dialect.TIA_300_400, S7_1500: Dialect.TIA_1200_1500}
"""Target of the TIA Portal that each family of the help stands for."""
_STATEMENTS = frozenset({"IF", "CASE", "FOR", "WHILE", "REPEAT", "CONTINUE", "EXIT", "GOTO", "RETURN", "REGION"})
_BY_TYPE = {"CONVERT": "REAL_TO_INT"}
"""Instructions that SCL has under the names of types."""
_FORMS = ("", "_TIME", "_INT")
"""What stands behind the name of an instruction in the name of its instance type."""
_PROBE = (
    "FUNCTION_BLOCK \"Probe\"\n{{ S7_Optimized_Access := 'FALSE' }}\n"
    "VAR\nx : {type};\nEND_VAR\nBEGIN\n{call}(nonsense_ := 1);\nEND_FUNCTION_BLOCK\n"
)


class State(enum.IntEnum):
    """What happens to a call; each state has what those before have."""

    UNKNOWN = 0
    KNOWN = 1
    CHECKED = 2
    EXECUTED = 3


def state_of(name: str, dialect: Dialect) -> State:
    """How far the soft CPU goes with an instruction: the name, its parameters, or all of it.

    A parameter that no instruction has is reported (PG822) where parameters are checked, and the statement is not
    executed (PG827) where the instruction is not.
    """
    upper = name.upper()
    if upper in _STATEMENTS:
        return State.EXECUTED
    found = [_probe(_BY_TYPE.get(upper, name), "Int", dialect)]
    found += [_probe("#x", f"{name}{form}", dialect) for form in _FORMS]
    return max(found)


def _probe(call: str, type_: str, dialect: Dialect) -> State:
    program = Program.load([("probe.scl", _PROBE.format(call=call, type=type_))], dialect)
    codes = {problem.code for problem in program.diagnostics if "without" not in problem.message}
    if "PG822" in codes:
        return State.CHECKED if "PG827" in codes else State.EXECUTED
    return State.KNOWN if codes == {"PG827"} else State.UNKNOWN


@cache
def states(family: str) -> Mapping[str, State]:
    """State of every instruction of a family that the help documents."""
    return MappingProxyType({name: state_of(name, DIALECTS[family]) for name in documented(family)})
