"""CPUs by name, as ``ppi.profiles`` has them: specs and the simulator know the same sizes."""

from plcgen.ppi.wire.profiles import TYPE_LENGTH, CpuProfile, profile, profiles

__all__ = ["TYPE_LENGTH", "CpuProfile", "profile", "profiles"]
