"""Work in several processes: whose results they are, and what becomes of the processes."""

from __future__ import annotations

import operator
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from itertools import count
from pathlib import Path
from threading import Condition
from typing import Any

import pytest

from plcgen import api
from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.proof.checks import Outcome
from plcgen.proof.sharing import Sharing
from tests.projects import FAQ, ROOT, per_block


def shared_out(task: Any, total: int, progress: Any = None, workers: int | None = None) -> Sequence[Any]:
    return Sharing(workers=workers, progress=progress).results(task, total)


posix = pytest.mark.skipif(os.name != "posix", reason="signals")


@contextmanager
def second_thread() -> Iterator[None]:
    """Nothing may be forked in here."""
    over = threading.Event()
    thread = threading.Thread(target=over.wait)
    thread.start()
    yield
    over.set()
    thread.join()


@contextmanager
def alone() -> Iterator[None]:
    """A process with one thread."""
    yield


starts = pytest.mark.parametrize("start", [alone, second_thread])


def ppid(_: int) -> tuple[int, int]:
    return os.getpid(), os.getppid()


def killed(index: int) -> int:
    if index == 2:
        os.kill(os.getpid(), signal.SIGKILL)
    return index


def refused(index: int) -> int:
    if index == 2:
        raise DiagnosticError([Diagnostic("PG610", "twice", Span("a.scl", 3))])
    return index


def broken(index: int) -> float:
    return 1 / (index - 2)


@starts
def test_results_come_in_order_from_other_processes(start: Callable[[], object]) -> None:
    """Two children of this process do the work, forked or not, and are gone behind it."""
    told = []
    with start():
        found = shared_out(ppid, 20, lambda *said: told.append(said), workers=2)
    assert {parent for _, parent in found} == {os.getpid()}
    assert os.getpid() not in {child for child, _ in found}
    assert told == [("execute", number, 20) for number in range(1, 21)]
    assert shared_out(partial(operator.mul, 3), 7, workers=2) == [0, 3, 6, 9, 12, 15, 18]
    for child, _ in found:
        with pytest.raises(ProcessLookupError):
            os.kill(child, 0)


def test_one_piece_stays_in_this_process() -> None:
    """A process that starts takes longer than a small piece of work."""
    assert shared_out(ppid, 1, workers=2) == shared_out(ppid, 1, workers=1) == [(os.getpid(), os.getppid())]


def test_two_threads_get_their_own_results() -> None:
    """Again and again two callers at once: none gets what the other asked for."""

    def caller(number: int) -> list[list[int]]:
        return [shared_out(partial(operator.add, number), 3, workers=2) for _ in range(10)]

    with ThreadPoolExecutor(2) as threads:
        assert list(threads.map(caller, (100, 200))) == [[[100, 101, 102]] * 10, [[200, 201, 202]] * 10]


def test_two_threads_verify_two_projects(tmp_path: Path) -> None:
    """A good project is good and a damaged one is not, whoever else is verified meanwhile."""
    spec = tmp_path / "job.yaml"
    spec.write_text(per_block(FAQ.read_text("utf-8")).partition("  write_ramp_down:")[0], "utf-8")
    for name in ("good", "damaged"):
        assert api.generate(spec, tmp_path / name).ok
    source = tmp_path / "damaged/scl/ReadRampUp.scl"
    text = source.read_text("utf-8-sig")
    assert "#unit.expected[1] := DW#16#0801" in text
    source.write_text(text.replace("DW#16#0801", "DW#16#0601"), "utf-8-sig")  # another type is expected
    with ThreadPoolExecutor(2) as threads:
        good, damaged = threads.map(partial(api.verify, spec), (tmp_path / "good", tmp_path / "damaged"))
    assert good.ok
    assert {c.id for c in damaged.checks() if c.outcome is Outcome.ERROR} >= {"run.read_ramp_up"}


# --- ends that nobody wanted ----------------------------------------------------------------------------------


@posix
@starts
def test_a_killed_worker_is_no_bug(start: Callable[[], object]) -> None:
    """The out-of-memory killer ends a worker: the diagnostic says by which signal, nothing hangs."""
    with start(), pytest.raises(DiagnosticError) as raised:
        shared_out(killed, 6, workers=2)
    (found,) = raised.value.diagnostics
    assert found.code == "PG623"
    assert "signal SIGKILL" in found.message


def killed_once(index: int, place: Path) -> int:
    if index == 2 and not place.exists():
        place.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return index


@posix
@starts
def test_a_lost_worker_is_replaced_and_told(start: Callable[[], object], tmp_path: Path) -> None:
    """Its part is done again by another one: all results are there, and a warning."""
    share = Sharing(workers=2)
    with start():
        assert share.results(partial(killed_once, place=tmp_path / "dead"), 6) == [0, 1, 2, 3, 4, 5]
    (found,) = share.notes
    assert (found.code, found.severity.label) == ("PG623", "warning")
    assert "signal SIGKILL" in found.message


@starts
def test_what_a_task_raises_is_raised(start: Callable[[], object]) -> None:
    """Diagnostics as they are; anything else is a bug, with the traceback of the worker."""
    with start(), pytest.raises(DiagnosticError) as raised:
        shared_out(refused, 6, workers=2)
    assert raised.value.diagnostics == (Diagnostic("PG610", "twice", Span("a.scl", 3)),)
    with start(), pytest.raises(RuntimeError, match=r"in broken\n(.*\n)*ZeroDivisionError"):
        shared_out(broken, 6, workers=2)


SLEEP = "import time; from plcgen.proof.sharing import Sharing; "
SLEEP += "Sharing(workers=2, progress=say).results(time.sleep, 999)"
VERIFY = f"from plcgen import api; api.verify({str(FAQ)!r}, {str(ROOT / 'examples' / FAQ.stem / 'expected')!r}, "
VERIFY += "faults='full', progress=say)"
SAY = "say = lambda *what: print(*what, flush=True)\n"
THREAD = "import threading; threading.Thread(target=threading.Event().wait, daemon=True).start()\n"


@posix
@pytest.mark.parametrize("ending", [signal.SIGTERM, signal.SIGKILL, signal.SIGINT])
@pytest.mark.parametrize("code", [SLEEP, THREAD + SLEEP, VERIFY], ids=["forked", "new", "verify"])
def test_no_process_is_left(code: str, ending: signal.Signals) -> None:
    """Workers hold their parent's stdout and stderr: both end only when all processes have ended."""
    command = [sys.executable, "-c", SAY + code]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True, cwd=ROOT
    ) as process:
        assert process.stdout is not None
        assert any(line.startswith("execute 1 ") for line in process.stdout)  # the workers have work
        if ending == signal.SIGINT:
            os.killpg(process.pid, ending)  # as a terminal does
        else:
            process.send_signal(ending)
        try:
            _, errors = process.communicate(timeout=20)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            raise
    assert process.returncode == -ending
    assert errors.count("Traceback") == (ending == signal.SIGINT)


@posix
def test_a_worker_whose_parent_is_gone_ends_silently() -> None:
    """Its answer finds nobody: the process ends, and no traceback gets into the terminal."""
    code = (
        "import os, pickle; from plcgen.proof import workers; (told, piece), (heard, answer) = os.pipe(), os.pipe(); "
    )
    code += "os.write(piece, pickle.dumps(pickle.dumps((len, ('abc',), {})))); os.close(heard); "
    code += "workers._serve(None, os.fdopen(told, 'rb'), os.fdopen(answer, 'wb'))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stderr) == (0, "")


class Interrupted(Condition):
    """A lock whose owner is interrupted the ``left``-th time that it takes it."""

    left = 0

    def __enter__(self) -> bool:
        Interrupted.left -= 1
        if Interrupted.left == 0:
            raise KeyboardInterrupt
        return super().__enter__()


class Immediate(Executor):
    """Does everything at once; Ctrl-C comes when a lock of its futures is taken."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """A future that is done."""
        future: Future[Any] = Future()
        future._condition = Interrupted()
        future.set_result(fn(*args, **kwargs))
        return future


def test_ctrl_c_is_never_lost() -> None:
    """At whatever lock it comes: the caller hears of it."""
    for moment in count(1):
        Interrupted.left = moment
        try:
            task: Any = operator.index
            assert list(Sharing(executor=Immediate()).results(task, 3)) == [0, 1, 2]
        except KeyboardInterrupt:
            continue
        assert Interrupted.left > 0, f"swallowed at {moment}"
        break
