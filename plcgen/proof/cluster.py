"""A Dask cluster as an executor: the extra ``cluster`` brings ``distributed``.

Scheduler and workers run what they are sent, and what they answer is believed: both must be trusted as this machine is.
Whether the connection is encrypted is Dask's matter: an address ``tls://..`` with certificates in Dask's configuration.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, Executor, Future
from contextlib import contextmanager
from typing import Any

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Severity, Span

PATIENCE = 20
"""Seconds that a scheduler and its first worker are waited for."""


class ClusterExecutor(Executor):
    """Dask's executor, which gets what is large once and not with every call."""

    def __init__(self, client: Any) -> None:
        self._client = client
        self._sent: dict[int, tuple[object, Any]] = {}

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Call a function on one of the workers. A worker that is lost is replaced by another one, some times."""
        if id(fn) not in self._sent:
            self._sent[id(fn)] = fn, self._client.scatter(fn, broadcast=True, hash=False)
        found: Future[Any] = Future()
        remote = self._client.submit(_call, self._sent[id(fn)][1], *args, pure=False, **kwargs)

        def ended(done: Any) -> None:
            if found.cancelled():
                return
            problem = done.exception() if done.status != "cancelled" else None
            if done.status == "cancelled":
                found.set_exception(BrokenExecutor("the scheduler has dropped it"))
            elif problem is not None:
                lost = type(problem).__name__ == "KilledWorker"
                found.set_exception(BrokenExecutor("workers that had this part were lost") if lost else problem)
            else:
                found.set_result(done.result())

        remote.add_done_callback(ended)
        return found


def _call(fn: Callable[..., Any], *args: Any, **kwargs: Any) -> Any:
    return fn(*args, **kwargs)


@contextmanager
def cluster(address: str, notes: list[Diagnostic]) -> Iterator[Executor]:
    """The executor of a scheduler; workers that are lost meanwhile are told in ``notes``.

    Raises:
        DiagnosticError: PG626 if Dask is not installed, nobody answers, or there is no worker.
    """
    try:
        from distributed import Client
    except ImportError:
        help_ = 'pip install "plcgen[cluster]"'
        raise DiagnosticError([Diagnostic("PG626", "Dask is not installed", Span(""), help=help_)]) from None
    try:
        client: Any = Client(address, timeout=PATIENCE, set_as_default=False)  # type: ignore[no-untyped-call]
    except (OSError, ValueError, TypeError, RuntimeError) as problem:
        message = f"the scheduler {address} cannot be reached: {problem}"
        help_ = "start it (dask scheduler), and name tcp://host:8786, or tls:// with certificates"
        raise DiagnosticError([Diagnostic("PG626", message, Span(""), help=help_)]) from problem
    with client:
        try:
            client.wait_for_workers(1, timeout=PATIENCE)
        except TimeoutError as problem:
            message = f"the scheduler {address} has no worker"
            raise DiagnosticError(
                [Diagnostic("PG626", message, Span(""), help=f"start some: dask worker {address}")]
            ) from problem
        before = set(client.scheduler_info(n_workers=-1)["workers"])
        yield ClusterExecutor(client)
        for name in sorted(before - set(client.scheduler_info(n_workers=-1)["workers"])):
            message = f"the worker {name} was lost: its work was done again by other workers"
            notes.append(Diagnostic("PG623", message, Span(""), Severity.WARNING, help="see the log of the worker"))
