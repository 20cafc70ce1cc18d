"""How many telegrams a spec may have: as many as its text is long, so that a short one is never hours of work."""

from __future__ import annotations

from collections.abc import Sequence

from plcgen.ds47.plan.nouns import DriveJob
from plcgen.project.spec import LoadedSpec

MAX_TELEGRAMS = 20_000
"""Telegrams of one project, counted in every instance."""
SHORT = 300
"""Different telegrams that any spec may have: 17,000 values of a REAL array."""
BYTES = 8
"""A longer spec may have another one for so many bytes of its text. Each is four files and about 3 ms of work."""


class Room:
    """What is left for further jobs."""

    def __init__(self, loaded: LoadedSpec) -> None:
        texts = (loaded.text, *(text for _, text in loaded.included))
        self.length = sum(len(text.encode()) for text in texts)
        self.different = SHORT + self.length // BYTES
        self._all, self._left = MAX_TELEGRAMS, self.different

    def problem(self, jobs: Sequence[DriveJob]) -> tuple[str, str] | None:
        """Take the instances of one more job in; a message and its help if they have too many telegrams."""
        self._all -= sum(len(one.telegrams) for one in jobs)
        self._left -= max((len(one.telegrams) for one in jobs), default=0)
        if self._all < 0:
            message = f"the drive jobs up to here have more than {MAX_TELEGRAMS} telegrams"
            return message, "split the project: no CPU has room for so many"
        if self._left < 0:
            message = f"the drive jobs up to here have more than {self.different} different telegrams"
            rest = f"a spec of {self.length:,} bytes has at most {SHORT} and one for every {BYTES} bytes"
            return message, f"look at the ranges of indexes, or split the project: {rest}"
        return None
