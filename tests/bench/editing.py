"""What an editor or the page waits for after an edit, as a ratio to one ``check`` of the same file; medians of CPU."""

from __future__ import annotations

import shutil
import statistics
import tempfile
import time
from collections.abc import Callable, Iterator
from functools import partial
from itertools import count
from pathlib import Path

import yaml

from plcgen import api
from plcgen.s7.cpu.sources import check_source
from plcgen.workbench.serve.app import questions
from plcgen.workbench.serve.desk import Desk
from plcgen.workbench.serve.room import Room
from plcgen.workbench.service import Document, Workspace
from tests.projects import ROOT, generated_example

PLANT = ROOT / "specs" / "s7-1200_plant.yaml"
EXAMPLE = "s7-1500_g120_pn"
LINES = 5_000
GOALS = {
    ".yaml": {"problems": 1.5, "completion": 2.0, "hover": 1.5, "outline": 1.5},
    ".scl": {"problems": 0.5, "hover": 0.2, "colours": 0.2, "outline": 0.5},
}
"""One edit answered: at most so many times the time of one check; of a large source one block is read."""
PAGE = {"check": 2.5, "search": 4.0, "kinds": 3.0, "change": 2.5, "becomes": 30.0}
"""The same for the page: ``kinds`` tries a job of each, ``becomes`` makes every file."""
ROUNDS = 15


def median(run: Callable[[], object], rounds: int) -> float:
    """Median of CPU seconds."""
    seconds = []
    for _ in range(rounds):
        start = time.process_time()
        run()
        seconds.append(time.process_time() - start)
    return statistics.median(seconds)


def rows(rounds: int = ROUNDS) -> Iterator[tuple[str, str, float, float]]:
    """File, question, seconds of the answer to an edit, seconds of one check."""
    with tempfile.TemporaryDirectory() as folder:
        spec = Path(folder) / PLANT.name
        shutil.copy(PLANT, spec)
        yield from _asked(spec, spec.read_text("utf-8"), lambda: api.check(spec), rounds, "drive: *fans", 8)
        source = Path(folder) / "large.scl"
        (made,) = generated_example(EXAMPLE).glob("*.scl")
        text = made.read_text("utf-8-sig")
        while text.count("\n") < LINES:
            text += text
        source.write_text(text, "utf-8")
        yield from _asked(source, text, lambda: check_source(source), rounds, "#", 1)


def _asked(
    path: Path, text: str, check: Callable[[], object], rounds: int, mark: str, inside: int
) -> Iterator[tuple[str, str, float, float]]:
    workspace, edits = Workspace(path.parent), count()
    before = text[: text.rindex(mark) + inside]
    line, column = before.count("\n") + 1, len(before) - before.rfind("\n")
    comment = "#" if path.suffix == ".yaml" else "//"

    def edited() -> Document:
        return workspace.open(path, f"{text}\n{comment} {next(edits)}\n")

    answers: dict[str, Callable[[], object]] = {
        "problems": lambda: workspace.diagnostics(edited()),
        "completion": lambda: workspace.complete(edited(), line, column),
        "hover": lambda: workspace.hover(edited(), line, column),
        "colours": lambda: workspace.tokens(edited()),
        "outline": lambda: workspace.outline(edited()),
    }
    asked = GOALS[path.suffix]
    for run in (check, *(answers[name] for name in asked)):
        run()
    one = median(check, rounds)
    for name in asked:
        yield path.name, name, median(answers[name], rounds), one


def page_rows(rounds: int = ROUNDS) -> Iterator[tuple[str, str, float, float]]:
    """Questions of the page about an edited plant, as ``rows`` has them."""
    with tempfile.TemporaryDirectory() as folder:
        spec = Path(folder) / PLANT.name
        shutil.copy(PLANT, spec)
        text, edits = spec.read_text("utf-8"), count()
        known = questions(Desk(Room(spec.parent), spec.parent))
        drive, job = (next(iter(yaml.safe_load(text)[section])) for section in ("drives", "jobs"))
        given: dict[str, dict[str, object]] = {
            "search": {"job": f"jobs/{job}", "words": "ramp"},
            "kinds": {"partner": drive},
            "change": {"what": "job", "given": {"key": "more", "drive": drive, "kind": "acknowledge"}},
        }

        def asked(name: str) -> object:
            shape, answer = known[name]
            return answer(shape(name=spec.name, text=f"{text}\n# {next(edits)}\n", **given.get(name, {})))

        api.check(spec)
        one = median(lambda: api.check(spec), rounds)
        for name in PAGE:
            asked(name)
            yield "page", name, median(partial(asked, name), rounds), one


def main(*, short: bool = False) -> None:
    """Print the ratios."""
    print("an edit in an editor, against one check of the same file")
    rounds = 5 if short else ROUNDS
    for name, question, seconds, one in (*rows(rounds), *page_rows(rounds)):
        ratio, goal = seconds / one, GOALS.get(Path(name).suffix, PAGE)[question]
        print(
            f"  {name:<20} {question:<10} {seconds * 1000:7.1f} ms   check {one * 1000:7.1f} ms"
            f"   ratio {ratio:.2f}   goal <= {goal}"
        )


if __name__ == "__main__":
    main()
