"""Settings that every job has: times, counts, triggers, what follows a failure (docs/spec.md, "Jobs")."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from plcgen.oracles.spec.place import milliseconds

TIMEOUT_MS, PAUSE_MS = 10_000, 200
SOON_MS = 0, 20, 50, 100
"""Before the first questions for an answer that is not there yet, none of them longer than the pause of the job."""
SHARE = 4, 5
"""The retries take 80 % of the timeout."""
MOST_RETRIES = 30_000
SIGNALS = ("execute", "busy", "done", "error", "status")


@dataclass(frozen=True, slots=True)
class Times:
    """Timeout, pause between two polls, and retries; None: as many as take their share of the timeout."""

    timeout_ms: int
    pause_ms: int
    retries: int | None

    def counted(self, timeout_ms: int) -> int:
        """How often a telegram is repeated at most in a job that may take so long."""
        if self.retries is not None:
            return self.retries
        part, whole = SHARE
        return min(max(1, timeout_ms * part // whole // max(1, self.pause_ms)), MOST_RETRIES)


def times(job: Mapping[str, Any]) -> Times:
    """Times of a job."""
    timeout = milliseconds(job.get("timeout"), TIMEOUT_MS)
    pause = milliseconds(job.get("retry_pause"), PAUSE_MS)
    return Times(timeout, pause, job.get("retries"))


def restores(job: Mapping[str, Any]) -> str:
    """Whether old values are restored, and only while the drive is ``stopped`` or also while ``running``."""
    given = job.get("on_error")
    if given is None:
        return ""
    asked = given.get("restore") if isinstance(given, Mapping) else given
    return "running" if asked == "running" else "stopped"


def outside_signals(job: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Triggers that do not lie in DB DriveJobs, by what they are; one alone is ``execute``."""
    given = job.get("trigger")
    if isinstance(given, str):
        given = {"execute": given}
    for name in SIGNALS:
        if given and given.get(name):
            yield name, str(given[name])
