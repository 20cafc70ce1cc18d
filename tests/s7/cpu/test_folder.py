"""Programs of folders: what is kept in memory, and what does not depend on it."""

from dataclasses import replace

import pytest

from plcgen.project.opening import open_spec
from plcgen.s7.cpu.sources import FolderParts, read_parts
from tests.projects import SPECS, generated_example

MEGABYTE = 1 << 20


@pytest.mark.parametrize(("sizes", "large"), [((10,), False), ((MEGABYTE,), False), ((MEGABYTE, 1), True)])
def test_trees_are_kept_up_to_a_megabyte_of_sources(sizes, large):
    """The characters of all sources together count; a file that could not be read has none."""
    sources = (*((f"{n}.scl", "x" * size) for n, size in enumerate(sizes)), "missing.scl")
    assert FolderParts(sources, {}, {}, {}).large is large


@pytest.mark.parametrize("name", ["s7-1500_s120_save", "s7-300_mm440_dp"])
def test_blocks_that_are_parsed_again_are_the_same(name):
    """Code of Python, counters and code for interrupts, with trees that were kept and with some that were not.

    All sources are one file: a block in the middle of it is parsed again at its place.
    """
    (spec,) = (path for path in SPECS if path.stem == name)
    dialect = open_spec(spec).sound().target.dialect
    parts = read_parts(generated_example(name), dialect)
    parts = replace(parts, sources=(("all.scl", "\n".join(text for _, text in parts.sources)),))
    kept, again = (parts.load(dialect, coverage=True, litter=True, lean=lean) for lean in (False, True))
    assert kept.probes == again.probes
    for one, other in zip((*kept.compiled, *kept.preemptive()), (*again.compiled, *again.preemptive()), strict=True):
        assert (one.code, one.lines, one.calls) == (other.code, other.lines, other.calls)
