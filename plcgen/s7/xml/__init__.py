"""SimaticML as text: namespaces per TIA Portal version, SCL code as StructuredText, interfaces. Pure, no XML library.

The reading side (``plcgen.s7.read``) turns the same documents back into blocks and SCL with lxml.
"""
