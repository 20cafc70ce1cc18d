"""Steps of a sequence -> uses of parameters, with what they wait for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from math import inf

from plcgen.base.diagnostics import Diagnostic, Report, Severity
from plcgen.ds47.device import counts, limit_text
from plcgen.ds47.kind import StepItem, Wait, WriteItem
from plcgen.ds47.plan.access import Part, Use
from plcgen.ds47.plan.uses import UseResolver
from plcgen.ds47.wire.formats import FormatKind, integer_range
from plcgen.project.spec import LoadedSpec, SpecPath
from plcgen.s7.types.names import shorten


def resolved_steps(
    steps: Sequence[StepItem], path: SpecPath, loaded: LoadedSpec, resolver: UseResolver
) -> tuple[Use, ...]:
    """The uses of a sequence that stands at ``path``; what is wrong is reported and left out."""
    found: list[Use] = []
    names: set[str] = set()
    for position, one in enumerate(steps, 1):
        place = (*path, *one.place)
        write = isinstance(one.item, WriteItem)
        use = resolver.resolve(one.item, position, place, write=write, free=not write and one.awaited is None)
        if use is not None and one.awaited is not None:
            use = _waiting(use, one, one.awaited, place, loaded, resolver)
        if use is None:
            continue
        if use.member.lower() in names and one.item.as_ is None:
            use = replace(use, member=shorten(f"{use.member}Step{one.step}", resolver.longest_name))
        names.add(use.member.lower())
        found.append(replace(use, step=one.step))
    return tuple(found) if len(found) == len(steps) else ()


def _waiting(
    use: Use, one: StepItem, awaited: Wait, place: SpecPath, loaded: LoadedSpec, resolver: UseResolver
) -> Use | None:
    """A use that waits, with the value in its ``data``; None after PG251 or what is wrong with the value."""
    why = _why_not(use, awaited, one.wanted, loaded)
    if why:
        resolver.problem("PG251", f"{use.label} cannot be waited for: {why[0]}", (*place, "parameter"), why[1])
        return None
    name = one.item.as_ or f"{use.member}{'' if awaited.bit is None else f'Bit{awaited.bit}'}Step{one.step}"
    use = replace(use, role=awaited, member=shorten(name, resolver.longest_name))
    _limits(use, awaited, one.wanted, place, resolver)
    if awaited.bit is not None:
        return replace(use, data=(int(one.wanted) << awaited.bit).to_bytes(use.format.size))
    unlimited = replace(use.parameter, minimum=None, maximum=None)
    data = resolver.pack(one.wanted, unlimited, use.format, 1, (*place, "value"))
    return None if data is None else replace(use, data=data)


_NO_BITS = frozenset({FormatKind.FLOAT, FormatKind.BOOLEAN, FormatKind.OPAQUE})


def _why_not(use: Use, awaited: Wait, wanted: object, loaded: LoadedSpec) -> tuple[str, str] | None:
    """Why a value cannot be compared, and what to do about it."""
    fmt = use.format
    if fmt.is_string or use.count > 1:
        return "it has several values", "wait for one index of it"
    if awaited.bit is not None:
        if fmt.kind in _NO_BITS:
            return f"a {use.type_text} has no bits", "compare its value"
        if awaited.bit >= 8 * fmt.size:
            return f"a {use.type_text} has the bits 0 to {8 * fmt.size - 1}, not {awaited.bit}", ""
        if awaited.operator not in {"=", "<>"} or wanted not in {0, 1}:
            return "a bit is 0 or 1", f"write {use.label}.{awaited.bit}: 1"
    elif awaited.operator in {"<", ">"} and wanted == (integer_range(fmt) or ("", ""))[awaited.operator == ">"]:
        return f"a {use.type_text} is never {awaited.operator} {wanted}", ""
    elif fmt.kind in {FormatKind.BOOLEAN, FormatKind.OPAQUE} and awaited.operator not in {"=", "<>"}:
        return f"a {use.type_text} is not greater or less than another", "compare with = or <>"
    elif fmt.kind is FormatKind.FLOAT and fmt.size == 8 and loaded.spec.plc.family in {"s7-300", "s7-400"}:
        return f"this CPU has no type for {use.type_text}", "wait for another parameter"
    return None


_OPPOSITE = {"=": "<>", "<>": "=", "<": ">=", ">=": "<", ">": "<=", "<=": ">"}


def _limits(use: Use, awaited: Wait, wanted: object, place: SpecPath, resolver: UseResolver) -> None:
    """PG251 if the limits of the parameter decide a condition: it is waited for in vain, or not at all."""
    parameter = use.parameter
    value = parameter.values.get(wanted) if isinstance(wanted, str) else wanted
    if not isinstance(value, bool | int | float):
        return
    if parameter.scale and not isinstance(wanted, str):
        value = counts(value, parameter.scale)
    low = -inf if parameter.minimum is None else parameter.minimum
    high = inf if parameter.maximum is None else parameter.maximum
    if low > high:
        return  # no value can keep them: told where they stand
    operator = awaited.operator
    if awaited.bit is not None:  # the highest bits are 0 in every value that is not negative
        if low < 0 or high >= 1 << awaited.bit:
            return
        low = high = 0
    shown = f"{use.label}{'' if awaited.bit is None else f'.{awaited.bit}'} {awaited.operator} {wanted}"
    ends = (None if end is None else end * (parameter.scale or 1.0) for end in (parameter.minimum, parameter.maximum))
    limits = f"its limits are {'..'.join(map(limit_text, ends))}"
    where = (*place, "value")
    if _never(operator, value, low, high):
        severity = Severity.WARNING if parameter.access == "r" else Severity.ERROR
        message = f"{shown} is never true: {limits}"
        resolver.problem("PG251", message, where, "wait for a value that the parameter can have", severity)
    elif _never(_OPPOSITE[operator], value, low, high):
        message = f"{shown} is always true: {limits}"
        resolver.problem("PG251", message, where, "the step does not wait: leave it out", Severity.WARNING)


def _never(operator: str, value: float, low: float, high: float) -> bool:
    """Whether no number from ``low`` to ``high`` fulfils a comparison."""
    return {
        "=": value < low or value > high,
        "<>": low == high == value,
        "<": low >= value,
        "<=": low > value,
        ">": high <= value,
        ">=": high < value,
    }[operator]


def divided(packed: Sequence[tuple[Part, ...]], loaded: LoadedSpec, report: Report) -> bool:
    """PG251: a step that waits does not fit one telegram, so that all of it would not be true at the same time."""
    for first, second in pairwise(parts[0].use for parts in packed):
        if first.step == second.step and first.as_(Wait):
            message = f"the conditions of step {first.step} do not fit one telegram"
            help_ = "split it into several steps: each waits for its own conditions"
            if second.as_(Wait) is None:
                message = f"what step {first.step} reads while it waits does not fit one telegram"
                help_ = "read it in the next step"
            report.add(Diagnostic("PG251", message, loaded.span(second.path), help=help_))
            return True
    return False
