"""LEAD_LAG, DCAT and MCAT: blocks that control with values in their instance.

Source: help of the TIA Portal V19, pages of SCL of both families; the equation of LEAD_LAG gives its example.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from plcgen.s7.cpu.memory import AREA_L, Memory
from plcgen.s7.layout.image import read_entry, write_member
from plcgen.s7.layout.layout import Layout, locate
from plcgen.s7.layout.shapes import Shape


def lead_lag(values: dict[str, Any], _now: int) -> None:
    """LEAD_LAG."""
    if values["GAIN"] <= 0:
        values["ERR_CODE"] = 9
        return
    span, lead, lag = values["SAMPLE_T"], values["LD_TIME"], values["LG_TIME"]
    ahead = (lead + span) * values["IN"] - lead * values["PREV_IN"]
    out = (lag * values["PREV_OUT"] + values["GAIN"] * ahead) / (lag + span) if lag + span else 0.0
    values.update(OUT=out, PREV_OUT=out, PREV_IN=values["IN"], ERR_CODE=0)


def discrete_alarm(values: dict[str, Any], now: int) -> None:
    """DCAT: Q and the history follow CMD; the time runs until the feedback comes."""
    passed, values["PREV_TIME"] = now - values["PREV_TIME"], now
    command = values["CMD"]
    if command != values["CMD_HIS"]:
        values.update(Q=command, CMD_HIS=command, ET=0, OA=False, CA=False)
        return
    arrived, alarm = ("O_FB", "OA") if command else ("C_FB", "CA")
    if values["O_FB"] and values["C_FB"]:
        values.update(OA=True, CA=True)
    elif values[arrived]:
        values.update({alarm: False, "ET": values["PT"]})
    else:
        elapsed = values["ET"] + passed
        values.update({"ET": min(elapsed, values["PT"]), alarm: elapsed > values["PT"]})


def motor_alarm(values: dict[str, Any], now: int) -> None:
    """MCAT: the table of the help, from its first row to its last."""
    passed, values["PREV_TIME"] = now - values["PREV_TIME"], now
    opening, closing = values["O_HIS"], values["C_HIS"]
    outputs = dict.fromkeys(("OO", "CO", "OA", "CA"), False)
    if (opening and closing) or (values["O_FB"] and values["C_FB"]):
        values.update(outputs, OA=True, CA=True, ET=values["PT"], O_HIS=False, C_HIS=False, Q=False)
    elif values["S_CMD"] or (values["O_CMD"] and values["C_CMD"]):
        values.update(outputs, O_HIS=False, C_HIS=False, Q=True)
    elif values["O_CMD"] and not opening:
        values.update(outputs, OO=True, ET=0, O_HIS=True, C_HIS=False, Q=True)
    elif values["C_CMD"] and not closing:
        values.update(outputs, CO=True, ET=0, O_HIS=False, C_HIS=True, Q=True)
    elif opening or closing:
        run, alarm, arrived = ("OO", "OA", "O_FB") if opening else ("CO", "CA", "C_FB")
        late = values["ET"] >= values["PT"] and not values[arrived]
        elapsed = values["PT"] if late or values[arrived] else values["ET"] + passed
        values.update(outputs, ET=elapsed, Q=not late)
        values[alarm if late else run] = not values[arrived]
    else:
        values.update(outputs, Q=True)


_BODIES: dict[str, Callable[[dict[str, Any], int], None]] = {
    "LEAD_LAG": lead_lag, "DCAT": discrete_alarm, "MCAT": motor_alarm,
}  # fmt: skip


def control(kind: str, shape: Shape, clock: list[int]) -> Callable[[Memory, int], None]:
    """Make what a call runs: the members of the instance go in, and come back changed."""
    layout, body = Layout(shape.bits // 8, shape), _BODIES[kind]
    entries = {name: locate(layout, name) for name in shape.index}

    def run(memory: Memory, offset: int) -> None:
        own = Memory(memory[offset : offset + layout.size], AREA_L)
        values: dict[str, Any] = {name: read_entry(own, entry) for name, entry in entries.items()}
        body(values, clock[0])
        for name, value in values.items():
            write_member(own, layout, name, value)
        memory[offset : offset + layout.size] = own

    return run
