"""What has changed between two specs, in words: a sentence for each job, its drives folded."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from difflib import SequenceMatcher

from plcgen.s7.compare.model import BlockState, Change, JobItem, JobState, MemberState, Sentence, Snapshot
from plcgen.s7.compare.policy import Level
from plcgen.s7.tables.tables import member_address

MOST_ITEMS = 6
"""So many changes of parameters of one job are told; the telegrams below have them all."""
_MOVED = 2
"""So many addresses of one job are named."""


def sentences(old: Snapshot, new: Snapshot, changes: Sequence[Change]) -> tuple[Sentence, ...]:
    """Sentences in the order of the new spec, jobs that are gone last; none unless both sides are specs."""
    if old.jobs is None or new.jobs is None:
        return ()
    levels: dict[str, Level] = {}
    for change in changes:
        worst = levels.get(change.subject, change.level)
        levels[change.subject] = min(worst, change.level, key=lambda level: level.rank)
    moves = [change.level for change in changes if change.kind == "member-moved"]
    moved = min(moves, key=lambda level: level.rank, default=Level.BREAKING)
    teller = _Teller(old, new, levels, moved)
    return tuple(_merged(teller.told()))


def _merged(found: Iterator[Sentence]) -> Iterator[Sentence]:
    """Drives of which the same is true together."""
    alike: dict[tuple[str, str], list[Sentence]] = {}
    for one in found:
        alike.setdefault((one.job, one.text), []).append(one)
    for same in alike.values():
        level = min((one.level for one in same), key=lambda level: level.rank)
        partners = tuple(partner for one in same for partner in one.partners)
        yield Sentence(same[0].job, level, same[0].text, partners, same[0].span)


class _Teller:
    """Tells of one pair of states."""

    def __init__(self, old: Snapshot, new: Snapshot, levels: dict[str, Level], moves: Level) -> None:
        self.old, self.new, self.levels, self.moves = old, new, levels, moves
        self.before, self.after = (
            {block.name: block for block in side.blocks if block.kind == "DB"} for side in (old, new)
        )

    def told(self) -> Iterator[Sentence]:
        """Of every job that is new, gone or different, or whose signals and values lie elsewhere."""
        before, after = self.old.jobs or {}, self.new.jobs or {}
        moved = self.addresses(before, after)
        for key, job in {**after, **before}.items():
            old, new = before.get(key), after.get(key)
            name = job.group or key
            if old is None or new is None:
                word = "new" if old is None else "gone"
                text = f"{word}: {_does(job.items)}" if job.items else word
                yield Sentence(name, self.level(key), text, (job.drive,), job.span)
                continue
            parts = [*_parts(old, new), *([moved[name]] if name in moved else [])]
            if not parts and f"job {key}" in self.levels:
                parts = ["its telegrams have changed"]
            if parts:
                levels = [self.level(key), *([self.moves] if name in moved else [])]
                level = min(levels, key=lambda level: level.rank)
                yield Sentence(name, level, "; ".join(parts), (new.drive,), new.span)

    def level(self, key: str) -> Level:
        """The class of what is different about a job itself."""
        return self.levels.get(f"job {key}", self.moves)

    def addresses(self, before: dict[str, JobState], after: dict[str, JobState]) -> dict[str, str]:
        """By group: which addresses of its signals and values are others, where a data block has any."""
        moves: dict[str, list[str]] = {}
        for key, job in after.items():
            old = before.get(key)
            if old is None or old.place != job.place or not job.place[0]:
                continue
            was, now = (_places(side.get(job.place[0]), job.place[1]) for side in (self.before, self.after))
            moves.setdefault(job.group or key, []).extend(
                f"{job.place[1]}.{name} now at {job.place[0]}.{now[name]} (was {was[name]})"
                for name in sorted(now, key=lambda name: now[name].startswith("DBX"))
                if name in was and was[name] != now[name]
            )
        found = {}
        for group, told in moves.items():
            more = f" and {len(told) - _MOVED} more addresses" if len(told) > _MOVED else ""
            if told:
                found[group] = f"{', '.join(told[:_MOVED])}{more}: a panel with absolute addresses reads other bytes"
        return found


def _places(block: BlockState | None, member: str) -> dict[str, str]:
    """Address in the block of every leaf of a structure, by its path in there."""
    if block is None or block.optimized:
        return {}
    found: dict[str, str] = {}

    def walk(members: Sequence[MemberState], above: str) -> None:
        for one in members:
            path = f"{above}{one.name}"
            if one.inner:
                walk(one.inner, f"{path}.")
            elif one.offset is not None and one.bits:
                bit = one.offset % 8 if one.bits == 1 else None
                found[path] = member_address(None, one.offset // 8, bit, one.bits)

    walk(next((one.inner for one in block.members if one.name == member), ()), "")
    return found


def _parts(old: JobState, new: JobState) -> Iterator[str]:
    """What is different about one job."""
    told = list(_items(old.items, new.items)) if old.block and new.block else []
    yield from told[:MOST_ITEMS]
    if len(told) > MOST_ITEMS:
        yield f"{len(told) - MOST_ITEMS} more parameters"
    if old.drive != new.drive:
        yield f"drive {old.drive} -> {new.drive}"
    for before, after in ((dict(old.timing), dict(new.timing)), (dict(old.trigger), dict(new.trigger))):
        for name in sorted(before.keys() | after.keys()):
            was, now = before.get(name, "(symbolic)"), after.get(name, "(symbolic)")
            if was != now:
                yield f"{name} {was} -> {now}"


def _items(old: Sequence[JobItem], new: Sequence[JobItem]) -> Iterator[str]:
    """Parameters that are added, removed, written with other values or read instead."""
    values = {(item.label, item.does): item.value for item in old}
    for item in new:
        was = values.get((item.label, item.does))
        if was is not None and was != item.value:
            yield f"{item.label} {was} -> {item.value}"
    before, after = ([(item.label, item.does) for item in side] for side in (old, new))
    for tag, one, two, three, four in SequenceMatcher(None, before, after, autojunk=False).get_opcodes():
        if tag == "equal":
            continue
        gone = [label for label, _ in before[one:two] if (label, _) not in after]
        come = new[three:four]
        if gone:
            yield f"{', '.join(gone)} removed"
        fresh = [item for item in come if (item.label, item.does) not in values]
        if fresh:
            where = f"after {new[three - 1].label}" if three else "as the first"
            shown = ", ".join(f"{item.label} = {item.value}" if item.value else item.label for item in fresh)
            yield f"{shown} added {where}"
        again = [item.label for item in come if (item.label, item.does) in values]
        if again:
            yield f"{', '.join(again)} now {f'after {new[three - 1].label}' if three else 'the first'}"


def _does(items: Sequence[JobItem]) -> str:
    """``reads r21, r27; writes P1120 = 5.0``."""
    found: dict[str, list[str]] = {}
    for item in items:
        found.setdefault(item.does, []).append(f"{item.label} = {item.value}" if item.value else item.label)
    shown = {
        does: [*labels[:MOST_ITEMS], *([".."] if len(labels) > MOST_ITEMS else [])] for does, labels in found.items()
    }
    return "; ".join(f"{does} {', '.join(labels)}" for does, labels in shown.items())
