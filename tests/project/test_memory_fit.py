"""The size of a program beside its CPU: shares, words, and what does not fit."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.base.diagnostics import Span
from plcgen.project.cpus import cpu
from plcgen.project.fit import ProgramSize, kilobytes
from plcgen.s7.memory.estimate import BlockSize, Estimate

KB = 1024
PLACE = Span("job.yaml", 1, 1, 1, 2)


def size(code: int, data: int, name: str = "", *, classic: bool = True) -> ProgramSize:
    """One FB and one DB."""
    blocks = (BlockSize("FB", "job", 1, code, 0, 1234), BlockSize("DB", "data", 1, 0, data))
    return ProgramSize(Estimate(blocks, classic), cpu(name) if name else None)


def test_one_line_for_people() -> None:
    """30 KB + 2 KB are 12 % of 256 KB (12.5 rounded down)."""
    assert size(30 * KB, 2 * KB).text() == "1 FB, 1 DB of 1,234 lines, about 32 KB of work memory"
    assert size(30 * KB, 2 * KB, "315-2DP").text().endswith("of work memory, 12 % of a CPU 315-2DP")
    assert size(0, KB, "1214C", classic=False).text() == "1 FB, 1 DB of 1,234 lines, 1.0 KB in data blocks"


def test_two_memories_count_separately() -> None:
    """A CPU 412-1 has 144 KB for code and as much for data: 36 KB of data are 25 %, 72 KB of code 50 %."""
    assert size(72 * KB, 36 * KB, "412-1").share == 50
    assert size(36 * KB, 72 * KB, "412-1").share == 50
    found = list(size(1 * KB, 145 * KB, "412-1").misfits(PLACE))
    assert [d.code for d in found] == ["PG412", "PG413"]
    assert found[1].message == "about 145 KB of data: a CPU 412-1 has 144 KB of work memory for data"


def test_the_limit_itself_fits() -> None:
    """32 KB fit 32 KB, a byte more does not."""
    assert list(size(16 * KB, 16 * KB, "312").misfits(PLACE)) == []
    (found,) = size(16 * KB, 16 * KB + 1, "312").misfits(PLACE)
    assert found.code == "PG413"
    assert found.severity.label == "warning"


def test_what_is_recalled_says_so() -> None:
    """Limits without a document only warn, and say why; of an S7-1500 only data are counted."""
    found = [d.message for d in size(0, 1025 * KB, "1511", classic=False).misfits(PLACE)]
    assert [message.split(":")[0] for message in found] == ['1,025 KB data of DB "data"', "1,025 KB of data"]
    assert all("recalled: no document was found" in message for message in found)


def test_data_blocks_fill_the_one_memory_of_an_s7_1200() -> None:
    """A CPU 1214C has 100 KB for everything: 100 KB in data blocks of 50 KB fit, 102,401 bytes do not."""
    blocks = [BlockSize("DB", name, number, 0, 50 * KB) for number, name in enumerate("ab", 1)]
    fits, over = (Estimate((*blocks, *more), classic=False) for more in ((), (BlockSize("DB", "c", 3, 0, 1),)))
    assert list(ProgramSize(fits, cpu("1214C")).misfits(PLACE)) == []
    (found,) = ProgramSize(over, cpu("1214C")).misfits(PLACE)
    assert found.message.startswith("100 KB of data: a CPU 1214C has 100 KB of work memory for data")


def test_without_a_cpu_nothing_is_said() -> None:
    """There is nothing to compare with."""
    assert size(10_000 * KB, 0).share is None
    assert list(size(10_000 * KB, 0).misfits(PLACE)) == []


def test_kilobytes() -> None:
    """1 KB is 1024 bytes; small numbers have a digit more."""
    assert [kilobytes(n) for n in (512, 9 * KB, 10 * KB, 1000 * KB)] == ["0.5 KB", "9.0 KB", "10 KB", "1,000 KB"]


SPEC = """
plc: {name: a, family: s7-300, toolchain: step7-v5, cpu: 315-2DP}
drives: {d: {device: sinamics-dcm, address: 256}}
jobs: {j: {drive: d, read: [P50303]}}
"""


def test_check_and_generate_estimate_the_same_bytes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What ``check`` estimates from texts in memory is what lies in the folder after ``generate``."""
    spec = tmp_path / "job.yaml"
    spec.write_text(SPEC, encoding="utf-8")
    sizes: list[ProgramSize] = []

    def keep(self: ProgramSize, _place: Span) -> list[object]:
        sizes.append(self)
        return []

    monkeypatch.setattr(ProgramSize, "misfits", keep)
    result = api.generate(spec, tmp_path / "out")
    written = result.size()
    assert written is not None
    assert written.cpu is not None
    assert written.cpu.name == "315-2DP"
    assert [found.estimate.total for found in sizes] == [written.estimate.total]


def test_nothing_written_has_no_size(tmp_path: Path) -> None:
    """A spec with an error has no folder to read."""
    spec = tmp_path / "job.yaml"
    spec.write_text(SPEC.replace("P50303", "P70000"), encoding="utf-8")
    assert api.generate(spec, tmp_path / "out").size() is None
