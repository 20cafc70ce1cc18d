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
