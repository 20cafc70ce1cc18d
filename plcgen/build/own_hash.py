"""Blocks made from a spec carry a hash of their own text in the header, NAME ("User-defined ID" in the TIA Portal).

A compare in the TIA Portal then tells whether two blocks are the same text; VERSION tells which plcgen made them.
NAME has room for eight characters and begins with a letter (S7-SCL V5.3 manual, block attributes).
"""

from __future__ import annotations

import hashlib
import re
from dataclasses import replace

from plcgen._version import __version__
from plcgen.s7.types.blocks import Block

_EMPTY = "H0000000"
"""What a template has in place of the hash; its VERSION is 0.0."""
_NAME = re.compile(r"^NAME : .*$", re.MULTILINE)
_VERSION = re.compile(r"^(VERSION : '?)0\.0('?)$", re.MULTILINE)
"""In quotation marks for STEP 7 V5."""
_UNHASHED = re.compile(r"^(?:NAME|VERSION) : .*\n", re.MULTILINE)


def with_own_hash(text: str, block: Block) -> tuple[str, Block]:
    """A finished source and its block with version and hash, if the template has a place for them; line ends are LF.

    The hash leaves out the lines NAME and VERSION: the same code from a newer plcgen has the same one.
    """
    if block.attributes.get("NAME") != _EMPTY:
        return text, block
    name = f"H{hashlib.sha256(_UNHASHED.sub('', text).encode()).hexdigest()[:7].upper()}"
    version = ".".join(__version__.split(".")[:2])
    text = _NAME.sub(f"NAME : {name}", _VERSION.sub(rf"\g<1>{version}\g<2>", text, count=1), count=1)
    return text, replace(block, attributes=block.attributes | {"NAME": name, "VERSION": version})
