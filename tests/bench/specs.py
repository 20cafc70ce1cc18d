"""Specs of any size for the benchmarks."""

from __future__ import annotations

HEAD = """plc: {name: Bench, family: s7-1500, toolchain: tia-v19, numbers: {db: 1}}
drives:
"""


MOST_UNITS = 500
"""A CPU has 512 places for units."""


def many_jobs(count: int) -> str:
    """A spec of ``count`` jobs on ``count / 10`` drives, 500 at most: reads, constant writes and inputs in turn."""
    drives = min(max(1, count // 10), MOST_UNITS)
    lines = [HEAD]
    lines += [
        f"  axis_{i}: {{device: sinamics-s120, hardware_id: {256 + i}, drive_object: 3}}\n" for i in range(drives)
    ]
    lines.append("jobs:\n")
    for i in range(count):
        drive = f"axis_{i % drives}"
        kind = i % 3
        if kind == 0:
            lines.append(f"  read_{i}: {{drive: {drive}, read: [P1120, P1121, r21]}}\n")
        elif kind == 1:
            lines.append(f"  write_{i}: {{drive: {drive}, write: {{P1120: 5.0}}}}\n")
        else:
            lines.append(f"  set_{i}: {{drive: {drive}, write: {{P1120: null, P1121: null}}}}\n")
    return "".join(lines)


def hundred_lines() -> str:
    """A spec of 100 lines, written the long way."""
    lines = [
        "plc:", "  name: Bench", "  family: s7-1500", "  toolchain: tia-v19", "drives:",
        "  axis:", "    device: sinamics-s120", "    hardware_id: 256", "    drive_object: 3", "jobs:",
    ]  # fmt: skip
    number = 0
    while len(lines) + 5 <= 100:
        lines += [f"  job_{number}:", "    drive: axis", "    read:", "      - P1120", f"      - p945[{number}]"]
        number += 1
    return "\n".join(lines).replace("p945", "r945") + "\n"


PLCS = {
    "S7-300 V5": ("s7-300", "step7-v5", "address"),
    "S7-1200": ("s7-1200", "tia-v19", "hardware_id"),
    "S7-1500": ("s7-1500", "tia-v19", "hardware_id"),
}
"""PLCs of the plants: family, toolchain, what a drive is addressed with."""


def plant(drives: int = 20, plc: str = "S7-300 V5") -> str:
    """A spec of three jobs, each on every drive."""
    every = ", ".join(fans(drives))
    return "".join(
        (
            *_head(drives, plc),
            f"  read_ramps: {{drive: [{every}], read: [P1120, P1121]}}\n",
            f"  set_ramps: {{drive: [{every}], write: {{P1120: null, P1121: null}}}}\n",
            f"  read_fault: {{drive: [{every}], read: [r947]}}\n",
        )
    )


def shapes(count: int, drives: int, plc: str = "S7-1500") -> str:
    """A spec of ``count`` different jobs, each on every one of ``drives``; on one drive they are spread over ten."""
    places = max(drives, 10)
    lines = list(_head(places, plc))
    for i in range(count):
        where = ", ".join(fans(places)) if drives > 1 else fans(places)[i % places]
        indexes = ", ".join(f'"r945[{index}]"' for index in range(i % 20 + 1))
        what = f"read: [P1120, {indexes}]" if i % 2 else f"write: {{P1120: null, P1121: {i + 1}.0}}"
        lines.append(f"  job_{i}: {{drive: [{where}], {what}}}\n")
    return "".join(lines)


PLACES_OF_A_UNIT = 50
"""Jobs of a drive in the plants of many jobs; a unit has 64 places."""


def grid(count: int, drives: int, plc: str = "S7-1500") -> str:
    """A spec of ``count`` different jobs, each on so many drives: groups of 50 jobs have drives of their own."""
    names = fans(drives * -(-count // PLACES_OF_A_UNIT))
    lines = list(_head(len(names), plc))
    for i in range(count):
        first = i // PLACES_OF_A_UNIT * drives
        indexes = ", ".join(f'"r945[{index}]"' for index in range(i % 20 + 1))
        what = f"read: [P1120, {indexes}]" if i % 2 else f"write: {{P1120: null, P1121: {i + 1}.0}}"
        lines.append(f"  job_{i}: {{drive: [{', '.join(names[first : first + drives])}], {what}}}\n")
    return "".join(lines)


def fans(drives: int) -> list[str]:
    """Names of drives."""
    return [f"fan{i:02}" for i in range(1, drives + 1)]


def _head(drives: int, plc: str) -> list[str]:
    family, toolchain, place = PLCS[plc]
    rows = [f"  {name}: {{device: sinamics-g120, {place}: {276 + 20 * i}}}\n" for i, name in enumerate(fans(drives))]
    return [f"plc: {{name: Plant, family: {family}, toolchain: {toolchain}}}\n", "drives:\n", *rows, "jobs:\n"]
