"""Pieces of work shared out over the cores, results in order.

A worker is a process with one pipe to it and one from it. It is forked only where that is safe: on Linux, out of a
process with one thread. Elsewhere a new interpreter starts, which does not import the caller's ``__main__``: a script
that calls ``plcgen.verify`` needs no guard. A worker ends when its parent does, however that ends: its pipe does, too.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import threading
import traceback
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from queue import SimpleQueue
from typing import IO, Any, NoReturn, TypeVar

from plcgen.diagnostics import Diagnostic, DiagnosticError, Span

Result = TypeVar("Result")
Progress = Callable[[str, int, int], None]
Task = Callable[[int], Result]
"""What is called with the number of every piece. It must be picklable: a worker may start from nothing."""

START = "import pickle, sys; sys.path = pickle.load(sys.stdin.buffer); from plcgen.proof import workers; workers.main()"


def shared_out(
    task: Task[Result], total: int, progress: Progress | None = None, workers: int | None = None
) -> list[Result]:
    """Results of ``task(0)`` to ``task(total - 1)``; ``workers`` None uses every core.

    What a task returns must be picklable. Raises the task's DiagnosticError, and PG623 if the system ends a worker.
    """
    count = min(workers if workers is not None else os.cpu_count() or 1, total)
    if count > 1 and sys.executable and not getattr(sys, "frozen", False):
        return _in_workers(task, total, progress, count)
    results = []
    for index in range(total):
        if progress is not None:
            progress("execute", index, total)
        results.append(task(index))
    return results


def _in_workers(task: Task[Result], total: int, progress: Progress | None, count: int) -> list[Result]:
    idle: SimpleQueue[_Worker] = SimpleQueue()

    def run(index: int) -> Any:
        worker = idle.get()
        try:
            return worker.run(index)
        finally:
            idle.put(worker)

    with contextlib.ExitStack() as processes:
        for _ in range(count):  # all of them before the first thread: it would forbid to fork
            idle.put(processes.enter_context(contextlib.closing(_start(task))))
        with ThreadPoolExecutor(count) as threads:
            futures = [threads.submit(run, index) for index in range(total)]
            try:
                for done, future in enumerate(as_completed(futures), 1):
                    future.result()
                    if progress is not None:
                        progress("execute", done, total)
            except BaseException as problem:
                threads.shutdown(wait=False, cancel_futures=True)
                if isinstance(problem, _EndedError):
                    problem.worker.kill()
                    raise DiagnosticError([_diagnostic(problem.worker.wait())]) from None
                raise
            finally:
                processes.close()  # threads that still listen hear the end of their pipe
        return [future.result() for future in futures]


# --- in the caller's process ----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Worker:
    """One process: where it is told the next piece, where it answers; ``wait`` returns its exit code."""

    pieces: IO[bytes]
    answers: IO[bytes]
    kill: Callable[[], None]
    wait: Callable[[], int | None]

    def run(self, index: int) -> Any:
        """Result of one piece. Raises DiagnosticError, and RuntimeError for whatever else the task raised."""
        try:
            pickle.dump(index, self.pieces)
            self.pieces.flush()
            kind, answer = pickle.load(self.answers)  # noqa: S301 - our own process
        except (EOFError, OSError, pickle.UnpicklingError):
            raise _EndedError(self) from None
        if kind == "diagnostics":
            raise DiagnosticError(answer)
        if kind == "bug":
            raise RuntimeError(answer)
        return answer

    def close(self) -> None:
        """End the process."""
        self.kill()
        self.wait()
        for pipe in (self.pieces, self.answers):
            with contextlib.suppress(OSError):  # what was still on its way to the process
                pipe.close()


class _EndedError(Exception):
    """A worker ended before its work did."""

    def __init__(self, worker: _Worker) -> None:
        super().__init__()
        self.worker = worker


def _diagnostic(code: int | None) -> Diagnostic:
    names = {-number: f"signal {number.name}" for number in signal.Signals}
    how = names.get(code or 0, f"exit code {code}")
    message = f"a worker process was ended from outside ({how}): not everything was executed"
    return Diagnostic("PG623", message, Span(""), help="if the memory ran out, close other programs and run it again")


def _start(task: Task[Any]) -> _Worker:
    """A worker; a new interpreter is sent the search path and the task first."""
    if _fork_is_safe():
        return _forked(task)
    process = subprocess.Popen(  # noqa: S603 - this interpreter
        [sys.executable, "-P", "-c", START],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        start_new_session=True,  # Ctrl-C is for the parent: it could meet an interpreter that is not ready to ignore it
    )
    assert process.stdin is not None and process.stdout is not None  # noqa: S101, PT018 - they are pipes
    worker = _Worker(process.stdin, process.stdout, process.kill, process.wait)
    with contextlib.suppress(BrokenPipeError):  # it has ended already: the first piece says so
        pickle.dump(sys.path, worker.pieces)
        pickle.dump(task, worker.pieces)
        worker.pieces.flush()
    return worker


def _fork_is_safe() -> bool:
    """Whether no other thread can hold a lock at this moment, which nobody would release in a forked process."""
    try:
        threads = list(Path("/proc/self/task").iterdir())
    except OSError:
        return False
    return len(threads) == 1 and sys.platform == "linux" and not multiprocessing.current_process().daemon


def _forked(task: Task[Any]) -> _Worker:
    """A worker that has everything in memory already."""
    (piece, told), (heard, answer) = os.pipe(), os.pipe()

    def child() -> None:
        os.close(told)  # else it would keep its own pipe open when its parent has ended
        os.close(heard)
        _serve(task, os.fdopen(piece, "rb"), os.fdopen(answer, "wb"))

    process = multiprocessing.get_context("fork").Process(target=child, daemon=True)
    process.start()
    os.close(piece)
    os.close(answer)

    def wait() -> int | None:
        process.join()
        return process.exitcode

    return _Worker(os.fdopen(told, "wb"), os.fdopen(heard, "rb"), process.kill, wait)


# --- in a worker ----------------------------------------------------------------------------------------------


def main() -> NoReturn:
    """A new interpreter: the task is what comes behind the search path."""
    pieces, answers = sys.stdin.buffer, sys.stdout.buffer
    sys.stdout = sys.stderr  # whatever is printed must not get between the answers
    _serve(pickle.load(pieces), pieces, answers)  # noqa: S301 - from our parent


def _serve(task: Task[Any], pieces: IO[bytes], answers: IO[bytes]) -> NoReturn:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent gets it, too, and ends its workers
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    waiting: SimpleQueue[int] = SimpleQueue()
    threading.Thread(target=_listen, args=(pieces, waiting), daemon=True).start()
    while True:
        index = waiting.get()
        try:
            answer = pickle.dumps(("result", task(index)))
        except DiagnosticError as problem:
            answer = pickle.dumps(("diagnostics", problem.diagnostics))
        except Exception:  # noqa: BLE001 - the parent raises it
            answer = pickle.dumps(("bug", traceback.format_exc()))
        answers.write(answer)
        answers.flush()


def _listen(pieces: IO[bytes], waiting: SimpleQueue[int]) -> None:
    """Pass the pieces on, in a thread of its own: the end of the pipe ends the process in the middle of a piece."""
    with contextlib.suppress(EOFError, OSError):
        while True:
            waiting.put(pickle.load(pieces))  # noqa: S301 - from our parent
    os._exit(0)
