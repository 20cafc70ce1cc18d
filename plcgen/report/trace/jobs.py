"""A job in a run: started in the first scan, followed until done or error."""

from __future__ import annotations

from collections.abc import Sequence

from plcgen.report.trace.face import RecordedJob
from plcgen.report.trace.model import Contact, Ending, JobResult
from plcgen.report.trace.recorder import RecordingCpu, Watched, watch

_FLAGS = ("busy", "done", "error")


class JobWatch:
    """One job of a run. Raises KeyError if a member is missing."""

    def __init__(self, cpu: RecordingCpu, job: RecordedJob) -> None:
        self.job, self.facts = job, job.facts
        self.ending: Ending = "not started"
        self._cpu = cpu
        self._pins: dict[str, Watched] = {name: watch(cpu, job.facts.pins[name])[0] for name in (*_FLAGS, "status")}
        self._status = self._telegrams = self._retries = 0
        self._end = (0, 0)
        self._rested = False
        self._kept = job.end(finished=False)

    @property
    def finished(self) -> bool:
        """Whether the job has ended."""
        return self.ending in {"done", "error"}

    def begin(self) -> None:
        """Set execute."""
        self._cpu[self.facts.execute] = True

    def after(self, contacts: Sequence[Contact]) -> None:
        """Look at the job after a scan."""
        if self.finished:
            return
        self._telegrams += sum(map(self.job.sends, contacts))
        self._retries += self.job.after()
        busy, done, error = (self._pins[name].value() for name in _FLAGS)
        if done or error:
            self._finish(error=bool(error))
        elif busy:
            self.ending = "running"

    def again(self) -> None:
        """Somebody may start it once more: then that run is the one to tell of."""
        busy, done, error = (self._pins[name].value() for name in _FLAGS)
        if not self.finished:
            return
        if busy:
            self.ending = "running"
            self._telegrams = self._retries = 0
        elif not done and not error:
            self._rested = True
        elif self._rested:  # refused at once: it never was busy
            self._telegrams = self._retries = 0
            self._finish(error=bool(error))

    def _finish(self, *, error: bool) -> None:
        self.ending, self._rested = "error" if error else "done", False
        self._end = self._cpu.scans, self._cpu.clock
        self._keep()

    def _keep(self) -> None:
        """Take status and values over as they are now: the next start changes them."""
        status = self._pins["status"].value()
        self._status = status if isinstance(status, int) else 0
        self._kept = self.job.end(finished=self.finished)

    def result(self) -> JobResult:
        """How the job ended, or where it stands."""
        if not self.finished:
            self._keep()
            self._end = self._cpu.scans, self._cpu.clock
        facts, kept = self.facts, self._kept
        text = facts.texts.get(self._status, "not a status word of a job block")
        return JobResult(
            facts.key, facts.partner, self.ending, self._status, text, *self._end, self._telegrams, self._retries,
            kept.record_status, kept.record_text, kept.values,
        )  # fmt: skip
