"""Semantic comparison of two states of PLC blocks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from plcgen.s7.compare.model import Change
    from plcgen.s7.read.blocks import Sources


def compare_sources(old: Sources, new: Sources, policy: Sequence[str] = ()) -> list[Change]:
    """Every difference between two sets of blocks, the level of each as ``policy`` says (``KIND=LEVEL``).

    Raises DiagnosticError, PG631, for a policy that makes no sense.
    """
    from plcgen.s7.compare.blocks import compare_blocks
    from plcgen.s7.compare.policy import load_policy
    from plcgen.s7.compare.states import snapshot_of

    return compare_blocks(snapshot_of(old, "old").blocks, snapshot_of(new, "new").blocks, load_policy(policy))
