"""Calls of WRREC and RDREC, whatever the instance is called.

A call is known by its parameters: RECORD and INDEX belong to no other block of the standard library; MLEN or VALID
make it RDREC.
"""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.ds47.audit.model import FoundCall
from plcgen.s7.read.blocks import Sources
from plcgen.s7.read.calls import find_calls

_RECORD_CALL = frozenset({"RECORD", "INDEX"})
_READS = frozenset({"MLEN", "VALID"})


def record_calls(sources: Sources) -> Iterator[FoundCall]:
    """Every call in the sources, in the order of the files."""
    for call in find_calls(sources, _RECORD_CALL, "RECORD"):
        writes = not _READS & call.arguments.keys()
        yield FoundCall(writes, call.block, call.span, call.arguments, call.area)
