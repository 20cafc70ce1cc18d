"""The layout of a large data block beside lxml parsing the same block as SimaticML, and how both grow.

The document is the block as TIA Portal exports it for S7-1500: seven attributes, a comment and a start value a
member. ``lean`` is the same document without what the layout does not need; lxml has next to nothing to do there.
"""

from __future__ import annotations

import gc
import random
import re
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from lxml import etree

from plcgen import api

GOAL = 5.0
MEMBERS = 10_000
ROUNDS = 9
GROWTH = (10_000, 20_000, 40_000)

_TYPES = (
    ("Bool", "FALSE"), ("Bool", "TRUE"), ("Byte", "16#03"), ("Word", "16#00FF"), ("Int", "12"), ("DInt", "70000"),
    ("Real", "10.5"), ("Time", "T#5s"), ("String[20]", ""), ("Array[0..9] of Byte", ""), ("Array[1..3] of Real", ""),
)  # fmt: skip
_ATTRIBUTES = "".join(
    f'\n        <BooleanAttribute Name="{name}"{informative} SystemDefined="true">true</BooleanAttribute>'
    for name, informative in (
        ("ExternalAccessible", ""), ("ExternalVisible", ""), ("ExternalWritable", ""),
        ("UserVisible", ' Informative="true"'), ("UserReadOnly", ' Informative="true"'),
        ("UserDeletable", ' Informative="true"'), ("SetPoint", ""),
    )
)  # fmt: skip


def members(count: int) -> list[tuple[str, str, str, str]]:
    """Name, type, start value and comment; always the same ones."""
    chosen = random.Random(1).choices(_TYPES, k=count)  # the same block in every run
    return [(f"Value_{n}", type_, start, f"comment of value {n}") for n, (type_, start) in enumerate(chosen)]


def text(count: int) -> str:
    """The block as a source."""
    lines = [
        f"      {name} : {type_}{f' := {start}' if start else ''};   // {comment}"
        for name, type_, start, comment in members(count)
    ]
    head = "DATA_BLOCK \"Big\"\n{ S7_Optimized_Access := 'FALSE' }\nVERSION : 0.1\nNON_RETAIN\n   STRUCT\n"
    return head + "\n".join(lines) + "\n   END_STRUCT;\n\nBEGIN\nEND_DATA_BLOCK\n"


def document(count: int) -> bytes:
    """The block as TIA Portal exports it."""
    parts = [
        f'    <Member Name="{name}" Datatype="{type_}" Remanence="NonRetain" Accessibility="Public">\n'
        f"      <AttributeList>{_ATTRIBUTES}\n      </AttributeList>\n"
        f'      <Comment><MultiLanguageText Lang="en-US">{comment}</MultiLanguageText></Comment>\n'
        + (f"      <StartValue>{start}</StartValue>\n" if start else "")
        + "    </Member>\n"
        for name, type_, start, comment in members(count)
    ]
    head = (
        '<?xml version="1.0" encoding="utf-8"?>\n<Document>\n  <Engineering version="V18" />\n'
        '  <SW.Blocks.GlobalDB ID="0">\n    <AttributeList>\n'
        '      <Interface><Sections xmlns="http://www.siemens.com/automation/Openness/SW/Interface/v5">\n'
        '  <Section Name="Static">\n'
    )
    tail = (
        "  </Section></Sections></Interface>\n      <MemoryLayout>Standard</MemoryLayout>\n      <Name>Big</Name>\n"
        "      <Number>5</Number>\n      <ProgrammingLanguage>DB</ProgrammingLanguage>\n    </AttributeList>\n"
        "  </SW.Blocks.GlobalDB>\n</Document>\n"
    )
    return (head + "".join(parts) + tail).encode()


def lean(data: bytes) -> bytes:
    """The document without the attributes of its members."""
    return re.sub(rb"\s*<AttributeList>\s*<BooleanAttribute.*?</AttributeList>", b"", data, flags=re.DOTALL)


def alternate(*runs: Callable[[], object]) -> list[float]:
    """Shortest processor time of each run in seconds, in turns; nobody pays for the litter of the run before."""
    times = [float("inf")] * len(runs)
    for _ in range(ROUNDS):
        for position, run in enumerate(runs):
            gc.collect()
            began = time.process_time()
            kept = run()  # giving memory back to the system is not part of the work
            times[position] = min(times[position], time.process_time() - began)
            del kept
    return times


def figures(count: int = MEMBERS) -> dict[str, float]:
    """Seconds: layout of the text and of the document, from file to table; lxml alone on both documents."""
    data = document(count)
    short = lean(data)
    with tempfile.TemporaryDirectory() as scratch:
        source, export = Path(scratch) / "big.db", Path(scratch) / "big.xml"
        source.write_text(text(count), "utf-8")
        export.write_bytes(data)
        assert api.layout(source).blocks[0].size == api.layout(export).blocks[0].size
        names = ("text", "xml", "lxml", "lxml lean")
        runs = (
            lambda: api.layout(source),
            lambda: api.layout(export),
            lambda: etree.fromstring(data),
            lambda: etree.fromstring(short),
        )
        return dict(zip(names, alternate(*runs), strict=True))


def growth() -> list[tuple[int, float]]:
    """Members, and seconds for the layout of a text source with so many."""
    rows = []
    with tempfile.TemporaryDirectory() as scratch:
        for count in GROWTH:
            source = Path(scratch) / f"{count}.db"
            source.write_text(text(count), "utf-8")
            rows.append((count, alternate(lambda source=source: api.layout(source))[0]))
    return rows


def main() -> None:
    """Print the figures."""
    found = figures()
    print(f"layout of a DB with {MEMBERS:,} members, file to table, against lxml parsing its export")
    for name, label in (("text", "source (.db)"), ("xml", "export (.xml)")):
        print(
            f"  {label:<26} {1000 * found[name]:6.0f} ms   lxml {1000 * found['lxml']:4.0f} ms   "
            f"ratio {found[name] / found['lxml']:4.1f}   goal <= {GOAL:.0f}   "
            f"(lxml on the bare members {1000 * found['lxml lean']:.0f} ms)"
        )
    rows = growth()
    for count, seconds in rows:
        print(f"  {count:>7,} members             {1000 * seconds:6.0f} ms   {1e6 * seconds / count:5.1f} us/member")
    (_, first), (_, last) = rows[0], rows[-1]
    print(f"  4 times the members take {last / first:.1f} times as long")


if __name__ == "__main__":
    main()
