"""Processes of this machine that work for their parent, as an executor.

A worker is a process with one pipe to it and one from it. It is forked only where that is safe: on Linux, out of a
process with one thread. Elsewhere a new interpreter starts, which does not import the caller's ``__main__``: a script
that calls ``plcgen.verify`` needs no guard. A worker ends when its parent does, however that ends: its pipe does, too.
"""

from __future__ import annotations

import contextlib
import io
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import threading
import traceback
from collections.abc import Callable
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path
from queue import SimpleQueue
from typing import IO, Any, NoReturn

from plcgen.base.diagnostics import DiagnosticError

START = "import pickle, sys; sys.path = pickle.load(sys.stdin.buffer); from plcgen.proof.workers import serve; serve()"
TASK = "task"
"""Stands for what every worker knows."""


def cores() -> int:
    """How many workers are of use."""
    return os.cpu_count() or 1


def possible() -> bool:
    """Whether there is an interpreter that can be started."""
    return bool(sys.executable) and not getattr(sys, "frozen", False)


class Workers(Executor):
    """Some processes that all know one task: wherever a call names it, it is not sent again.

    A process that is ended from outside is replaced; its call raises BrokenProcessPool.
    """

    def __init__(self, task: object, count: int) -> None:
        self._task = task
        self._idle: SimpleQueue[_Worker] = SimpleQueue()
        self._all: list[_Worker] = []
        self._lock, self._closed = threading.Lock(), False
        for _ in range(count):  # all of them before the first thread: it would forbid to fork
            self._add()
        self._threads = ThreadPoolExecutor(count)

    def _add(self) -> None:
        worker = _start(self._task)
        self._all.append(worker)
        self._idle.put(worker)

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Call a function in a process; both must be picklable, and what it returns."""
        return self._threads.submit(self._run, (fn, args, kwargs))

    def _run(self, call: tuple[Any, ...]) -> Any:
        worker = self._idle.get()
        try:
            found = worker.run(_dumped(call, self._task))
        except _EndedError:
            worker.kill()
            with self._lock:
                if not self._closed:
                    self._add()
            raise BrokenProcessPool(_ending(worker.wait())) from None
        except BaseException:
            self._idle.put(worker)
            raise
        self._idle.put(worker)
        return found

    def close(self) -> None:
        """End all processes, whatever they do."""
        with self._lock:
            self._closed = True
        self._threads.shutdown(wait=False, cancel_futures=True)
        for worker in self._all:
            worker.close()  # threads that still listen hear the end of their pipe
        self._threads.shutdown()


class _Sending(pickle.Pickler):
    """Names the task that the worker knows instead of sending it."""

    def __init__(self, buffer: io.BytesIO, task: object) -> None:
        super().__init__(buffer)
        self._known = task

    def persistent_id(self, obj: object) -> str | None:
        """The task's name."""
        return TASK if obj is self._known else None


class _Receiving(pickle.Unpickler):
    """Puts the task in where it is named."""

    def __init__(self, data: bytes, task: object) -> None:
        super().__init__(io.BytesIO(data))
        self._known = task

    def persistent_load(self, _: object) -> object:
        """The task: nothing else has a name."""
        return self._known


def _dumped(call: object, task: object) -> bytes:
    buffer = io.BytesIO()
    _Sending(buffer, task).dump(call)
    return buffer.getvalue()


# --- in the caller's process ----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Worker:
    """One process: where it is told the next piece, where it answers; ``wait`` returns its exit code."""

    pieces: IO[bytes]
    answers: IO[bytes]
    kill: Callable[[], None]
    wait: Callable[[], int | None]

    def run(self, call: bytes) -> Any:
        """Result of one call. Raises DiagnosticError, and RuntimeError for whatever else it raised."""
        try:
            pickle.dump(call, self.pieces)
            self.pieces.flush()
            kind, answer = pickle.load(self.answers)  # noqa: S301 - our own process
        except (EOFError, OSError, pickle.UnpicklingError):
            raise _EndedError from None
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


def _ending(code: int | None) -> str:
    names = {-number: f"signal {number.name}" for number in signal.Signals}
    return names.get(code or 0, f"exit code {code}")


def _start(task: object) -> _Worker:
    """A worker; a new interpreter is sent the search path and the task first."""
    if _fork_is_safe():
        return _forked(task)
    process = subprocess.Popen(  # noqa: S603 - this interpreter
        [sys.executable, "-P", "-c", START],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        start_new_session=True,  # Ctrl-C is for the parent: it could meet an interpreter that is not ready to ignore it
    )
    assert process.stdin is not None  # both are pipes
    assert process.stdout is not None
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


def _forked(task: object) -> _Worker:
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


def serve() -> NoReturn:
    """A new interpreter: the task is what comes behind the search path."""
    pieces, answers = sys.stdin.buffer, sys.stdout.buffer
    sys.stdout = sys.stderr  # whatever is printed must not get between the answers
    _serve(pickle.load(pieces), pieces, answers)  # noqa: S301 - from our parent


def _serve(task: object, pieces: IO[bytes], answers: IO[bytes]) -> NoReturn:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent gets it, too, and ends its workers
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    waiting: SimpleQueue[bytes] = SimpleQueue()
    threading.Thread(target=_listen, args=(pieces, waiting), daemon=True).start()
    while True:
        call = waiting.get()
        try:
            fn, args, kwargs = _Receiving(call, task).load()
            answer = pickle.dumps(("result", fn(*args, **kwargs)))
        except DiagnosticError as problem:
            answer = pickle.dumps(("diagnostics", problem.diagnostics))
        except Exception:  # noqa: BLE001 - the parent raises it
            answer = pickle.dumps(("bug", traceback.format_exc()))
        try:
            answers.write(answer)
            answers.flush()
        except OSError:  # the parent has ended
            os._exit(0)


def _listen(pieces: IO[bytes], waiting: SimpleQueue[bytes]) -> None:
    """Pass the pieces on, in a thread of its own: the end of the pipe ends the process in the middle of a piece."""
    with contextlib.suppress(EOFError, OSError):
        while True:
            waiting.put(pickle.load(pieces))  # noqa: S301 - from our parent
    os._exit(0)
