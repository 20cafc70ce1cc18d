"""CPU types by name: what of blocks, work memory and record jobs each one holds (``specs/cpus/s7.yaml``).

Every fact has a grade and a source: ``r`` read in a text of Siemens, ``s`` in a third-party text or that of a sibling
CPU, ``k`` recalled. A fact that was not found is None.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from plcgen.base.files.text import read_text
from plcgen.base.files.yaml import load_yaml
from plcgen.base.resources import specs_dir

KILO = 1024
RECALLED = "k"


@dataclass(frozen=True, slots=True)
class CpuFact:
    """A largest number with its grade (r, s, k) and where it was found; ``low`` is the smallest one of a range."""

    value: int
    grade: str
    source: str
    low: int = 0

    @property
    def remark(self) -> str:
        """What a message must say about the evidence; empty if the fact was read somewhere."""
        return " (recalled: no document was found)" if self.grade == RECALLED else ""


@dataclass(frozen=True, slots=True)
class RecordJobLimit:
    """How many jobs of WRREC and RDREC run at once: ``jobs`` of both ``together``, else of each.

    ``per`` is what the limit belongs to. With the firmware ``since`` and later it is ``newer``.
    Source: Siemens entry 15364459.
    """

    jobs: int
    together: bool
    per: str
    newer: int | None
    since: str
    source: str


@dataclass(frozen=True, slots=True)
class CpuType:
    """A CPU type. ``work`` is work memory for code and data in bytes; S7-400 and S7-1500 have one for each instead,
    of which only that for data is known for the S7-1500: nobody estimates its code.

    ``blocks`` is how many blocks there can be, ``counts`` how many of a kind (FB, DB), ``numbers`` which numbers they
    have. ``redundant``: it is one of a pair (S7-400H, S7-1500R/H). ``block_size`` and ``db_size`` are the bytes of the
    largest code block and DB with standard access.
    """

    name: str
    family: str
    order_number: str
    firmware: str
    work: CpuFact | None
    work_code: CpuFact | None
    work_data: CpuFact | None
    blocks: CpuFact | None
    counts: Mapping[str, CpuFact]
    numbers: Mapping[str, CpuFact]
    block_size: CpuFact | None
    db_size: CpuFact | None
    record_jobs: RecordJobLimit
    redundant: bool


def cpu_names(family: str | None = None) -> tuple[str, ...]:
    """Names of all CPU types, or of those of a family, in the order of the table."""
    return tuple(name for name, known in _table().items() if family in {None, known.family})


def find_cpu(name: str) -> CpuType | None:
    """The CPU type of this name in any common spelling, or of an order number; None if the table has none.

    ``CPU 315-2 DP``, ``1516F-3 PN/DP``, ``1214C AC/DC/Rly``, ``6ES7516-3AN02-0AB0``.
    """
    plain = _plain(name)
    if not plain.startswith(_ORDER):
        return _spellings().get(_SUPPLY.sub("", plain))
    return next((known for stem, known in _orders().items() if plain.startswith(_ORDER + stem)), None)


def cpu(name: str) -> CpuType:
    """The CPU type of this name. Raises KeyError if the table has none."""
    found = find_cpu(name)
    if found is None:
        raise KeyError(name)
    return found


def _plain(name: str) -> str:
    return re.sub(r"[\s/_-]", "", name.upper()).removeprefix("CPU")


_ORDER = "6ES7"
"""What every order number of a CPU begins with."""
_SUPPLY = re.compile(r"(?:AC|DC)DC(?:DC|RLY|RELAY)\Z")
"""Supply, inputs and outputs behind the name of an S7-1200, as ``_plain`` has them: DC/DC/DC, AC/DC/RLY."""


@functools.cache
def _spellings() -> dict[str, CpuType]:
    rows, known = _rows(), _table()
    return {_plain(own): known[name] for name, row in rows.items() for own in (name, *row.get("named", ()))}


@functools.cache
def _orders() -> dict[str, CpuType]:
    known = _table()
    return {_plain(stem): known[name] for name, row in _rows().items() for stem in row.get("orders", ())}


@functools.cache
def _data() -> Any:
    path = specs_dir() / "cpus" / "s7.yaml"
    return load_yaml(read_text(path), path.as_posix()).data()


def _rows() -> dict[str, dict[str, Any]]:
    rows: dict[str, dict[str, Any]] = _data()["cpus"]
    return rows


@functools.cache
def _table() -> dict[str, CpuType]:
    groups, sources = _data()["groups"], _data()["sources"]
    return {name: _cpu(name, groups[row["group"]] | row, sources) for name, row in _rows().items()}


def _cpu(name: str, row: dict[str, Any], sources: dict[str, str]) -> CpuType:
    def fact(key: str, unit: int = KILO) -> CpuFact | None:
        if key not in row:
            return None
        value, grade, source = row[key]
        return CpuFact(value * unit, grade, sources[source])

    def numbers(key: str) -> CpuFact:
        (low, high), grade, source = row[key]
        return CpuFact(high, grade, sources[source], low)

    counts = {"FB": fact("fbs", 1), "DB": fact("dbs", 1)}
    jobs, _, jobs_source = row["record_jobs"]
    return CpuType(
        name=name,
        family=row["group"],
        order_number=row.get("order_number", ""),
        firmware=row.get("firmware", ""),
        work=fact("work_kb"),
        work_code=fact("work_code_kb"),
        work_data=fact("work_data_kb"),
        blocks=fact("blocks", 1),
        counts={kind: found for kind, found in counts.items() if found is not None},
        numbers={"FB": numbers("fb_numbers"), "DB": numbers("db_numbers")},
        block_size=fact("block_kb"),
        db_size=fact("db_kb"),
        record_jobs=RecordJobLimit(
            jobs["jobs"], jobs["together"], jobs["per"], jobs.get("newer"), jobs.get("since", ""), sources[jobs_source]
        ),
        redundant=row.get("redundant", False),
    )
