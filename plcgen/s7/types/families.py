"""Families of CPUs that plcgen knows."""

from __future__ import annotations

from typing import Literal, get_args

Family = Literal["s7-300", "s7-400", "s7-1200", "s7-1500"]
FAMILIES: tuple[Family, ...] = get_args(Family)
