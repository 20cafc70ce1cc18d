"""Reading a SimaticML export beside lxml that only parses it, and how the time grows with the size."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from multiprocessing import get_context
from pathlib import Path
from statistics import median

from plcgen import api
from plcgen.__main__ import collect_rarely
from plcgen.s7.types.blocks import Block, BlockKind, Section, SectionKind
from plcgen.s7.types.data_types import ELEMENTARY, Member
from plcgen.s7.xml.reading.documents import read_simaticml
from plcgen.s7.xml.spelling import VERSIONS
from plcgen.s7.xml.writing.documents import Setting, document
from plcgen.s7.xml.writing.elements import BlockScope
from plcgen.s7.xml.writing.structured_text import elements, numbered

ROOT = Path(__file__).resolve().parents[2]
SIZES = (1, 5, 20)
"""Megabytes."""

ROUNDS = 7
GOAL = 4.0
SETTING = Setting(VERSIONS["V19"], classic=False)


def code_export(megabytes: float) -> bytes:
    """One FB whose code is that of a generated job, over and over."""
    with tempfile.TemporaryDirectory() as folder:
        api.generate(ROOT / "specs/s7-1500_g120_pn.yaml", Path(folder) / "out")
        blocks, _ = read_simaticml(Path(folder) / "out/xml/SetRamps.xml")
    (block,) = blocks
    from plcgen.s7.scl.lexer import tokenize

    code = f"{block.code}\n"
    once = elements(tokenize(code, "bench"), 0, len(code), BlockScope.of(block), SETTING)
    times = max(1, round(megabytes * 1e6 / len(numbered(once))))
    return document(block, SETTING, numbered(once * times))[0].encode()


def data_export(megabytes: float) -> bytes:
    """One DB with very many members, each with a comment and a start value."""
    word = ELEMENTARY["WORD"]
    members = [Member(f"value{n}", word, f"16#{n % 65536:04X}", f"value number {n}") for n in range(10)]
    size = len(document(Block(BlockKind.DB, "D", (Section(SectionKind.STATIC, tuple(members)),)), SETTING)[0]) / 10
    count = round(megabytes * 1e6 / (size - 80))
    many = (Member(f"value{n}", word, f"16#{n % 65536:04X}", f"value number {n}") for n in range(count))
    block = Block(BlockKind.DB, "D", (Section(SectionKind.STATIC, tuple(many)),), optimized=False)
    return document(block, SETTING)[0].encode()


def table() -> list[tuple[str, float, float, float, float]]:
    """(kind, megabytes, milliseconds of ours, of lxml alone, their ratio), each row from a process of its own.

    In one process for all, what larger documents leave in the heap makes lxml alone nearly twice as fast with the next
    one, which nobody has who reads an export.
    """
    wanted = [(kind, megabytes) for kind in ("code", "data") for megabytes in SIZES]
    with get_context("spawn").Pool(1, initializer=collect_rarely, maxtasksperchild=1) as pool:
        return pool.map(row, wanted, chunksize=1)


def row(wanted: tuple[str, float]) -> tuple[str, float, float, float, float]:
    """One row of the table: medians of turns A B A B."""
    from lxml import etree

    kind, megabytes = wanted
    data = (code_export if kind == "code" else data_export)(megabytes)
    blocks, diagnostics = read_simaticml(data)
    assert (len(blocks), diagnostics) == (1, [])
    del blocks
    pairs = [(_seconds(lambda: read_simaticml(data)), _seconds(lambda: etree.fromstring(data))) for _ in range(ROUNDS)]
    ours, theirs = (median(column) for column in zip(*pairs, strict=True))
    return kind, len(data) / 1e6, ours * 1000, theirs * 1000, ours / theirs


def _seconds(run: Callable[[], object]) -> float:
    start = time.process_time()
    run()
    return time.process_time() - start


def main() -> None:
    """Print the figures."""
    print("reading SimaticML exports beside lxml that only parses them")
    rows = table()
    for kind, megabytes, ours, theirs, ratio in rows:
        goal = f"   goal <= {GOAL:.0f}" if round(megabytes) == SIZES[1] else ""
        print(
            f"  {kind} {megabytes:5.1f} MB   plcgen {ours:8.1f} ms   lxml {theirs:7.1f} ms   ratio {ratio:4.1f}{goal}"
        )
    for kind in ("code", "data"):
        each = [ours / megabytes for name, megabytes, ours, _, _ in rows if name == kind]
        print(f"  {kind}: {each[-1] / each[0]:.2f} times the time per MB at {SIZES[-1]} MB as at {SIZES[0]} MB")


if __name__ == "__main__":
    main()
