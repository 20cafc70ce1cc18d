"""Generation against rendering the same templates with bare Jinja2, and how it grows with the number of jobs."""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from tests.bench.specs import many_jobs

ROUNDS = 5
GOAL = 1.5
"""Set when the block of a job was three times as long: the less there is to render, the more everything else counts."""


def ratio(jobs: int = 1000) -> tuple[float, float, float]:
    """Median seconds of generation, of bare rendering, and the median of their ratios, in pairs A B A B.

    Without the documents that are made from the text of others: see :func:`code`.
    """
    from plcgen.base.diagnostics import Report
    from plcgen.build.engine import emit
    from plcgen.build.environment import environment, render_all
    from plcgen.build.manifest import entry, manifest
    from plcgen.project.loading import parse_spec
    from plcgen.project.resolve import resolve
    from plcgen.project.rules import apply_rules

    text = many_jobs(jobs)

    def generate() -> None:
        report = Report()
        loaded = parse_spec(text, "bench.yaml", report)
        assert loaded is not None
        project = resolve(loaded, report)
        apply_rules(project, report)
        files = list(render_all(replace(document, twins=None) for document in emit(project)))
        manifest(project, [entry(file) for file in files])

    loaded = parse_spec(text, "bench.yaml", Report())
    assert loaded is not None
    documents = list(emit(resolve(loaded, Report())))
    documents = [document for document in documents if document.template]
    templates = {d.template: environment().get_template(d.template) for d in documents}

    def bare() -> None:
        for document in documents:
            templates[document.template].render(document.view)

    generate()
    bare()
    pairs = [(_seconds(generate), _seconds(bare)) for _ in range(ROUNDS)]
    ours, theirs = (statistics.median(column) for column in zip(*pairs, strict=True))
    return ours, theirs, statistics.median(a / b for a, b in pairs)


CODE_TEMPLATE = (
    "{% for e in elements %}{% if e.0 %}<{{ e.0 }}{% for name, value in e.1 %} {{ name }}={{ '\"' }}{{ value }}"
    "{{ '\"' }}{% endfor %}>{{ e.2 }}{% else %}</{{ e.1 }}>{{ e.2 }}{% endif %}{% endfor %}"
)
"""Writes a document from its elements, each known with its attributes."""


def code(jobs: int = 100) -> tuple[float, float, float, float]:
    """Seconds of ours and of bare Jinja2 for the SimaticML of code blocks, their median ratio, MB/s of ours.

    Ours begins with the SCL text; Jinja2 gets the finished list of elements and only writes them.
    """
    from jinja2 import Environment
    from lxml import etree

    from plcgen.base.diagnostics import Report
    from plcgen.build.engine import emit
    from plcgen.build.environment import render_text
    from plcgen.build.reread import reread
    from plcgen.project.loading import parse_spec
    from plcgen.project.resolve import resolve

    loaded = parse_spec(many_jobs(jobs), "bench.yaml", Report())
    assert loaded is not None
    found = [document for document in emit(resolve(loaded, Report())) if document.twins is not None]
    texts = [(document, render_text(document.template, document.view)) for document in found]

    def ours() -> list[str]:
        made = []
        for document, text in texts:
            assert document.twins is not None
            assert document.promise is not None
            made += [twin.text for twin in document.twins(reread(text, document.path, document.promise))]
        return made

    documents = ours()
    lists = [_elements(etree.fromstring(document.encode())) for document in documents]
    template = Environment(autoescape=True).from_string(CODE_TEMPLATE)

    def bare() -> None:
        for elements in lists:
            template.render(elements=elements)

    bare()
    pairs = [(_seconds(ours), _seconds(bare)) for _ in range(ROUNDS)]
    first, second = (statistics.median(column) for column in zip(*pairs, strict=True))
    return first, second, statistics.median(a / b for a, b in pairs), sum(map(len, documents)) / first / 1e6


def _elements(root: Any) -> list[tuple[str, Any, str]]:
    """Flatten a tree: (tag, attributes, text) for every start, ("", tag, tail) for every end."""
    from lxml import etree

    out: list[tuple[str, Any, str]] = []
    for event, element in etree.iterwalk(root, events=("start", "end")):
        tag = etree.QName(element).localname
        if event == "start":
            out.append((tag, list(element.attrib.items()), element.text or ""))
        else:
            out.append(("", tag, element.tail or ""))
    return out


def _seconds(run: Callable[[], object]) -> float:
    start = time.process_time()
    run()
    return time.process_time() - start


_CHILD = """
import json, sys, time
from tests.bench.specs import many_jobs
from pathlib import Path
from typing import Any
import tempfile
from plcgen import api
from plcgen.__main__ import collect_rarely
collect_rarely()
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
            [sys.executable, "-c", _CHILD, str(jobs)], cwd=Path(__file__).parents[2], capture_output=True, check=True
        )
        seconds, memory, files = json.loads(out.stdout)
        rows.append((jobs, seconds, memory, files))
    return rows
