"""Siemens SCL: lexer, parser, syntax tree, dialect checks and declarations. Pure, no I/O, no third party.

``parser.parse`` turns text into units and diagnostics, ``declarations.blocks`` turns units into the block
model of ``plcgen.s7.types.blocks``. One grammar serves the three dialects of ``dialect.Dialect``.
"""
