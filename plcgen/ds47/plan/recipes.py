"""Recipes: a type and a data block for each, made with the first job that uses it."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from plcgen.base.diagnostics import Diagnostic, Report, Severity
from plcgen.base.diagnostics.suggest import Vocabulary, did_you_mean
from plcgen.ds47.kind import ReadItem, WriteItem
from plcgen.ds47.plan.access import Use
from plcgen.ds47.plan.nouns import PlannedRecipe
from plcgen.ds47.plan.types import element_type
from plcgen.ds47.plan.uses import UseResolver
from plcgen.ds47.recipes import RecipeEntry
from plcgen.ds47.references import parse_reference
from plcgen.ds47.registry import kind_called
from plcgen.ds47.schema import DriveSections
from plcgen.project.numbering import Numbering
from plcgen.project.spec import LoadedSpec, SpecPath
from plcgen.s7.types.names import pascal_case


class Recipes:
    """Those of a spec, found in the order of the jobs that use them."""

    def __init__(self, loaded: LoadedSpec, numbering: Numbering, report: Report) -> None:
        self._loaded, self._numbering, self._report = loaded, numbering, report
        self._entries = loaded.sections(DriveSections).recipes
        self._words = Vocabulary(self._entries)
        self._named: set[str] = set()
        self.found: dict[str, PlannedRecipe] = {}

    def place(self, key: str, path: SpecPath) -> SpecPath | None:
        """Where the parameters of a recipe stand; None after PG256 if there is none that a job at ``path`` names."""
        if key in self._entries:
            self._named.add(key)
            return ("recipes", key, "parameters")
        help_ = did_you_mean(key, self._words) or "add it to the section recipes"
        self._report.add(Diagnostic("PG256", f'there is no recipe "{key}"', self._loaded.span(path), help=help_))
        return None

    def recorded(self, uses: Sequence[Use], resolver: UseResolver) -> Iterator[Use]:
        """The uses as members of a record; PG255 for what is no number."""
        where = self._numbering.where
        for use in uses:
            if use.format.is_string or element_type(use.format, where) is None:
                message = f"{use.label} is {use.type_text}: a recipe takes only numbers of a type that this CPU has"
                resolver.problem("PG255", message, (*use.path, "parameter"), "read or write it in a separate job")
            else:
                yield use

    def of(self, key: str, job: str, uses: tuple[Use, ...], resolver: UseResolver) -> PlannedRecipe:
        """The recipe of a job; PG255 if another job has made something else of it."""
        entry, made = self._entries[key], self.found.get(key)
        if made is None:
            name = pascal_case(f"recipe_{key}")
            type_ = self._numbering.block("UDT", f"type{name}", ("recipes", key))
            db = replace(self._numbering.block("DB", name, ("recipes", key)), retain=entry.retain)
            values = tuple(self._values(key, entry, uses, resolver))
            made = self.found[key] = PlannedRecipe(key, type_, db, uses, entry.names, values, entry.comment or {})
        elif _meanings(made.uses) != _meanings(uses):
            message = f'the parameters of recipe "{key}" are not the same for "{job}" as for the job that used it first'
            help_ = "make a recipe for each kind of drive"
            self._report.add(Diagnostic("PG255", message, self._loaded.key_span(("jobs", job)), help=help_))
        return made

    def _values(
        self, key: str, entry: RecipeEntry, uses: tuple[Use, ...], resolver: UseResolver
    ) -> Iterator[Mapping[str, bytes]]:
        """Start values of each record, as wire bytes by member."""
        names = {item.parameter: use for item, use in zip(entry.parameters, uses, strict=False)}
        names |= {use.member: use for use in uses}
        start = {use.member: use.data for use in uses}
        records = entry.records.items() if isinstance(entry.records, dict) else [("", {})] * entry.records
        for title, record in records:
            found = dict(start)
            for name, value in record.items():
                use = names.get(name)
                path = ("recipes", key, "records", title, name)
                if use is None:
                    self._report_stranger(key, name, names, path)
                    continue
                found[use.member] = resolver.pack(value, use.parameter, use.format, use.count, path) or use.data
            yield found

    def _report_stranger(self, key: str, name: str, names: Iterable[str], path: SpecPath) -> None:
        """PG256 at a value of a record; no number that looks like it is offered, it is another parameter."""
        hint = "" if _numbered(name) else did_you_mean(name, (one for one in names if not _numbered(one)))
        help_ = hint or f"parameters of the recipe: {', '.join(names)}"
        message = f'recipe "{key}" has no parameter "{name}"'
        self._report.add(Diagnostic("PG256", message, self._loaded.key_span(path), help=help_))

    def unused(self, resolvers: Collection[UseResolver]) -> None:
        """PG256: a recipe that no job uses has no types, so that nothing can be made of it.

        A parameter of it that none of the drives knows is reported as that of a job would be.
        """
        told, first, known = self._report.has_errors, list(resolvers)[:1], _known(resolvers)
        for key, entry in self._entries.items():
            if key in self._named:
                continue
            for position, item in enumerate(kind_called("write_recipe").items(entry), 1):
                for resolver in first if _strange(item, known) else ():
                    resolver.resolve(item, position, ("recipes", key, "parameters", position - 1), write=True)
            if not told:
                message = f'no job uses recipe "{key}": nothing is generated from it'
                help_ = f"add a job: {{drive: .., write_recipe: {key}}}"
                place = self._loaded.key_span(("recipes", key))
                self._report.add(Diagnostic("PG256", message, place, Severity.WARNING, help=help_))


def _numbered(name: str) -> bool:
    """Whether a parameter is written with its number."""
    reference = parse_reference(name)
    return reference is not None and reference.pnu is not None


def _known(resolvers: Collection[UseResolver]) -> set[int | str]:
    """Numbers and names of all parameters that a drive knows."""
    devices = {one.device.key: one.device.parameters for one in resolvers}
    known = [parameter for one in (*devices.values(), *(one.own for one in resolvers)) for parameter in one.values()]
    return {one.pnu for one in known} | {one.name for one in known if one.name}


def _strange(item: ReadItem | WriteItem, known: set[int | str]) -> bool:
    """Whether no drive knows a parameter."""
    reference = parse_reference(item.parameter)
    return reference is None or (reference.name if reference.pnu is None else reference.pnu) not in known


def _meanings(uses: Sequence[Use]) -> list[tuple[object, ...]]:
    """What decides about a record and its limits."""
    return [
        (use.member, use.parameter.pnu, use.format, use.first, use.count, use.parameter.minimum, use.parameter.maximum)
        for use in uses
    ]
