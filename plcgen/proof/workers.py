"""Pieces of work shared out over the cores, results in order."""

from __future__ import annotations

import multiprocessing
import os
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from typing import Any, TypeVar

Result = TypeVar("Result")
Progress = Callable[[str, int, int], None]

_inherited: list[Callable[[int], Any]] = []


def _forked(index: int) -> Any:
    return _inherited[0](index)


def shared_out(
    task: Callable[[int], Result], total: int, progress: Progress | None = None, workers: int | None = None
) -> Iterator[Result]:
    """Results of ``task(0)`` to ``task(total - 1)`` in order; ``workers`` None uses every core.

    Processes are forked, so a task may use whatever is in memory; what it returns must be picklable.
    """
    count = min(workers if workers is not None else os.cpu_count() or 1, total)
    if count < 2 or "fork" not in multiprocessing.get_all_start_methods():
        for index in range(total):
            if progress is not None:
                progress("execute", index, total)
            yield task(index)
        return
    _inherited[:] = [task]
    found: dict[int, Result] = {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        with ProcessPoolExecutor(count, multiprocessing.get_context("fork")) as pool:
            futures = {pool.submit(_forked, index): index for index in range(total)}
            for future in as_completed(futures):
                found[futures[future]] = future.result()
                if progress is not None:
                    progress("execute", len(found), total)
    _inherited.clear()
    yield from (found[index] for index in range(total))
