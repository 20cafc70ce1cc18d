"""What is wrong with planned PPI masters."""

from __future__ import annotations

from plcgen.ppi.rules import line, names
from plcgen.project.part import Rules

RULES = Rules(
    checks=(line.checks,), names=names.names, texts=names.texts, untranslated=names.untranslated, taken=names.taken
)
