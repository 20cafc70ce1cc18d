"""What all tests have in common: nothing depends on how busy the machine is (work.py counts calls instead)."""

from __future__ import annotations

from hypothesis import HealthCheck, settings

settings.register_profile("plcgen", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("plcgen")
