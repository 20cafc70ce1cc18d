"""Members of one block, old against new: matched by path, renames found by place and type, moves reported once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from difflib import SequenceMatcher

from plcgen.base.diagnostics import Span
from plcgen.base.diagnostics.counting import quantity
from plcgen.s7.compare.model import ADDRESS, BlockState, Found, MemberState, path_steps
from plcgen.s7.types.blocks import OF_MEMBERS

INTERNAL = frozenset(
    {"member-added", "member-removed", "member-renamed", "type-changed", "length-changed", "section-changed"}
)
"""Changes of a static variable of an FB that only the block itself notices."""
MOST_RUNS = 5
"""More runs of moved members in one block are reported as one."""


_VISIBLE = {"EXTERNALVISIBLE": "visible", "EXTERNALACCESSIBLE": "readable", "EXTERNALWRITABLE": "writable"}

_REQUIRED = {"FC": frozenset({"Input", "Output", "InOut"}), "FB": frozenset({"InOut"})}


@dataclass(slots=True)
class MemberComparison:
    """Differences of one pair of blocks; ``pairs`` are the matched members that have a place, in new order."""

    old: BlockState
    new: BlockState
    comments: bool = True
    found: list[Found] = field(default_factory=list)
    pairs: list[tuple[MemberState, MemberState]] = field(default_factory=list)
    static: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        for side in (self.old, self.new):
            if "FB" in {side.kind, side.instance_kind}:
                self.static |= {m.path for m in side.members if m.section == "Static"}

    def run(self) -> list[Found]:
        """Everything that differs, moves last."""
        self.scope(self.old.members, self.new.members, top=True)
        inside = [f for f in self.found if f.kind in INTERNAL and _root(f.path) in self.static]
        self.found = [found for found in self.found if found not in inside]
        if inside:
            details = tuple(f"{found.path}: {found.message}" for found in inside)
            shown = ", ".join(dict.fromkeys(found.path for found in inside[:3]))
            message = f"static variables: {shown}{f', .. ({len(inside)})' if len(inside) > 3 else ''}"
            places = (inside[0].old_span, inside[0].new_span)
            self.found.append(Found("internal-changed", "", message, "", "", *places, details))
        if not (self.old.optimized and self.new.optimized):
            self.moved()
        elif self.new.kind in {"DB", "FB"} and not self.new.instance_of:
            self.reordered()
        return self.found

    def reordered(self) -> None:
        """Members of an optimized DB or FB before others than they were: the CPU gets it, or its instances, anew."""
        old = {(m.section, m.path.upper()): m for m in self.old.members}
        new = {(m.section, m.path.upper()): m for m in self.new.members}
        before, after = [key for key in old if key in new], [key for key in new if key in old]
        moved = next((new[key] for was, key in zip(before, after, strict=True) if key != was), None)
        if moved is not None:
            message = "is at another place among the members"
            self.add("member-reordered", moved, message)

    def moved(self) -> None:
        """Moves: of static variables in one change, in a DB made from a type in one change, else run by run."""
        outside = [pair for pair in self.pairs if _root(pair[1].path) not in self.static]
        inside = [pair for pair in self.pairs if _root(pair[1].path) in self.static]
        runs = moves(outside, self.new.members)
        if self.new.instance_of and len(runs) > 1:
            runs = [_together(runs, "member-moved", f"follows {self.new.instance_of}")]
        elif len(runs) > MOST_RUNS:
            runs = [_together(runs, "member-moved", f"in {len(runs)} steps")]
        self.found += runs
        hidden = moves(inside, self.new.members)
        if hidden:
            self.found.append(_together(hidden, "internal-moved", "static variables"))

    def add(
        self, kind: str, member: MemberState, message: str, old: str = "", new: str = "", *, before: Span | None = None
    ) -> None:
        """Keep one difference; ``member`` is the new one, or the old one if it is gone."""
        gone = kind == "member-removed"
        spans = (member.span, None) if gone else (before, member.span)
        self.found.append(Found(kind, member.path, message, old, new, *spans))

    def scope(self, old: Sequence[MemberState], new: Sequence[MemberState], *, top: bool = False) -> None:
        """Members that share one parent."""
        matched = match(old, new)
        by_new = {id(b): a for a, b in matched}
        by_old = {id(a) for a, _ in matched}
        for member in old:
            if id(member) not in by_old and not member.foreign:
                self.add("member-removed", member, f"removed: {_shown(member)}", old=_shown(member))
        for member in new:
            before = by_new.get(id(member))
            if before is not None:
                self.pair(before, member)
            elif not member.foreign:
                required = top and member.section in _REQUIRED.get(self.new.kind, ())
                what = f"added: {_shown(member)}"
                self.add("parameter-required" if required else "member-added", member, what, new=_shown(member))

    def pair(self, old: MemberState, new: MemberState) -> None:
        """One member on both sides."""
        if old.offset is not None and new.offset is not None:
            self.pairs.append((old, new))
        if not (old.foreign or new.foreign):
            self.own(old, new)
        if old.inner or new.inner:
            self.scope(old.inner, new.inner)

    def own(self, old: MemberState, new: MemberState) -> None:
        """Everything about a member but its place."""
        if old.name.upper() != new.name.upper():
            message = f"{old.path} is now {new.path}"
            self.add("member-renamed", new, message, old.path, new.path, before=old.span)
        elif old.name != new.name:
            message = f"{old.name} is now spelled {new.name}"
            self.add("member-spelling", new, message, old.name, new.name, before=old.span)
        if old.section != new.section:
            message = f"{old.section or 'no section'} -> {new.section or 'no section'}"
            self.add("section-changed", new, message, old.section, new.section, before=old.span)
        if old.type.upper() != new.type.upper():
            self.type(old, new)
        elif old.start != new.start and not ((old.offset is None) != (new.offset is None) and "[" in old.type):
            message = f"start value {old.start or _default(old)} -> {new.start or _default(new)}"
            self.add("start-value", new, message, old.start, new.start, before=old.span)
        if self.comments and old.comment != new.comment:
            message = f"comment {text_change(old.comment, new.comment)}"
            self.add("member-comment", new, message, old.comment, new.comment, before=old.span)
        self.attributes(old, new)

    def type(self, old: MemberState, new: MemberState) -> None:
        """Another type, or the same one in another length."""
        kind = "length-changed" if _stem(old.type) == _stem(new.type) else "type-changed"
        size = ""
        if old.bits is not None and new.bits is not None and old.bits != new.bits:
            size = f" ({_size(old.bits)} -> {_size(new.bits)})"
        self.add(kind, new, f"{old.type} -> {new.type}{size}", old.type, new.type, before=old.span)

    def attributes(self, old: MemberState, new: MemberState) -> None:
        """Retentivity, access from outside, and everything else in braces."""
        before, after = ({name.upper(): value for name, value in side.attributes} for side in (old, new))
        spelt = {name.upper(): name for name, _ in (*old.attributes, *new.attributes)}
        for name in sorted(before.keys() | after.keys()):
            was, now = before.get(name, ""), after.get(name, "")
            default = OF_MEMBERS.get(name, "")
            if (was or default) == (now or default):
                continue
            if name == "RETAIN":
                was, now = was or default, now or default
                self.add("retain-changed", new, f"{was.lower()} -> {now.lower()}", was, now, before=old.span)
            elif name == ADDRESS.upper():
                self.add("tag-address", new, f"{was or '(none)'} -> {now or '(none)'}", was, now, before=old.span)
            elif name in _VISIBLE:
                was, now = was or default, now or default
                lost = now == "FALSE"
                what = f"{'no longer' if lost else 'now'} {_VISIBLE[name]} from HMI and OPC UA"
                kind = "hmi-access-removed" if lost else "hmi-access-added"
                self.add(kind, new, what, was, now, before=old.span)
            else:
                what = f"{spelt[name]} {was or '(absent)'} -> {now or '(absent)'}"
                self.add("member-attribute", new, what, was, now, before=old.span)


def match(old: Sequence[MemberState], new: Sequence[MemberState]) -> list[tuple[MemberState, MemberState]]:
    """Pairs by name in any letter case, then renames: what lies between the same neighbours and has the same types."""
    names = {member.name.upper(): member for member in old}
    pairs = [(names[m.name.upper()], m) for m in new if m.name.upper() in names]
    if len(pairs) < min(len(old), len(new)):
        pairs += _renamed(old, new, {m.name.upper() for _, m in pairs})
    return pairs


def _renamed(
    old: Sequence[MemberState], new: Sequence[MemberState], known: set[str]
) -> Iterator[tuple[MemberState, MemberState]]:
    before = [m.name.upper() for m in old]
    after = [m.name.upper() for m in new]
    for tag, i, j, k, n in SequenceMatcher(None, before, after, autojunk=False).get_opcodes():
        if tag != "replace":
            continue
        gone = [m for m in old[i:j] if m.name.upper() not in known]
        came = [m for m in new[k:n] if m.name.upper() not in known]
        if len(gone) == len(came) and all(_alike(a, b) for a, b in zip(gone, came, strict=True)):
            yield from zip(gone, came, strict=True)
            continue
        places = {m.offset: m for m in gone if m.offset is not None}
        for member in came:
            there = None if member.offset is None else places.get(member.offset)
            if there is not None and _alike(there, member):
                yield there, member


def _alike(old: MemberState, new: MemberState) -> bool:
    same = old.type.upper() == new.type.upper() and old.section == new.section and old.bits == new.bits
    names = [[inner.name.upper() for inner in member.inner] for member in (old, new)]
    return same and names[0] == names[1]


def moves(pairs: Iterable[tuple[MemberState, MemberState]], order: Sequence[MemberState]) -> list[Found]:
    """Members at other offsets, one difference per run of members that moved by the same distance."""
    moved = [(a, b, (b.offset or 0) - (a.offset or 0)) for a, b in pairs]
    runs: list[list[tuple[MemberState, MemberState, int]]] = []
    for item in moved:
        if runs and runs[-1][-1][2] == item[2]:
            runs[-1].append(item)
        else:
            runs.append([item])
    before: dict[int, MemberState] = {}
    previous: MemberState | None = None
    pending = list(reversed(order))
    while pending:
        member = pending.pop()
        if previous is not None:
            before[id(member)] = previous
        previous = member
        pending.extend(reversed(member.inner))
    found: list[Found] = []
    for number, run in enumerate(runs):
        if run[0][2]:
            found.append(_move(run, before.get(id(run[0][1])), last=number == len(runs) - 1))
    return found


def _together(runs: Sequence[Found], kind: str, what: str) -> Found:
    """Several runs as one difference."""
    details = tuple(detail for run in runs for detail in (run.details or (f"{run.path} {run.old} -> {run.new}",)))
    first = runs[0]
    message = f"{what}: {quantity(len(details), 'member')} moved, the first one {first.path} {first.old} -> {first.new}"
    return first._replace(kind=kind, path="", message=message, details=details)


def _move(run: Sequence[tuple[MemberState, MemberState, int]], before: MemberState | None, *, last: bool) -> Found:
    leaves = [(a, b) for a, b, _ in run if not b.inner] or [(a, b) for a, b, _ in run]
    details = tuple(f"{b.path} {offset_text(a.offset)} -> {offset_text(b.offset)}" for a, b, _ in run)
    first, new = run[0][0], run[0][1]
    by = _distance(run[0][2])
    if len(leaves) == 1:
        message = f"moved by {by}: {offset_text(first.offset)} -> {offset_text(new.offset)}"
        path = leaves[0][1].path
    else:
        path = new.path
        example = f"{len(leaves)} members, the first one {offset_text(first.offset)} -> {offset_text(new.offset)}"
        if last and before is not None:
            message = f"everything after {before.path} moved by {by}: {example}"
        elif last:
            message = f"everything moved by {by}: {example}"
        else:
            message = f"{new.path} to {run[-1][1].path} moved by {by}: {example}"
    old, now = offset_text(first.offset), offset_text(new.offset)
    return Found("member-moved", path, message, old, now, first.span, new.span, details if len(leaves) > 1 else ())


def text_change(old: str, new: str) -> str:
    """``"old" -> "new"`` of the first line that differs, cut to a readable length."""
    before, after = old.split("\n"), new.split("\n")
    differing = (n for n, (a, b) in enumerate(zip(before, after, strict=False)) if a != b)
    line = next(differing, min(len(before), len(after)))
    return " -> ".join(_cut(lines[line] if line < len(lines) else "") for lines in (before, after))


def _cut(text: str) -> str:
    return f'"{text if len(text) <= 60 else text[:57] + "..."}"'


def offset_text(bits: int | None) -> str:
    """Offset as S7 editors write it: ``6.0``."""
    return "?" if bits is None else f"{bits // 8}.{bits % 8}"


def _distance(bits: int) -> str:
    if bits % 8:
        return f"{bits:+d} bit{'' if abs(bits) == 1 else 's'}"
    return f"{bits // 8:+d} byte{'' if abs(bits) == 8 else 's'}"


def _root(path: str) -> str:
    """Name of the member on the first level: ``motor`` of ``motor.speed`` and of ``motor[].speed``."""
    return path_steps(path)[0].removesuffix("[]") if path else ""


def _size(bits: int) -> str:
    return f"{bits // 8} B" if bits % 8 == 0 else f"{bits} bit"


def _shown(member: MemberState) -> str:
    start = f" := {member.start}" if member.start else ""
    at = "" if member.offset is None else f" at {offset_text(member.offset)}"
    return f"{member.path} : {member.type}{start}{at}"


def _default(member: MemberState) -> str:
    kind = member.type.partition("[")[0].upper()
    if kind in {"REAL", "LREAL"}:
        return "0.0"
    return {"BOOL": "FALSE", "STRING": "''", "WSTRING": "''", "ARRAY": "(default)"}.get(kind, "0")


def _stem(type_: str) -> str:
    """A type without its lengths and bounds."""
    head, bracket, rest = type_.upper().partition("[")
    return f"{head}[{_stem(rest.partition(']')[2])}" if bracket else head
