"""Generation against rendering the same templates with bare Jinja2, and how it grows with the number of jobs."""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from bench.specs import many_jobs

ROUNDS = 5
GOAL = 1.5


def ratio(jobs: int = 1000) -> tuple[float, float, float]:
    """Median seconds of generation, of bare rendering, and the median of their ratios, in pairs A B A B."""
    from plcgen.diagnostics import Report
    from plcgen.emit import emit
    from plcgen.plan.resolve import resolve
    from plcgen.render.environment import environment
    from plcgen.render.project import collector_paused, render_project
    from plcgen.rules import apply_rules
    from plcgen.spec.load import parse_spec

    text = many_jobs(jobs)

    def generate() -> None:
        with collector_paused():
            report = Report()
            loaded = parse_spec(text, "bench.yaml", report)
            assert loaded is not None  # noqa: S101 - the spec is ours
            project = resolve(loaded, report)
            apply_rules(project, report)
            render_project(project)

    loaded = parse_spec(text, "bench.yaml", Report())
    assert loaded is not None  # noqa: S101 - the spec is ours
    documents = list(emit(resolve(loaded, Report())))
    templates = {d.template: environment().get_template(d.template) for d in documents}

    def bare() -> None:
        for document in documents:
            templates[document.template].render(document.view)

    generate()
    bare()
    pairs = [(_seconds(generate), _seconds(bare)) for _ in range(ROUNDS)]
    ours, theirs = (statistics.median(column) for column in zip(*pairs, strict=True))
    return ours, theirs, statistics.median(a / b for a, b in pairs)


def _seconds(run: Callable[[], None]) -> float:
    start = time.perf_counter()
    run()
    return time.perf_counter() - start


_CHILD = """
import json, sys, time
from bench.specs import many_jobs
from pathlib import Path
import tempfile
from plcgen import api
jobs = int(sys.argv[1])
with tempfile.TemporaryDirectory() as folder:
    spec = Path(folder) / "job.yaml"
    spec.write_text(many_jobs(jobs))
    start = time.perf_counter()
    result = api.generate(spec, Path(folder) / "out")
    seconds = time.perf_counter() - start
    assert result.ok, result.diagnostics[:3]
    status = Path("/proc/self/status")
    lines = status.read_text().splitlines() if status.exists() else []
    peak = next((int(line.split()[1]) / 1024 for line in lines if line.startswith("VmHWM")), 0.0)
    print(json.dumps([seconds, peak, len(result.written)]))
"""


def growth(sizes: tuple[int, ...] = (100, 1000, 10_000)) -> list[tuple[int, float, float, int]]:
    """(jobs, seconds, peak MiB, files) of complete generations, files written, each in a process of its own."""
    rows = []
    for jobs in sizes:
        out = subprocess.run(
            [sys.executable, "-c", _CHILD, str(jobs)], cwd=Path(__file__).parent.parent, capture_output=True, check=True
        )
        seconds, memory, files = json.loads(out.stdout)
        rows.append((jobs, seconds, memory, files))
    return rows
