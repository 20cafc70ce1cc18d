"""The grammar of SCL, one part per concern; the parts share one ``Cursor`` and hold those they need.

``plcgen.scl.parser`` puts them together.
"""
