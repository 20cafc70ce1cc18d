"""What a job of the spec accesses: its kind, and its uses of parameters in the order in which they travel."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field, replace

from plcgen.base.diagnostics import Diagnostic, Report
from plcgen.ds47.device import Device
from plcgen.ds47.kind import Items, JobKind, Messages, ReadItem, WriteItem
from plcgen.ds47.plan.access import Column, Compare, Read, Recount, Role, Use, Write
from plcgen.ds47.plan.bits import BitResolver, has_bits, in_front, shown_bit
from plcgen.ds47.plan.readback import read_back, transaction
from plcgen.ds47.plan.recipes import Recipes
from plcgen.ds47.plan.steps import resolved_steps
from plcgen.ds47.plan.untyped import named_later, with_forms
from plcgen.ds47.plan.uses import UseResolver
from plcgen.ds47.references import Reference, number_of, parse_reference, split_bit
from plcgen.ds47.registry import kinds
from plcgen.ds47.schema import DriveSections, ErrorSettings, JobEntry
from plcgen.project.spec import LoadedSpec, SpecPath
from plcgen.s7.types.names import camel_case

MAIN_VALUES = "main_values"
"""What a job reads that says so instead of naming parameters: those that the profile of the device states."""
DRIVES = frozenset({"", "drive", "servo", "vector"})
"""Types of drive objects that have them."""
_LARGEST = 4
"""Bytes of a value that a list of deviations has room for."""


_OF_DC = 50303
"""The parameter of the examples, which converters for direct current have; others have p1120."""


def job_kind(job: JobEntry, key: str, device: Device, loaded: LoadedSpec, report: Report) -> JobKind | None:
    """The one kind that a job says it is; None after a diagnostic. What is read back may be saved in the same job."""
    given = [kind for kind in kinds() if getattr(job, kind.key) is not None]
    if len(given) == 1:
        return given[0]
    saved = [kind for kind in given if kind.writes and kind.poll is None]
    if len(given) == 2 and len(saved) == 1 and kind_behind(job, saved[0]) is not None:
        if job.verify is not None:
            return saved[0]
        message = f'job "{key}" saves what it has not read back'
        help_ = "add verify: readback, or split it into two jobs"
        report.add(Diagnostic("PG218", message, loaded.key_span(("jobs", key)), help=help_))
        return None
    names = " or ".join(kind.key for kind in given)
    what = f"either {names}, not both" if given else "what to read, what to write or what to save"
    empty = [kind for kind in kinds() if kind.key in loaded.root.find(("jobs", key)).pairs]
    known = device.find(_OF_DC) is not None
    examples = " or ".join(kind.example for kind in empty or kinds())
    help_ = f"add {examples if known else examples.replace(f'P{_OF_DC}', 'P1120')}"
    if given:
        help_ = "split it into two jobs"
    elif empty:
        what = f"a value of {empty[0].key}"
    report.add(Diagnostic("PG218", f'job "{key}" needs {what}', loaded.key_span(("jobs", key)), help=help_))
    return None


def kind_behind(job: JobEntry, kind: JobKind) -> JobKind | None:
    """The kind of what a job does behind its own."""
    behind = (one for one in kinds() if one.follows and one is not kind and getattr(job, one.key) is not None)
    return next(behind, None)


@dataclass(slots=True)
class _Expanded:
    """Items with their places, and the bits that are shown of them, by number of the item."""

    items: list[ReadItem | WriteItem] = field(default_factory=list)
    places: list[SpecPath] = field(default_factory=list)
    bits: dict[int, list[tuple[ReadItem, int, SpecPath]]] = field(default_factory=dict)
    _words: dict[Reference, int] = field(default_factory=dict)
    """Words of which bits are shown."""

    def add(self, item: ReadItem | WriteItem, place: SpecPath) -> None:
        """A parameter; it may be a word of which a bit has come already."""
        at = self._words.pop(reference, None) if (reference := parse_reference(item.parameter)) is not None else None
        if at is not None:
            self.items[at], self.places[at] = item, place
            return
        self.items.append(item)
        self.places.append(place)

    def add_bit(self, item: ReadItem, word: str, number: int, place: SpecPath) -> None:
        """A bit, with its word if that is not there yet."""
        asked = parse_reference(word)
        same = (at for at, one in enumerate(self.items) if parse_reference(one.parameter) == asked)
        at = next(same, len(self.items))
        if at == len(self.items):
            self.items.append(ReadItem(parameter=word, type=item.type))
            self.places.append(place)
            if asked is not None:
                self._words[asked] = at
        self.bits.setdefault(at, []).append((item, number, place))


@dataclass(slots=True)
class Accesses:
    """What one job accesses on a drive whose parameters ``resolver`` knows."""

    job: JobEntry
    path: SpecPath
    loaded: LoadedSpec
    recipes: Recipes
    resolver: UseResolver
    report: Report

    def uses(self, kind: JobKind) -> tuple[Use, ...]:
        """All uses of the job, with those of what it does behind its own; none after a diagnostic."""
        first = self._own(kind, 0)
        then = kind_behind(self.job, kind)
        uses = first + self._own(then, len(first)) if then is not None and first else first
        return tuple(with_forms(use, self.resolver.longest_name) for use in uses)

    def _own(self, kind: JobKind, before: int) -> tuple[Use, ...]:
        """The uses of one kind, with ``before`` others in front of them."""
        place: SpecPath | None = (*self.path, kind.key)
        given = getattr(self.job, kind.key)
        if kind.recorded:
            place = self.recipes.place(given, (*self.path, kind.key))
        if place is None:
            return ()
        items = self.loaded.sections(DriveSections).items(self.job, kind)
        if kind.on is not None:
            items = kind.on(items, self._has)
        if not items:
            message = f'job "{self.path[-1]}" names no parameter'
            self.report.add(Diagnostic("PG218", message, self.loaded.span((*self.path, kind.key))))
        if items and not self._fits(kind, items[0], place):
            return ()
        if kind.fixed and not self._all_known(kind, items, place):
            return ()
        if kind.serves:
            return (named_later(items[0], place),)
        if kind.steps is not None:
            return resolved_steps(tuple(kind.steps(given)), place, self.loaded, self.resolver)
        if kind.bits and has_bits(items):
            return self._with_bits(kind, items, place)
        expanded = self._expanded(kind, items, place)
        items = tuple(expanded.items)
        uses = self._resolved(kind, items, expanded.places, before, expanded.bits)
        if len(uses) == len(items):
            return self._complete(kind, self._shown(uses, expanded), items)
        return uses if kind.messages is None else ()

    def _expanded(self, kind: JobKind, items: Items, place: SpecPath) -> _Expanded:
        """The items with the main values of the device in place of their name, and words in place of bits."""
        whole = kind.fixed or kind.poll is not None
        found = _Expanded()
        for number, item in enumerate(items):
            where = place if whole else (*place, number)
            bit = split_bit(item.parameter) if kind.key == "read" and isinstance(item, ReadItem) else None
            if bit is not None and isinstance(item, ReadItem):
                found.add_bit(item, *bit, where)
            elif item.parameter != MAIN_VALUES or kind.key != "read":
                found.add(item, where)
            else:
                for one in self._main_values(item, where):
                    found.add(one, where)
        return found

    def _shown(self, uses: tuple[Use, ...], expanded: _Expanded) -> tuple[Use, ...]:
        """The uses with the bits that are shown of them."""
        found = []
        for at, use in enumerate(uses):
            asked = expanded.bits.get(at, ())
            bits = [shown_bit(use, number, item, path, self.resolver) for item, number, path in asked]
            known = tuple(bit for bit in bits if bit is not None)
            found.append(replace(use, role=Read(shown=known)) if asked else use)
        return tuple(found)

    def _main_values(self, item: ReadItem | WriteItem, place: SpecPath) -> Iterator[ReadItem]:
        """What stands behind ``main_values``; nothing after a diagnostic."""
        device, type_ = self.resolver.device, self.resolver.object_type
        where = self.loaded.span((*place, "parameter"))
        if item.as_ is not None or item.type is not None:
            help_ = "leave as and type out, or name the parameters one by one"
            self.report.add(Diagnostic("PG203", f"{MAIN_VALUES} stands for several parameters", where, help=help_))
        elif type_ not in DRIVES:
            message = f"{MAIN_VALUES} are those of a drive, and this drive object is {type_}"
            self.report.add(Diagnostic("PG262", message, where, help="name the parameters: read: [r2, r26]"))
        elif not device.main_values:
            message = f"{MAIN_VALUES} of {device.key}: nobody has looked up what they are"
            help_ = "name the parameters: read: [r21, ..]; or state main_values in a profile of your own"
            self.report.add(Diagnostic("PG248", message, where, help=help_))
        else:
            for name, parameter in device.main_values.items():
                given = {"parameter": parameter, "as": camel_case(name), "comment": item.comment}
                yield ReadItem.model_validate(given)

    def _resolved(
        self, kind: JobKind, items: Items, places: Sequence[SpecPath], before: int, bits: Collection[int]
    ) -> tuple[Use, ...]:
        """The items that the drive knows; a word of which ``bits`` are shown needs a type."""
        found = []
        for number, (item, where) in enumerate(zip(items, places, strict=True)):
            write = kind.writes and isinstance(item, WriteItem)
            free = kind.key == "read" and number not in bits
            found.append(self.resolver.resolve(item, before + number + 1, where, write=write, free=free))
        uses = tuple(use for use in found if use is not None)
        if kind.recorded:
            recorded = self.recipes.recorded(uses, self.resolver)
            uses = tuple(replace(use, role=_of_record(kind, use)) for use in recorded)
        if kind.compares:
            uses = tuple(use for use in uses if self._comparable(use))
        return uses

    def _with_bits(self, kind: JobKind, items: Items, place: SpecPath) -> tuple[Use, ...]:
        """Items of which some are bits of words, which are read in front of the write; none after a diagnostic."""
        found = BitResolver(self.resolver)
        found.add(items, place)
        if not found.complete:
            return ()
        uses, words = tuple(found.uses), tuple(found.items)
        if self._restores(kind) is None:  # else all old values are read
            uses, words = in_front(uses, words, self.resolver)
        return self._complete(kind, uses, words)

    def _complete(self, kind: JobKind, uses: tuple[Use, ...], items: Items) -> tuple[Use, ...]:
        """What belongs to the uses of all items: read back, restored, polled, divided into columns."""
        settings = getattr(self.job, kind.key)
        if kind.poll is not None:
            return (uses[0], replace(uses[1], role=kind.poll(settings)), *uses[2:])
        if self.job.verify is not None:
            restores = self._restores(kind)
            if restores is not None:
                return transaction(uses, items, restores, self.path, self.resolver)
            return (*uses, *read_back(uses, items, self.resolver))
        return uses if kind.messages is None else tuple(_columns(uses, kind.messages(settings)))

    def _restores(self, kind: JobKind) -> ErrorSettings | None:
        """How old values are written back; None if they are not."""
        can = self.job.verify is not None and kind.read_back
        return self.job.on_error if can else None

    def _comparable(self, use: Use) -> bool:
        """Whether a value fits the list of deviations; PG249 if not."""
        if not use.format.is_string and use.format.size <= _LARGEST:
            return True
        message = f"{use.label} is {use.type_text}: the list of deviations has numbers of 1, 2 or 4 bytes"
        place = self.loaded.span((*use.path, "parameter"))
        self.report.add(Diagnostic("PG249", message, place, help="read it in another job"))
        return False

    def _has(self, name: str) -> bool:
        """Whether the drive object is known to have a parameter."""
        return self.resolver.confirmed(number_of(name) or 0) is not None

    def _fits(self, kind: JobKind, item: ReadItem | WriteItem, path: SpecPath) -> bool:
        """Whether the parameter of a kind does what the kind is for; PG243 if not: no other is taken in its place."""
        if kind.unfit is None:
            return True
        pnu, resolver = number_of(item.parameter) or 0, self.resolver
        known = resolver.known.get(pnu) or resolver.confirmed(pnu)
        found = kind.unfit(item, known, resolver.known, resolver.device.key)
        if found is None:
            return True
        if found.key or not resolver.lacks([item.parameter], path, found.instead):
            help_ = "; ".join(filter(None, (found.instead, found.help)))
            place = self.loaded.span((*path, found.key) if found.key else path)
            self.report.add(Diagnostic("PG243", found.message, place, help=help_))
        return False

    def _all_known(self, kind: JobKind, items: Items, path: SpecPath) -> bool:
        """Whether every parameter that the job does not name itself is known, with a type that is not from memory.

        PG262 for those that the drive object is known not to have, PG248 for those that nobody has looked up: a job
        that reads something else than it says is worse than none.
        """
        wanted = dict.fromkeys(item.parameter.partition("[")[0] for item in items)
        missing = [name for name in wanted if not self._has(name)]
        if self.resolver.lacks(missing, path):
            return False
        if not missing:
            return True
        names, them = ", ".join(missing), "it" if len(missing) == 1 else "them"
        message = f"{names} of {self.resolver.device.key}: nobody has looked up whether the device has {them}"
        definitions = ", ".join(f"{name}: {{type: {kind.types.get(name, '..')}}}" for name in missing)
        help_ = f"look {them} up in the list manual and define {them} in the drive: parameters: {{{definitions}}}"
        if kind.messages is not None:
            help_ += "; or leave its column out"
        self.report.add(Diagnostic("PG248", message, self.loaded.span(path), help=help_))
        return False


def _of_record(kind: JobKind, use: Use) -> Role:
    """The role of a use whose value is a member of a record: written, compared, or read into it."""
    if isinstance(use.role, Write | Compare) and (kind.writes or kind.compares):
        return replace(use.role, recorded=True)
    return Read(recorded=True)


def _columns(uses: tuple[Use, ...], settings: Messages) -> Iterator[Use]:
    """The accesses to a buffer of messages: the counter if there is one, columns of groups, what is read again."""
    ahead = 1 if uses[0].first is None else 0  # a counter has no index
    for number, use in enumerate(uses, -ahead):
        group, column = divmod(number, len(settings.columns))
        if number < 0:
            yield use
        else:
            more = group < len(settings.latest_last)
            yield replace(use, role=Column(settings.columns[column], group) if more else Recount())
