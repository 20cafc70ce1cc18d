"""What a job does that has a cycle: it runs again and again, lets others go first, and says how old its values are."""

from __future__ import annotations

WAITS, VALID = 2, 3
"""Cycles: after so many it no longer lets others go first; values are valid for so many."""
LEAST_VALID_MS = 1000
"""So long values are valid at least: a telegram may take longer than a short cycle."""
OLDEST_MS = 24 * 86_400_000
"""24 days: as far as a TIME counts; so old or older, or there are no values yet."""
