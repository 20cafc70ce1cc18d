"""Keywords by what they begin or end; several parts of the grammar stop at them."""

from __future__ import annotations

from plcgen.s7.scl.lexer import EOF

SECTIONS = frozenset({"VAR", "VAR_INPUT", "VAR_OUTPUT", "VAR_IN_OUT", "VAR_TEMP", "CONST", "LABEL"})
UNITS = frozenset({"FUNCTION_BLOCK", "FUNCTION", "ORGANIZATION_BLOCK", "DATA_BLOCK", "TYPE"})
UNIT_ENDS = frozenset("END_" + keyword for keyword in UNITS)

CLOSERS = frozenset({"END_IF", "END_CASE", "END_FOR", "END_WHILE", "END_REPEAT", "END_REGION", "UNTIL"})
STOPS = CLOSERS | {"ELSIF", "ELSE", "NETWORK", "END_NETWORK", EOF} | UNIT_ENDS | UNITS
"""Where a list of statements ends; only a SIMATIC SD document has tokens of the kinds NETWORK and END_NETWORK."""
STARTS = frozenset({"IF", "CASE", "FOR", "WHILE", "REPEAT", "EXIT", "CONTINUE", "RETURN", "GOTO", "REGION"})
CODE = STOPS | STARTS
"""Keywords that belong to statements, so that nothing else reaches across them."""
