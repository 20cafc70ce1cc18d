"""Code, old against new: tokens, so that comments, blanks and line breaks do not count."""

from __future__ import annotations

from collections.abc import Sequence
from difflib import SequenceMatcher

from plcgen.base.diagnostics import Span
from plcgen.s7.compare.model import BlockState, Found
from plcgen.s7.read.code import Code

MAX_TOKENS = 5000
"""Up to so many tokens between the first and the last difference are compared one by one."""
_SHOWN = 70


def compare_code(old: BlockState, new: BlockState) -> Found | None:
    """How many places changed and what the first one is; None if nothing did."""
    if old.code_hash == new.code_hash:
        return None
    a, b = old.code, new.code
    if a.form != b.form or not a.tokens or not b.tokens:
        known = bool(a.tokens) and bool(b.tokens)
        message = "code cannot be compared: one side is SCL, the other is not" if known else _whole(old, new)
        return Found("code-changed", "", message, old.code_hash, new.code_hash, old.span, new.span)
    hunks = _hunks(a.tokens, b.tokens)
    details = tuple(_hunk(a, b, hunk) for hunk in hunks)
    i, _, k, _ = hunks[0]
    was, now = _line(a, i), _line(b, k)
    several = f"{len(hunks)} places, first " if len(hunks) > 1 else ""
    message = f"code: {several}{details[0]}"
    places = (_place(old, i), _place(new, k))
    return Found("code-changed", "", message, was, now, *places, details if len(details) > 1 else ())


def _place(block: BlockState, token: int) -> Span | None:
    """Line of a token; the block where its code has no lines."""
    if block.span is None or not block.code.located:
        return block.span
    return Span(block.span.file, block.code.lines[min(token, len(block.code.lines) - 1)], 1)


def _whole(old: BlockState, new: BlockState) -> str:
    if not old.code_hash:
        return "code added"
    if not new.code_hash:
        return "code removed"
    return "code changed"


def _hunks(old: Sequence[str], new: Sequence[str]) -> list[tuple[int, int, int, int]]:
    """Ranges that differ as (old start, old end, new start, new end)."""
    limit = min(len(old), len(new))
    head = next((n for n in range(limit) if old[n] != new[n]), limit)
    tail = next((n for n in range(limit - head) if old[-1 - n] != new[-1 - n]), limit - head)
    a, b = old[head : len(old) - tail], new[head : len(new) - tail]
    if len(a) + len(b) > MAX_TOKENS:
        return [(head, head + len(a), head, head + len(b))]
    opcodes = SequenceMatcher(None, a, b, autojunk=False).get_opcodes()
    return [(head + i, head + j, head + k, head + n) for tag, i, j, k, n in opcodes if tag != "equal"]


def _hunk(old: Code, new: Code, hunk: tuple[int, int, int, int]) -> str:
    i, j, k, n = hunk
    line = new.lines[min(k, len(new.lines) - 1)]
    where = f"line {line}: " if new.located else ""
    if i == j:
        return f"{where}added {_quote(_line(new, k))}"
    if k == n:
        return f"{where}removed {_quote(_line(old, i))}"
    was, now = _line(old, i), _line(new, k)
    if was == now:
        was, now = " ".join(old.tokens[i:j]), " ".join(new.tokens[k:n])
    return f"{where}{_quote(was)} -> {_quote(now)}"


def _line(code: Code, index: int) -> str:
    return code.line(min(index, len(code.tokens) - 1))


def _quote(text: str) -> str:
    return f'"{text if len(text) <= _SHOWN else text[: _SHOWN - 3] + "..."}"'
