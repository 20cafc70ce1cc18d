"""What is wrong with planned PPI masters."""

from __future__ import annotations

from plcgen.protocols.base import Rules
from plcgen.protocols.ppi.rules import line, names

RULES = Rules(
    checks=(line.checks,), names=names.names, texts=names.texts, untranslated=names.untranslated, taken=names.taken
)
