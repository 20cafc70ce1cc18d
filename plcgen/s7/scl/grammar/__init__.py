"""The grammar of SCL, one part per concern; the parts share one ``Cursor`` and hold those they need.

``plcgen.s7.scl.parser`` puts them together.
"""
