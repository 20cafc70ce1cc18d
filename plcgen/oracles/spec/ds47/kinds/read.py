"""``read``: every parameter is read once, in the order of the spec, and shown by its output.

A bit, ``r899.2``, is an output of its own; its word is read once, whatever the number of its bits.

``main_values`` stands for those that the profile of the device states, each shown by the output that it names.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import chain

from plcgen.oracles.spec.ds47.accesses import JobReader, SpecItem, camel
from plcgen.oracles.spec.ds47.statement import StatedAccess, StatedStep

MAIN_VALUES = "main_values"


def read_steps(job: JobReader) -> Iterator[StatedStep]:
    """One step."""
    found: dict[tuple[int, int], StatedAccess] = {}
    words: set[tuple[int, int]] = set()
    for item in chain.from_iterable(named(job, one) for one in job.items("read")):
        parameter = job.drive.catalogue.read(item.text)
        key = parameter.number, parameter.first
        if parameter.bit is None:
            shown = found[key].shown if key in words else ()
            found[key] = replace(job.reads(item, free=not shown), shown=shown)
            continue
        if key not in found:
            words.add(key)
            settings = {"type": item.settings.get("type")}
            found[key] = job.reads(replace(item, text=item.text.rpartition(".")[0], settings=settings))
        word, text = found[key], job.drive.catalogue.bit_name(parameter.number, parameter.bit)
        name = str(item.settings.get("as") or (camel(text) if text else f"{word.output}Bit{parameter.bit}"))
        found[key] = replace(word, shown=(*word.shown, (parameter.bit, name)))
    yield StatedStep("reads", tuple(found.values()))


def named(job: JobReader, item: SpecItem) -> Iterator[SpecItem]:
    """The parameters for which an item stands."""
    if item.text != MAIN_VALUES:
        yield item
        return
    for name, text in job.drive.catalogue.main_values.items():
        settings = {"as": camel(name), "comment": item.settings.get("comment")}
        yield replace(item, text=text, settings=settings)


STATEMENTS = {"read": read_steps}
