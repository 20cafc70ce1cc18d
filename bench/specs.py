"""Specs of any size for the benchmarks."""

from __future__ import annotations

HEAD = """plc: {name: Bench, family: s7-1500, toolchain: tia-v19, numbers: {db: 1}}
drives:
"""


def many_jobs(count: int) -> str:
    """A spec of ``count`` jobs on ``count / 10`` drives: reads, constant writes and block inputs in turn."""
    drives = max(1, count // 10)
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


def plant(drives: int = 20) -> str:
    """A spec of an S7-300 with STEP 7 V5: three jobs, each on every drive."""
    names = [f"fan{i:02}" for i in range(1, drives + 1)]
    lines = ["plc: {name: Plant, family: s7-300, toolchain: step7-v5}\n", "drives:\n"]
    lines += [f"  {name}: {{device: sinamics-g120, address: {256 + 20 * i}}}\n" for i, name in enumerate(names, 1)]
    every = f"drive: [{', '.join(names)}]"
    lines.append("jobs:\n")
    lines.append(f"  read_ramps: {{{every}, read: [P1120, P1121]}}\n")
    lines.append(f"  set_ramps: {{{every}, write: {{P1120: null, P1121: null}}}}\n")
    lines.append(f"  read_fault: {{{every}, read: [r947]}}\n")
    return "".join(lines)
