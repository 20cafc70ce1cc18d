"""CPUs by name, as ``ppi.profiles`` has them: specs and the simulator know the same sizes."""

from plcgen.protocols.ppi.wire.profiles import TYPE_LENGTH, Profile, profile, profiles

__all__ = ["TYPE_LENGTH", "Profile", "profile", "profiles"]
