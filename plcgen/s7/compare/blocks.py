"""Blocks, old against new: matched by kind and name, renames found by number or by identical contents; their code."""

from __future__ import annotations

import hashlib
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from difflib import SequenceMatcher

from plcgen.base.diagnostics import Span
from plcgen.base.diagnostics.counting import shortlist
from plcgen.s7.compare.members import MemberComparison, text_change
from plcgen.s7.compare.model import TAG_TABLE, BlockState, Change, Found, MemberState
from plcgen.s7.compare.policy import Level
from plcgen.s7.read.code import Code
from plcgen.s7.types.blocks import OF_BLOCKS, optimized

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
        message = "code cannot be compared: one side is SCL, the other is not" if known else _whole_code(old, new)
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


def _whole_code(old: BlockState, new: BlockState) -> str:
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


_OWN_HASH = re.compile(r"'?H[0-9A-F]{7}'?")
"""In the header of a generated block: a hash of its text (docs/generated-code.md)."""
_ORDER = {"DB": 0, "FB": 1, "FC": 2, "OB": 3, "UDT": 4, TAG_TABLE: 5}


def compare_blocks(
    old: Sequence[BlockState],
    new: Sequence[BlockState],
    policy: Mapping[str, Level],
    *,
    comments: bool = True,
    classic: bool = False,
) -> list[Change]:
    """Every change, block by block: data blocks first, then code, then types; by name within a kind.

    ``comments`` is False if one side does not keep them; ``classic``: blocks that say nothing of their access are for
    S7-300/400.
    """
    pairs, gone, came = _match(old, new)
    found: list[tuple[BlockState, list[Change]]] = [(b, [_whole("block-removed", b, policy)]) for b in gone]
    found += [(b, [_whole("block-added", b, policy)]) for b in came]
    for before, after in pairs:
        found.append((after, _Pair(before, after, policy, comments=comments, classic=classic).changes()))
    found.sort(key=lambda item: (_ORDER.get(item[0].kind, 9), item[0].name.upper()))
    return [change for _, changes in found for change in changes]


def _whole(kind: str, block: BlockState, policy: Mapping[str, Level]) -> Change:
    size = "" if block.size is None else f", {block.size} bytes"
    spans = (block.span, None) if kind == "block-removed" else (None, block.span)
    what = "removed" if kind == "block-removed" else "added"
    return Change(kind, policy[kind], block.title, "", f"{what}{size}", "", "", *spans)


def _match(
    old: Sequence[BlockState], new: Sequence[BlockState]
) -> tuple[list[tuple[BlockState, BlockState]], list[BlockState], list[BlockState]]:
    names = {(block.kind, block.name.upper()): block for block in old}
    pairs = [(names[key], block) for block in new if (key := (block.kind, block.name.upper())) in names]
    kept_old, kept_new = {id(a) for a, _ in pairs}, {id(b) for _, b in pairs}
    gone = [block for block in old if id(block) not in kept_old]
    came = [block for block in new if id(block) not in kept_new]
    for identity in (_by_number, _by_contents):
        renamed = list(_unique(gone, came, identity))
        pairs += renamed
        gone = [block for block in gone if not any(block is a for a, _ in renamed)]
        came = [block for block in came if not any(block is b for _, b in renamed)]
    return pairs, gone, came


def _by_number(block: BlockState) -> str:
    return "" if block.number is None else f"{block.kind}{block.number}"


def _by_contents(block: BlockState) -> str:
    """Digest of declaration, start values and code; nothing is unmistakable about an empty block."""
    if not block.members and not block.code_hash:
        return ""
    lines = [block.kind, block.instance_of, block.code_hash, str(block.size), *block_lines(block.members)]
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()


def block_lines(members: Sequence[MemberState]) -> Iterator[str]:
    """One canonical line per own member."""
    pending = list(reversed(members))
    while pending:
        member = pending.pop()
        if not member.foreign:
            yield f"{member.section} {member.path.upper()} {member.offset} {member.type.upper()} {member.start}"
            pending.extend(reversed(member.inner))


def _unique(
    gone: Sequence[BlockState], came: Sequence[BlockState], key: Callable[[BlockState], str]
) -> Iterator[tuple[BlockState, BlockState]]:
    """Pairs that share a key which nothing else on either side has."""
    old, new = Counter(map(key, gone)), Counter(map(key, came))
    by_key = {key(block): block for block in gone}
    for block in came:
        own = key(block)
        if own and old[own] == 1 and new[own] == 1:
            yield by_key[own], block


class _Pair:
    """One block on both sides."""

    def __init__(
        self, old: BlockState, new: BlockState, policy: Mapping[str, Level], *, comments: bool, classic: bool
    ) -> None:
        self.old, self.new, self.policy, self.comments, self.classic = old, new, policy, comments, classic
        self.found: list[Change] = []

    def add(
        self, kind: str, message: str, old: str = "", new: str = "", *, path: str = "", details: tuple[str, ...] = ()
    ) -> None:
        """Keep a change of the block itself."""
        self.keep(Found(kind, path, message, old, new, self.old.span, self.new.span, details))

    def keep(self, found: Found) -> None:
        """Classify a difference."""
        self.found.append(Change(found.kind, self.policy[found.kind], self.new.title, *found[1:]))

    def changes(self) -> list[Change]:
        """Every change of this block."""
        old, new = self.old, self.new
        self.header()
        for found in MemberComparison(old, new, comments=self.comments).run():
            after = None if found.kind == "member-removed" else found.new_span or new.span
            self.keep(found._replace(old_span=found.old_span or old.span, new_span=after))
        self.assignments()
        self.local()
        code = compare_code(old, new)
        if code is not None:
            self.keep(code)
        return self.found

    def header(self) -> None:
        """Name, number, size, access, attributes, texts."""
        old, new = self.old, self.new
        if old.name.upper() != new.name.upper():
            self.add("block-renamed", f"{old.title} is now {new.title}", old.name, new.name)
        elif old.name != new.name:
            self.add("member-spelling", f"{old.name} is now spelled {new.name}", old.name, new.name)
        if None not in {old.number, new.number} and old.number != new.number:
            was, now = f"{old.kind}{old.number}", f"{new.kind}{new.number}"
            self.add("block-renumbered", f"{was} -> {now}", was, now)
        if old.instance_of.upper() != new.instance_of.upper():
            was, now = old.instance_of or "own members", new.instance_of or "own members"
            self.add("instance-type", f"made from {was} -> {now}", was, now)
        placed = not (old.optimized and new.optimized)  # else the CPU alone knows the size
        if placed and old.size is not None and new.size is not None and old.size != new.size:
            kind = "block-grown" if new.size > old.size else "block-shrunk"
            self.add(kind, f"{old.size} -> {new.size} bytes", str(old.size), str(new.size))
        self.access()
        instances = old.instance_of and new.instance_of  # of their retentivity a document says nothing
        if old.non_retain != new.non_retain and not (instances and _mixed(old, new)):
            was, now = _retain(old), _retain(new)
            self.add("retain-changed", f"the block: {was} -> {now}", was, now)
        spelt = {_key(name): name for name, _ in (*old.attributes, *new.attributes)}
        before, after = ({_key(name): value for name, value in side.attributes} for side in (old, new))
        for key, was, now in _differences(before, after):
            if was.upper() == now.upper():
                continue
            usual = key in OF_BLOCKS and not _is_document(old if was else new)
            if not ((was and now) or usual) and _mixed(old, new):
                continue  # a text has no words for most of what a document says
            name = spelt[key]
            self.add("block-attribute", f"{name} {was or '(absent)'} -> {now or '(absent)'}", was, now)
        if self.comments:
            before, after = dict(old.texts), dict(new.texts)
            hashed = any(_OWN_HASH.fullmatch(side.get("name", "")) for side in (before, after))
            for name, was, now in _differences(before, after):
                if _mixed(old, new) and not (was and now):
                    continue  # not every text has a place in both spellings
                if hashed and name in {"name", "version"}:
                    continue  # which plcgen made it, and what follows from all that is compared here
                self.add("block-text", f"{name} {text_change(was, now)}", was, now)

    def access(self) -> None:
        """Optimized or standard access. An instance that says nothing has that of its function block."""
        old, new = self.old, self.new
        stated = [side.optimized for side in (old, new) if side.optimized is not None]
        follows = old.instance_of and new.instance_of and "UDT" not in {old.instance_kind, new.instance_kind}
        if not stated or (len(stated) == 1 and follows):
            return
        was, now = (self.meant(side) for side in (old, new))
        if was != now:
            self.add("access-changed", f"{was} -> {now} access", was, now)

    def meant(self, block: BlockState) -> str:
        """Access of a block, stated or not."""
        classic = self.classic or (block.number is not None and not _is_document(block))  # a text of STEP 7 V5
        given = block.optimized
        return "optimized" if (optimized(classic=classic) if given is None else given) else "standard"

    def assignments(self) -> None:
        """Start values that a DB gives to members of its types."""
        before, after = dict(self.old.assignments), dict(self.new.assignments)
        if self.old.instance_of and not self.old.instance_kind and _mixed(self.old, self.new):
            # Without the function block nobody knows which values of the document are its own.
            before = {path: before[path] for path in before.keys() & after.keys()}
            after = {path: after[path] for path in before}
        for path, was, now in _differences(before, after):
            message = f"start value {was or 'of the type'} -> {now or 'of the type'}"
            self.add("start-value", message, was, now, path=path)

    def local(self) -> None:
        """Temporary variables and constants: values of constants one by one, the rest in one change."""
        old = {(m.section, m.name.upper()): m for m in self.old.locals}
        new = {(m.section, m.name.upper()): m for m in self.new.locals}
        details = [f"{new[key].name} added" for key in new if key not in old]
        details += [f"{old[key].name} removed" for key in old if key not in new]
        for key in (key for key in new if key in old):
            before, after = old[key], new[key]
            if before.type.upper() != after.type.upper():
                details.append(f"{after.name}: {before.type} -> {after.type}")
            elif before.start != after.start:
                message = f"{before.start or '(no value)'} -> {after.start or '(no value)'}"
                self.add("constant-changed", message, before.start, after.start, path=after.name)
            elif self.comments and before.comment != after.comment:
                message = f"comment {text_change(before.comment, after.comment)}"
                self.add("member-comment", message, before.comment, after.comment, path=after.name)
        if details:
            shown = shortlist(sorted(details), 3, f", .. ({len(details)})")
            self.add("local-changed", shown, details=tuple(sorted(details)))


def _mixed(old: BlockState, new: BlockState) -> bool:
    """Whether one side is a document, the other a text, which states less or other things; locks are neither."""
    files = [block.span.file.lower() for block in (old, new) if block.span is not None]
    return _is_document(old) != _is_document(new) and not any(file.endswith((".json", ".yaml")) for file in files)


def _is_document(block: BlockState) -> bool:
    return block.span is not None and block.span.file.lower().endswith(".xml")


def _key(attribute: str) -> str:
    """Name of an attribute in both spellings: a text has ``DB_Accessible_From_OPC_UA``, a document no underscores."""
    return attribute.upper().replace("_", "")


def _retain(block: BlockState) -> str:
    return "not retentive" if block.non_retain else "retentive"


def _differences(old: Mapping[str, str], new: Mapping[str, str]) -> Iterator[tuple[str, str, str]]:
    for name in sorted(old.keys() | new.keys()):
        was, now, default = old.get(name, ""), new.get(name, ""), OF_BLOCKS.get(name.upper(), "")
        if was != now and not {was.upper(), now.upper()} <= {"", default}:
            yield name, was, now
