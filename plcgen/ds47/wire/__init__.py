"""Data set 47, the PROFIdrive acyclic parameter channel: telegrams, formats, error numbers, STATUS codes.

Everything here is pure. ``formats`` knows the data types, ``model`` the values, ``codec`` the bytes,
``dissect`` explains bytes to people, ``description`` the parameter description (attribute 20h),
``errors`` and ``status`` the numbers a drive or a CPU answers with.
"""
