"""Blocks made from a spec carry a hash of their own text in the header, NAME ("User-defined ID" in the TIA Portal).

A compare in the TIA Portal then tells whether two blocks are the same text; VERSION tells which plcgen made them.
NAME has room for eight characters and begins with a letter (S7-SCL V5.3 manual, block attributes).
"""

from __future__ import annotations

import hashlib
import re
from dataclasses import replace

from plcgen.s7.types.blocks import Block

_EMPTY = "H0000000"
"""What a template has in place of the hash."""
_UNHASHED = re.compile(r"^(?:NAME|VERSION) : .*\n", re.MULTILINE)


def with_own_hash(text: str, block: Block) -> tuple[str, Block]:
    """A finished source and its block with their hash, if the template has a place for it; line ends are LF.

    It leaves out the lines NAME and VERSION: the same code from a newer plcgen has the same hash.
    """
    if block.attributes.get("NAME") != _EMPTY:
        return text, block
    digits = hashlib.sha256(_UNHASHED.sub("", text).encode()).hexdigest()[:7].upper()
    name = f"H{digits}"
    return text.replace(f"NAME : {_EMPTY}\n", f"NAME : {name}\n", 1), replace(
        block, attributes=block.attributes | {"NAME": name}
    )
