"""Members of a buffer against the fields of its telegram: order, width, offset, pads.

Where the names tell what the members are, they are aligned by their names, so that one mistake is one finding; else
by their widths. Members may be finer (a value as four bytes) or coarser (a word for two bytes) than the fields.
"""

from __future__ import annotations

from collections.abc import Sequence

from plcgen.base.diagnostics import Note, Severity, Span
from plcgen.base.diagnostics.counting import quantity
from plcgen.ds47.audit.align import align
from plcgen.ds47.audit.buffers import is_elementary
from plcgen.ds47.audit.model import Expected, Match
from plcgen.ds47.audit.names import CLASSES, class_of
from plcgen.ds47.wire.formats import FormatKind
from plcgen.s7.read.buffers import Slot

Pair = tuple[tuple[Expected, ...], tuple[Slot, ...]]
"""Fields and the members that hold them."""

_INTEGERS = frozenset({"SINT", "USINT", "INT", "UINT", "DINT", "UDINT", "LINT", "ULINT"})
_REALS = frozenset({"REAL", "LREAL"})


def check_members(match: Match, fields: Sequence[Expected], slots: Sequence[Slot]) -> list[Pair]:
    """Report what lies wrong; return which members hold which fields, in the order of the telegram."""
    check = _Check(match)
    pairs = check.by_name(fields, slots) if _named(slots) else check.by_width(fields, slots)
    for wanted, have in pairs:
        if len(wanted) == len(have) == 1:
            check.types(wanted[0], have[0])
    return pairs


def _named(slots: Sequence[Slot]) -> bool:
    """Whether most of the first members have names that say what they are."""
    classes = [class_of(slot.path) for slot in slots[:40]]
    known = {name for name in classes if name}
    return len(known) >= 4 and sum(map(bool, classes)) * 10 >= 7 * len(classes)


class _Check:
    """One buffer; ``moved`` says that a finding explains why what follows lies elsewhere."""

    def __init__(self, match: Match) -> None:
        self.match = match
        self.moved = False
        self.last: Slot | None = None

    # --- by name --------------------------------------------------------------------------------------

    def by_name(self, fields: Sequence[Expected], slots: Sequence[Slot]) -> list[Pair]:
        """Align names with roles; what has no counterpart is missing, or too much."""
        wanted = [CLASSES[field.role] for field in fields]
        have = self.swapped(fields, slots, [class_of(slot.path) for slot in slots])
        pairs: list[Pair] = []
        merged = 0
        codes = align(wanted, have)
        for step, (tag, i, j, k, n) in enumerate(codes):
            if tag == "equal":
                following = codes[step + 1] if step + 1 < len(codes) else ("", 0, 0, 0, 0)
                behind = fields[following[1] : following[2]] if following[0] == "delete" else ()
                pairs += [
                    self.pair(field, slot) for field, slot in zip(fields[i : j - 1], slots[k : n - 1], strict=True)
                ]
                merged = _sum(slots[n - 1].size, [field.size for field in (fields[j - 1], *behind)]) - 1
                pairs.append(self.merged(fields[j - 1 : j + max(merged, 0)], slots[n - 1]))
            elif tag == "delete":
                self.missing(fields[i + max(merged, 0) : j], slots[k] if k < len(slots) else None)
            elif tag == "insert":
                self.surplus(slots[k:n], at_end=i == len(fields))
            else:
                pairs += self.replaced(fields[i:j], slots[k:n])
        return pairs

    def swapped(self, fields: Sequence[Expected], slots: Sequence[Slot], classes: list[str]) -> list[str]:
        """Report two neighbours in the wrong order, and go on as if they were in the right one."""
        wanted = [CLASSES[field.role] for field in fields]
        for n in range(min(len(wanted), len(classes)) - 1):
            first, second = wanted[n : n + 2]
            if first != second and classes[n : n + 2] == [second, first]:
                here, there = slots[n], slots[n + 1]
                message = (
                    f"{here.path} and {there.path} are swapped: the telegram has the {fields[n].label} at byte "
                    f"{fields[n].offset}, the {fields[n + 1].label} at byte {fields[n + 1].offset}"
                )
                help_ = f"declare {there.path} before {here.path}"
                self.match.findings.report("PG653", message, here.span, help_)
                classes[n : n + 2] = [first, second]
        return classes

    def replaced(self, fields: Sequence[Expected], slots: Sequence[Slot]) -> list[Pair]:
        """Members whose names say something else or nothing: by their order, if their number fits."""
        needed = [field for field in fields if field.role != "pad"]
        if len(needed) == len(slots):
            fields = needed
        if len(fields) == len(slots):
            return [self.pair(field, slot) for field, slot in zip(fields, slots, strict=True)]
        return self.by_width(fields, slots)

    def missing(self, fields: Sequence[Expected], following: Slot | None) -> None:
        """Fields without a member: a pad may also be a gap that the compiler leaves."""
        for field in fields:
            place = following.span if following is not None else self.match_span()
            if field.role == "pad":
                if following is not None and not self.moved and following.offset == field.offset:
                    self.pad(field, following)
                continue
            message = f"no member for the {field.label}, byte {field.offset} of the telegram"
            self.match.findings.report("PG653", message, place, f"declare it: {_declaration(field)}")
            self.moved = True

    def surplus(self, slots: Sequence[Slot], *, at_end: bool) -> None:
        """Members that no field needs; behind the end they are a reserve."""
        if at_end:
            return
        for slot in slots:
            message = f"{slot.path} at byte {slot.offset} is not part of the telegram: everything after it is shifted"
            self.match.findings.report("PG653", message, slot.span, "remove it, or move it after the telegram")
        self.moved = True

    # --- by width -------------------------------------------------------------------------------------

    def by_width(self, fields: Sequence[Expected], slots: Sequence[Slot]) -> list[Pair]:
        """Walk along both; a member may hold several fields, a field may need several members."""
        pairs: list[Pair] = []
        i = j = 0
        while i < len(fields) and j < len(slots):
            field, slot = fields[i], slots[j]
            if field.role == "pad" and slot.offset == field.offset + 1:
                i += 1
                continue
            fewer = len(slots) - j < sum(f.role != "pad" for f in fields[i:])
            whole = _sum(slot.size, [f.size for f in fields[i:]])
            parts = _sum(field.size, [s.size for s in slots[j:]])
            if slot.size > field.size and whole and fewer:
                self.place(field, slot)
                pairs.append((tuple(fields[i : i + whole]), (slot,)))
                i, j = i + whole, j + 1
            elif slot.size < field.size and parts and len(slots) - j > len(fields) - i:
                self.place(field, slot)
                pairs.append(((field,), tuple(slots[j : j + parts])))
                i, j = i + 1, j + parts
            else:
                pairs.append(self.pair(field, slot))
                i, j = i + 1, j + 1
        self.missing([field for field in fields[i:] if field.role != "pad"], None)
        return pairs

    # --- one pair -------------------------------------------------------------------------------------

    def merged(self, fields: Sequence[Expected], slot: Slot) -> Pair:
        """One member that holds several fields, such as a word for two bytes."""
        if len(fields) == 1:
            return self.pair(fields[0], slot)
        self.place(fields[0], slot)
        return (tuple(fields), (slot,))

    def pair(self, field: Expected, slot: Slot) -> Pair:
        """One field and the member that holds it."""
        self.place(field, slot)
        if slot.bits == 1 or slot.size != field.size:
            shown = "1 bit" if slot.bits == 1 else quantity(slot.size, "byte")
            takes = quantity(field.size, "byte")
            message = f"{slot.path} takes {shown}, the {field.label} takes {takes} (byte {field.offset})"
            self.match.findings.report("PG652", message, slot.span, f"declare it as {_type(field)}")
            self.moved = True
        self.last = slot
        return ((field,), (slot,))

    def place(self, field: Expected, slot: Slot) -> None:
        """Report the first member that lies elsewhere without an earlier finding that explains it."""
        if not self.moved and slot.offset != field.offset:
            gap = slot.offset - (self.last.end if self.last is not None else 0)
            why = f": {quantity(gap, 'byte')} of gap before it" if gap > 0 else ""
            there = f"the telegram has the {field.label} at byte {field.offset}"
            message = f"{slot.path} lies at byte {slot.offset}{why}; {there}"
            help_ = (
                "words, structures and arrays start at even bytes: put the members in the order of the telegram, flat"
            )
            notes = (Note("the gap is after this member", self.last.span),) if gap > 0 and self.last is not None else ()
            if slot.offset < field.offset:
                help_ = "a member before it is missing or too short"
            self.match.findings.report("PG653", message, slot.span, help_, notes=notes)
            self.moved = True
        self.last = slot

    def pad(self, field: Expected, following: Slot) -> None:
        """A pad byte that nobody declared and no gap replaces."""
        message = f"{following.path} lies at byte {following.offset}, where the {field.label} belongs"
        help_ = "values of an odd number of bytes end with one byte 00h: declare it, Padding : Byte;"
        self.match.findings.report("PG655", message, following.span, help_)
        self.moved = True

    def types(self, field: Expected, slot: Slot) -> None:
        """A value of the right width that is read as another kind of number."""
        if field.format is None or slot.size != field.size:
            return
        real = field.format.kind is FormatKind.FLOAT
        if (real and is_elementary(slot, _INTEGERS)) or (not real and is_elementary(slot, _REALS)):
            message = f"{slot.path} reads the {field.label}, a {field.format.name}, as {slot.type.name}"  # type: ignore[union-attr]
            help_ = f"declare it as {_type(field)}"
            self.match.findings.report("PG662", message, slot.span, help_, severity=Severity.WARNING)

    def match_span(self) -> Span:
        """The buffer as a whole."""
        return self.match.buffer.span if self.match.buffer is not None else Span("")


def _sum(total: int, sizes: Sequence[int]) -> int:
    """How many of the first sizes make up the total exactly; 0 if none do."""
    for count, size in enumerate(sizes, 1):
        total -= size
        if total <= 0:
            return count if total == 0 else 0
    return 0


def _type(field: Expected) -> str:
    if field.format is not None and field.format.kind is FormatKind.FLOAT:
        return "Real" if field.size == 4 else "LReal"
    names = {1: "Byte", 2: "Word", 4: "DWord", 8: "LWord"}
    return names.get(field.size, f"Array[0..{field.size - 1}] of Byte")


def _declaration(field: Expected) -> str:
    name = {"pnu": "Para_No", "drive_object": "Axis", "count": "Num_of_Para"}.get(field.role, field.role.title())
    return f"{name} : {_type(field)};"
