"""Long work for the page: one at a time, in a thread of its own, with progress and a way to end it."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, PlcgenError, Span
from plcgen.base.files.options import usage

Progress = Callable[[str, int, int], None]
Work = Callable[[Progress], dict[str, Any]]


class CancelledError(BaseException):
    """Somebody has ended the work: like Ctrl-C, nothing that looks after errors of checks may keep it."""


@dataclass(slots=True)
class _Task:
    """One piece of work: what it does now, and how it ended."""

    number: int
    what: str = ""
    done: int = 0
    total: int = 0
    result: dict[str, Any] | None = None
    problems: tuple[Diagnostic, ...] = ()
    ended: bool = False
    cancelled: threading.Event = field(default_factory=threading.Event)

    def progress(self, what: str, done: int, total: int) -> None:
        """Called by the work. Raises CancelledError where it may end."""
        if self.cancelled.is_set():
            raise CancelledError
        self.what, self.done, self.total = what, done, total


class Worker:
    """Runs one task after the other; a second one is refused while the first runs."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._task: _Task | None = None

    def start(self, work: Work) -> dict[str, Any]:
        """Begin. Raises DiagnosticError while another task runs."""
        with self._lock:
            if self._task is not None and not self._task.ended:
                raise usage("start", "something is running already", "wait for it, or cancel it")
            task = self._task = _Task(0 if self._task is None else self._task.number + 1)
        threading.Thread(target=_run, args=(task, work), daemon=True, name="work").start()
        return {"number": task.number}

    def state(self) -> dict[str, Any]:
        """Where the task is; its result comes with the end. Raises DiagnosticError with what ended it."""
        task = self._task
        if task is None:
            return {"number": -1, "ended": True, "cancelled": False, "result": None}
        if task.problems:
            raise DiagnosticError(task.problems)
        return {
            "number": task.number, "ended": task.ended, "cancelled": task.cancelled.is_set(),
            "what": task.what, "done": task.done, "total": task.total, "result": task.result,
        }  # fmt: skip

    def cancel(self) -> dict[str, Any]:
        """End the task at its next step."""
        if self._task is not None:
            self._task.cancelled.set()
        return {}


def _run(task: _Task, work: Work) -> None:
    try:
        task.result = work(task.progress)
    except CancelledError:
        pass
    except DiagnosticError as problem:
        task.problems = problem.diagnostics
    except PlcgenError as problem:
        task.problems = (Diagnostic("PG901", str(problem), Span("")),)
    except Exception as problem:
        task.problems = (Diagnostic("PG902", f"internal error: {type(problem).__name__}: {problem}", Span("")),)
        raise
    finally:
        task.ended = True
