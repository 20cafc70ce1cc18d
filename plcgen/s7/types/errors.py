"""What paths and values of a CPU's memory may be refused for."""

from __future__ import annotations

from plcgen.base.diagnostics import PlcgenError


class UnknownPathError(PlcgenError, KeyError):
    """A path, name or address that nothing has, or an index out of its bounds."""


class UnfitValueError(PlcgenError, ValueError):
    """A value that its type cannot hold, or bytes that mean nothing in it."""
