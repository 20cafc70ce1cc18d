"""How the parts of a verification are run: on which executor, and which need not run again.

Every part is a call of a picklable task with a number. What it gives depends on nothing but the task, so that it does
not matter who calls it, in which order, or when.
"""

from __future__ import annotations

import contextlib
import hashlib
import pickle
import threading
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future
from dataclasses import dataclass, field
from queue import SimpleQueue
from typing import Protocol

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Severity, Span
from plcgen.proof.fingerprint import fingerprint
from plcgen.proof.results import Result
from plcgen.proof.workers import Workers, cores, possible

Progress = Callable[[str, int, int], None]
Task = Callable[[int], Result]
ATTEMPTS = 3
"""So often a part is begun whose worker is lost."""


class Verdicts(Protocol):
    """Results of earlier runs, by what they depend on."""

    def find(self, key: str) -> Result | None:
        """What is known."""

    def keep(self, key: str, result: Result) -> None:
        """Something new."""


@dataclass
class Sharing:
    """``executor`` None are processes of this machine, ``workers`` how many (None: one a core).

    ``verdicts`` is a cache, ``notes`` is what happened on the way.
    """

    executor: Executor | None = None
    workers: int | None = None
    verdicts: Verdicts | None = None
    progress: Progress | None = None
    notes: list[Diagnostic] = field(default_factory=list)

    @property
    def plain(self) -> bool:
        """Whether nothing is asked of it but to run everything on this machine."""
        return self.executor is None and self.verdicts is None

    def results(self, task: Task, total: int, keys: Callable[[int], str] | None = None) -> Sequence[Result]:
        """Results of ``task(0)`` to ``task(total - 1)``, in order; ``keys`` are what they depend on, "" is unknown.

        Raises:
            DiagnosticError: of the task; PG623 if workers are lost again and again.
        """
        wanted = range(total)
        found: dict[int, Result] = {}
        known = {index: keys(index) for index in wanted} if self.verdicts is not None and keys is not None else {}
        for index, key in known.items():
            before = self.verdicts.find(key) if self.verdicts is not None and key else None
            if before is not None:
                found[index] = before
        found |= self._run(task, [index for index in wanted if index not in found])
        for index, key in known.items():
            if key and not found[index].made and self.verdicts is not None:
                self.verdicts.keep(key, found[index])
        return [found[index] for index in range(total)]

    # --- running --------------------------------------------------------------------------------------

    def _run(self, task: Task, indexes: Sequence[int]) -> dict[int, Result]:
        if self.executor is not None:
            sent = Sent.of(task)
            return self._submitted(self.executor, lambda executor, index: executor.submit(sent, index), indexes)
        count = min(cores() if self.workers is None else self.workers, len(indexes))
        if count > 1 and possible():
            with contextlib.closing(Workers(task, count)) as workers:
                return self._submitted(workers, lambda executor, index: executor.submit(task, index), indexes)
        found = {}
        for done, index in enumerate(indexes):
            self._tell(done, len(indexes))
            found[index] = task(index)
        return found

    def _submitted(
        self, executor: Executor, submit: Callable[[Executor, int], Future[Result]], indexes: Iterable[int]
    ) -> dict[int, Result]:
        """Wait for all parts; one whose worker is lost is begun again."""
        waiting = {submit(executor, index): index for index in indexes}
        total, attempts = len(waiting), dict.fromkeys(waiting.values(), 1)
        ended: SimpleQueue[Future[Result]] = SimpleQueue()  # a generator (as_completed) that is left can swallow Ctrl-C
        found: dict[int, Result] = {}
        try:
            for future in waiting:
                future.add_done_callback(ended.put)
            while waiting:
                future = ended.get()
                index = waiting.pop(future)
                try:
                    found[index] = future.result()
                except BrokenExecutor as problem:
                    self._lost(str(problem), again=attempts[index] < ATTEMPTS)
                    attempts[index] += 1
                    repeated = self._again(submit, executor, index)
                    waiting[repeated] = index
                    repeated.add_done_callback(ended.put)
                    continue
                self._tell(len(found), total)
        except BaseException:
            for future in waiting:
                future.cancel()
            raise
        return found

    def _again(
        self, submit: Callable[[Executor, int], Future[Result]], executor: Executor, index: int
    ) -> Future[Result]:
        try:
            return submit(executor, index)
        except BrokenExecutor as problem:  # a pool of Python's own takes nothing more
            self._lost(str(problem), again=False)
            raise

    def _lost(self, how: str, *, again: bool) -> None:
        help_ = "if the memory ran out, close other programs and run it again"
        if not again:
            message = f"worker processes were terminated from outside ({how}): not everything was executed"
            raise DiagnosticError([Diagnostic("PG623", message, Span(""), help=help_)])
        message = f"a worker process was terminated from outside ({how}): its work was done again"
        self.notes.append(Diagnostic("PG623", message, Span(""), Severity.WARNING, help=help_))

    def _tell(self, done: int, total: int) -> None:
        if self.progress is not None:
            self.progress("execute", done, total)


# --- for an executor that may be anywhere ---------------------------------------------------------------------

_RECEIVED = threading.local()
"""The task that this thread called last: it is made once, not for each of its parts."""


@dataclass(frozen=True, slots=True)
class Sent:
    """A task as bytes: a worker that has seen it makes nothing of it again."""

    digest: bytes
    data: bytes
    tool: str

    @classmethod
    def of(cls, task: Task) -> Sent:
        """A task to be sent."""
        data = pickle.dumps(task)
        return cls(hashlib.sha256(data).digest(), data, fingerprint())

    def __call__(self, index: int) -> Result:
        """One part.

        Raises:
            DiagnosticError: PG626 if this copy of plcgen, or what runs it, is another one.
        """
        if fingerprint() != self.tool:
            help_ = "install the same plcgen, Python and libraries everywhere"
            raise DiagnosticError([Diagnostic("PG626", "a worker has another copy of plcgen", Span(""), help=help_)])
        if getattr(_RECEIVED, "digest", None) != self.digest:
            _RECEIVED.task = pickle.loads(self.data)  # noqa: S301 - of whoever may run code here anyway
            _RECEIVED.digest = self.digest
        task: Task = _RECEIVED.task
        return task(index)
