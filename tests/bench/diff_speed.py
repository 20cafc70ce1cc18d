"""``diff`` of two folders of SimaticML exports beside lxml that only parses the same documents."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

from lxml import etree

from plcgen import api

ROOT = Path(__file__).resolve().parents[2]
SPECS = ("s7-1500_g120_pn", "s7-1500_s120_messages", "s7-1500_s120_save")
FILES = 391
"""As many documents as a public project that was measured had."""
SECONDS = 3.0
RATIO = 14.0


def exports(folder: Path, count: int = FILES) -> None:
    """Write so many documents: those of example specs, over and over, with names of their own."""
    made = []
    with tempfile.TemporaryDirectory() as scratch:
        for spec in SPECS:
            api.generate(ROOT / f"specs/{spec}.yaml", Path(scratch) / spec)
            made += [
                (path.stem, path.read_text("utf-8-sig")) for path in sorted(Path(scratch, spec, "xml").glob("*.xml"))
            ]
    blocks = [(name, text) for name, text in made if "<SW.WatchAndForceTables" not in text]
    for number in range(count):
        name, text = blocks[number % len(blocks)]
        own = f"{name}_{number}"
        (folder / f"{own}.xml").write_text(text.replace(f"<Name>{name}</Name>", f"<Name>{own}</Name>"), "utf-8-sig")


def figures(count: int = FILES) -> tuple[float, float]:
    """Seconds of processor time: the comparison of two equal folders, and lxml on all documents of both."""
    with tempfile.TemporaryDirectory() as scratch:
        old, new = Path(scratch) / "old", Path(scratch) / "new"
        for folder in (old, new):
            folder.mkdir()
            exports(folder, count)
        times = []
        for _ in range(3):
            began = time.process_time()
            assert not api.diff([old], [new]).changes
            middle = time.process_time()
            for path in [*old.iterdir(), *new.iterdir()]:
                etree.fromstring(path.read_bytes())
            times.append((middle - began, time.process_time() - middle))
    ours, theirs = (min(column) for column in zip(*times, strict=True))
    return ours, theirs


def main() -> None:
    """Print the figures."""
    ours, theirs = figures()
    print(f"diff of two folders with {FILES} SimaticML exports beside lxml that only parses them")
    print(
        f"  plcgen {ours:.2f} s   goal <= {SECONDS:.0f} s   lxml {theirs:.2f} s   ratio {ours / theirs:.1f}   "
        f"goal <= {RATIO:.0f}"
    )


if __name__ == "__main__":
    main()
