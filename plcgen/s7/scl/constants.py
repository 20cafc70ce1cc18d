"""Constant expressions of declarations: array bounds, string lengths, CONST."""

from __future__ import annotations

import math
import struct
from collections.abc import Mapping
from functools import lru_cache

from plcgen.s7.scl import ast
from plcgen.s7.types.data_types import DataType, StringType, elementary

_PREFIXES = {
    "B": "BYTE", "W": "WORD", "DW": "DWORD", "LW": "LWORD", "T": "TIME", "S5T": "S5TIME", "D": "DATE",
    "LT": "LTIME", "L": "DINT", "C": "WORD",
}  # fmt: skip
_LIMIT = 1 << 64
_SIGNED = {"SINT": 8, "INT": 16, "DINT": 32, "LINT": 64}
_REALS = {"REAL": 32, "LREAL": 64}
_BASES = frozenset({"2", "8", "16"})


@lru_cache(maxsize=4096)
def integer(text: str) -> int | None:
    """Value of an integer literal such as ``10``, ``16#FF``, ``INT#-5``; None for anything else."""
    head, _, digits = text.replace("_", "").rpartition("#")
    base = head.rpartition("#")[2]
    try:
        value = int(digits[:40], int(base) if base.isdigit() and base in {"2", "8", "16"} else 10)
    except ValueError:
        return None
    return value if -_LIMIT < value < _LIMIT else None


def filled(text: str, type_name: str) -> int | None:
    """Value of a constant whose bits fill a signed type up to the sign, as the TIA Portal reads it; else None.

    ``SINT#255`` and ``SINT#16#FF`` are -1 (help of the TIA Portal, "SINT (8-bit integers)"); a declaration takes
    16#8401 for an Int without a prefix, too (block SINA_SPEED_TLG352 of Siemens' library LSINAExt).
    """
    prefix, _, digits = text.strip().upper().partition("#")
    typed = prefix == type_name
    if type_name not in _SIGNED or not (typed or (prefix in _BASES and digits)):
        return None
    value, high = integer(text), 1 << _SIGNED[type_name] - 1
    return value - 2 * high if value is not None and high <= value < 2 * high else None


def is_bits_of_real(text: str, type_name: str) -> bool:
    """Whether a text gives a REAL or LREAL by its bits, as ``16#0010_0000_0000_0000`` or, infinite, ``16#7F80_0000``.

    Siemens' library LGF declares the largest and the smallest LReal so (LGF_SimpleAveraging). That bits of no number
    go as well is concluded: the TIA Portal writes ``16#0000000F``, a number of less precision, in a process library.
    """
    value = integer(text) if type_name in _REALS and text.partition("#")[0] in _BASES else None
    return value is not None and 0 <= value < 1 << _REALS[type_name]


def real_of_bits(text: str, type_name: str) -> float | None:
    """Value of the bits of a REAL or LREAL; None for other texts and for what is no number."""
    if not is_bits_of_real(text, type_name):
        return None
    width = _REALS[type_name]
    bits = (integer(text) or 0).to_bytes(width // 8, "big")
    found: float = struct.unpack(">f" if width == 32 else ">d", bits)[0]
    return found if math.isfinite(found) else None


def project_names(constants: Mapping[str, int]) -> dict[str, int]:
    """Constants of the project as ``evaluate`` knows them: with quotes, which those of a block do not have."""
    return {f'"{name.upper()}"': value for name, value in constants.items()}


def evaluate(node: ast.Expression, known: Mapping[str, int]) -> int | None:
    """Integer value of an expression of literals and known constants (by upper-case name), else None.

    Constants of the project have quotes in ``known``.
    """
    if isinstance(node, ast.Literal):
        return integer(node.text) if node.kind in {"int", "typed"} else None
    if isinstance(node, ast.Name):
        name = node.name.upper()
        found = known.get(f'"{name}"') if node.scope == "quoted" else None
        return known.get(name) if found is None else found
    if isinstance(node, ast.Unary) and node.operator in {"-", "+"}:
        value = evaluate(node.operand, known)
        return value if value is None or node.operator == "+" else -value
    return _evaluate_chain(node, known) if isinstance(node, ast.Binary) else None


def _evaluate_chain(node: ast.Binary, known: Mapping[str, int]) -> int | None:
    """Walk down the left side in a loop: chains may be long."""
    chain: list[ast.Binary] = []
    left: ast.Expression = node
    while isinstance(left, ast.Binary):
        chain.append(left)
        left = left.left
    value = evaluate(left, known)
    for link in reversed(chain):
        right = evaluate(link.right, known)
        if value is None or right is None:
            return None
        operator = link.operator
        result: int | None = None
        if operator == "+":
            result = value + right
        elif operator == "-":
            result = value - right
        elif operator == "*":
            result = value * right
        elif operator in {"/", "DIV"} and right:
            result = abs(value) // abs(right) * (1 if (value < 0) == (right < 0) else -1)
        elif operator == "MOD" and right:
            result = abs(value) % abs(right) * (-1 if value < 0 else 1)
        elif operator == "**" and 0 <= right <= 64 and abs(value) <= 2**16:
            result = value**right
        value = result if result is not None and abs(result) < _LIMIT else None
    return value


def type_of(node: ast.Expression, value: int | None) -> DataType:
    """Return the type a CONST without one takes from its value."""
    found: DataType | None = None
    if isinstance(node, ast.Literal):
        if node.kind == "real":
            found = elementary("REAL")
        elif node.kind == "bool":
            found = elementary("BOOL")
        elif node.kind == "string":
            found = StringType("STRING", max(1, len(node.text) - 2))
        elif node.kind == "typed":
            prefix = node.text.partition("#")[0].upper()
            found = elementary(_PREFIXES.get(prefix, prefix))
    if found is None:
        small = value is None or -(2**15) <= value < 2**15
        found = elementary("INT" if small else "DINT")
    assert found is not None  # both names are in the table of elementary types
    return found
