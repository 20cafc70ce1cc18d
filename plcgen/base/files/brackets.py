"""``[r0947[0..7]]`` in YAML: brackets close behind a name belong to the name.

In YAML's own brackets (``[ ]``, ``{ }``) a plain text ends at the next bracket or comma, so an array would be a syntax
error there, and only there. No valid YAML has a bracket close behind a letter or digit in that place: the brackets,
commas and colons of such a name are hidden from the parser behind characters for private use, one for one, so that
every position stays what it is.
"""

from __future__ import annotations

import re

_INDEXED = re.compile(r"(?<=\w)\[(?:[^\[\]{}\"'#,:\r\n]{0,60}|[0-9.,:;…– -]{0,60})\]")
_HIDDEN = {"[": "\ue000", "]": "\ue001", ",": "\ue002", ":": "\ue003"}
_TAKEN = re.compile(r"[\ue000-\ue003]|\\[uU]0*[eE]00[0123]")
"""The characters themselves, or an escape that stands for one."""

_HIDE = str.maketrans(_HIDDEN)
_SHOW = str.maketrans({hidden: shown for shown, hidden in _HIDDEN.items()})


def hide_indexes(text: str) -> str:
    """The text with the indexes of names hidden; unchanged if it has none, or the hiding places are taken."""
    if "[" not in text or _TAKEN.search(text):
        return text
    return _INDEXED.sub(lambda found: found[0].translate(_HIDE), text)


def show_indexes(text: str) -> str:
    """What was hidden in a part of the text as it was."""
    return text.translate(_SHOW)
