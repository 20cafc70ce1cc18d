"""Text for people, JSON for programs, VCD for wave viewers: read back and compared with the run."""

from __future__ import annotations

import json
import math
import re
import struct
from collections.abc import Callable
from dataclasses import replace

import pytest

from plcgen.base.display.view import View
from plcgen.report.registry import output_format
from plcgen.report.trace.model import Signal, Step, Trace

Run = Callable[..., Trace]


def show(format_: str, trace: Trace, **looks: int) -> str:
    """A run in a format."""
    return output_format(format_).render("trace", trace, View(**looks))


class Vcd:
    """A reader of value change dumps, written from IEEE 1364 and GTKWave's manual, not from our writer."""

    def __init__(self, text: str) -> None:
        head, body = text.split("$enddefinitions $end\n")
        self.timescale = re.search(r"\$timescale\s+(.+?)\s+\$end", head).group(1)
        self.types: dict[str, str] = {}
        self.changes: dict[str, list[tuple[int, object]]] = {}
        self.names: dict[str, str] = {}
        scopes: list[str] = []
        for words in (line.split() for line in head.splitlines()):
            if words[0] == "$scope":
                scopes.append(words[2])
            elif words[0] == "$upscope":
                scopes.pop()
            elif words[0] == "$var":
                _, kind, width, code, name, end = words
                assert end == "$end"
                assert code not in self.names, "an identifier stands for one variable"
                self.names[code] = ".".join([*scopes[1:], name])
                self.types[self.names[code]] = f"{kind} {width}"
        assert not scopes
        self._read(body)

    def _read(self, body: str) -> None:
        time = -1
        for line in body.splitlines():
            if line.startswith("#"):
                assert int(line[1:]) > time, "time only goes forward"
                time = int(line[1:])
            elif not line.startswith("$"):
                code, value = self._value(line)
                self.changes.setdefault(self.names[code], []).append((time, value))

    @staticmethod
    def _value(line: str) -> tuple[str, object]:
        if line[0] in "01":
            return line[1:], int(line[0])
        value, code = line.split(" ")
        kind = {"b": lambda text: int(text, 2), "r": float, "s": str}[value[0]]
        return code, kind(value[1:])


def test_vcd_is_the_run(run: Run) -> None:
    """Every variable has its type, its start value at 0 and its changes at the milliseconds of the scans."""
    vcd = Vcd(show("vcd", run(jobs=["read_ramp_up"])))
    assert vcd.timescale == "1 ms"
    assert vcd.types["read_ramp_up.rampUpTime1"] == "real 64"
    assert vcd.types["read_ramp_up.WRREC_BUSY"] == "wire 1"
    assert vcd.types["read_ramp_up.WRREC_STATUS"] == "wire 32"
    assert vcd.types["read_ramp_up.state"] == "integer 16"
    assert vcd.types["read_ramp_up.state_name"] == "string 1"
    assert vcd.changes["read_ramp_up.rampUpTime1"] == [(0, 0.0), (80, 10.0)]
    assert vcd.changes["read_ramp_up.WRREC_BUSY"] == [(0, 0), (20, 1), (40, 0)]
    assert vcd.changes["read_ramp_up.state"] == [(0, 0), (10, 1), (20, 4), (40, 5), (70, 1), (80, 0)]
    names = [name for _, name in vcd.changes["read_ramp_up.state_name"]]
    assert names == ["IDLE", "HOLD", "WRITE", "READ", "HOLD", "IDLE"]
    assert vcd.changes["read_ramp_up.status"] == [(0, 0x7000), (10, 0x7001), (20, 0x7002), (80, 0)]
    assert vcd.changes["dcm.request"] == [(0, "-"), (40, "010102011001C47F0000")]
    assert vcd.changes["dcm.response"] == [(0, "-"), (70, "01010201080141200000")]
    assert all(changes[0][0] == 0 for changes in vcd.changes.values())


def test_vcd_of_every_kind_of_value() -> None:
    """Negative numbers, arrays, texts with blanks, clashing names, more variables than one character names."""
    signals = (
        Signal("a b", "x.y", "integer", 16),
        Signal("a b", "x_y", "real", 64),
        Signal("a b", "list", "word", 8),
        Signal("a b", "text", "text"),
        *(Signal("many", f"v{n}", "bool", 1) for n in range(200)),
    )
    start = (0, 0.0, [1, 2], "", *(False for _ in range(200)))
    steps = (Step(1, 10, ((0, -2), (1, math.inf), (2, [255, 0]), (3, "two words"), (203, True)), (), ()),)
    trace = Trace("s", "f", "Press 4", scans=3, time=30, signals=signals, start=start, steps=steps)
    vcd = Vcd(show("vcd", trace))
    assert vcd.changes["a_b.x_y"] == [(0, 0), (10, 0xFFFE)]
    assert vcd.changes["a_b.x_y_2"] == [(0, 0.0), (10, math.inf)]
    assert (vcd.changes["a_b.list_0"], vcd.changes["a_b.list_1"]) == ([(0, 1), (10, 255)], [(0, 2), (10, 0)])
    assert vcd.changes["a_b.text"] == [(0, "-"), (10, "two_words")]
    assert vcd.changes["many.v199"] == [(0, 0), (10, 1)]
    assert len(vcd.names) == 205


def test_vcd_ends_with_the_run(run: Run) -> None:
    """The time after the last change is part of the picture."""
    text = show("vcd", run(jobs=["read_ramp_up"], faults=["silence"], scans=20))
    assert text.endswith("\n#200\n")


def test_vcd_has_no_date(run: Run) -> None:
    """The same run gives the same bytes."""
    first, second = show("vcd", run()), show("vcd", run())
    assert first == second
    assert "$date" not in first


def test_json(run: Run) -> None:
    """One document: signals with their start values, changes by id, telegrams field by field, results."""
    data = json.loads(show("json", run(jobs=["read_ramp_up"], faults=["busy"])))
    assert (data["kind"], data["ok"], data["ended"], data["main"]) == ("trace", True, "jobs", "Main")
    ids = [signal["id"] for signal in data["signals"]]
    assert len(ids) == len(set(ids))
    assert data["steps"][0]["changes"]["read_ramp_up.state"] == 1
    assert set().union(*(step["changes"] for step in data["steps"])) <= set(ids)
    write, refused, read = (found for step in data["steps"] for found in step["exchanges"])
    assert write["telegram"]["hex"] == "010102011001C47F0000"
    assert (refused["status"], refused["telegram"]) == ("DE80B500", None)
    value = next(f for f in read["telegram"]["fields"] if f["name"].endswith(" value"))
    assert (value["name"], value["value"]) == ("parameter 1 (P50303) value", "10.0")
    (job,) = data["jobs"]
    assert (job["ending"], job["status"], job["retries"], job["values"][0]["value"]) == ("done", "0000", 1, 10.0)


def test_json_holds_no_number_that_json_lacks(run: Run) -> None:
    """NaN and infinity are texts."""
    trace = run(jobs=["read_ramp_up"])
    broken = replace(trace, steps=(Step(1, 10, ((0, math.nan), (1, [math.inf])), (), ()),))
    changes = json.loads(show("json", broken))["steps"][0]["changes"]
    assert list(changes.values()) == ["nan", ["inf"]]


GOLDEN = """\
S7-300_6RA80_DP_TIA, s7-300 / tia-v16: FOLDER
OB "Main" every 10 ms

scan  ms  job           state  record call          drive  job status
   1  10  read_ramp_up  HOLD                        dcm    busy 7001
   2  20  read_ramp_up  WRITE  WRREC REQ BUSY 7001  dcm    busy 7002
   3  30  read_ramp_up  WRITE  WRREC BUSY 7002      dcm    busy 7002
   4  40  read_ramp_up  READ   WRREC DONE           dcm    busy 7002
      -> dcm: 01 01 02 01 10 01 C4 7F 00 00   reference 1, object 2, read P50303
   5  50  read_ramp_up  READ   RDREC REQ BUSY 7001  dcm    busy 7002
   6  60  read_ramp_up  READ   RDREC BUSY 7002      dcm    busy 7002
   7  70  read_ramp_up  HOLD   RDREC VALID 10 B     dcm    busy 7002
      <- dcm: 01 01 02 01 08 01 41 20 00 00   reference 1, P50303 = 10.0
   8  80  read_ramp_up  IDLE                               done 0000
      rampUpTime1 = 10.0 s

read_ramp_up: done 0000 job done, no error
  8 scans, 80 ms, 1 telegram, no retry
  P50303  rampUpTime1 = 10.0 s

1 job: 1 done; 8 scans, 80 ms
"""


def test_text(run: Run) -> None:
    """The table as a PLC engineer sees it."""
    trace = run(jobs=["read_ramp_up"])
    assert show("text", trace).replace(trace.folder, "FOLDER") == GOLDEN


@pytest.mark.parametrize("width", [40, 80, 120])
def test_text_fits_the_screen(run: Run, width: int) -> None:
    """No row of the table is wider than the screen, with long names and messages too."""
    trace = run(faults=["busy:times=2", "error:number=2,after=1"])
    lines = show("text", trace, width=width).split("\n\n")[1].splitlines()
    assert len(lines) > 30
    if width >= 80:
        assert max(map(len, lines)) <= width
        assert sum(" write_ramp_down " in line for line in lines) > 8
    assert (" drive " in lines[0]) == (width == 120)


def test_an_explanation_is_given_once(run: Run) -> None:
    """The third B5h in a row is no news."""
    text = show("text", run(jobs=["read_ramp_up"], faults=["busy:times=3"]), width=120)
    assert text.count("RDREC ERROR DE80B500") == 3
    assert text.count("state conflict") == 1


def test_text_of_a_failed_job(run: Run) -> None:
    """The drive's error stands at the parameter, the status word is explained."""
    text = show("text", run(jobs=["read_ramp_up"], faults=["error:number=17"]), width=120)
    assert "read_ramp_up: error 8401 the drive refused at least one parameter, see errors" in text
    assert "  P50303  rampUpTime1 error 11h " in text
    assert text.endswith("1 job: 1 error; 8 scans, 80 ms\n")


def test_value_is_what_the_bytes_mean() -> None:
    """41200000h is 10.0, so the golden answer is the value of the catalogue."""
    assert struct.unpack(">f", bytes.fromhex("41200000")) == (10.0,)
