"""Every engine there is, generated: three targets, four sizes. ``make engine`` writes them."""

import sys
from collections.abc import Iterator
from pathlib import Path

import plcgen

TARGETS = {"t15": ("s7-1500", "tia-v19"), "t3": ("s7-300", "tia-v19"), "v5": ("s7-300", "step7-v5")}
SIZES = {"S": (1, 1), "M": (1, 8), "L": (33, 1), "XL": (1, 17)}
"""Drives and jobs of each: more than 4 jobs of a unit need M, more than 32 units L, more than 16 jobs of a unit XL."""


def spec(target: str, size: str) -> str:
    """A project that needs an engine of this size."""
    family, toolchain = TARGETS[target]
    drives, jobs = SIZES[size]
    place = "hardware_id: {}" if target == "t15" else "address: {}"
    lines = [f"plc: {{name: Engine, family: {family}, toolchain: {toolchain}}}", "drives:"]
    lines += [f"  fan{n}: {{device: sinamics-g120, {place.format(256 + 4 * n)}}}" for n in range(drives)]
    names = ", ".join(f"fan{n}" for n in range(drives))
    lines += ["jobs:", *(f"  read{n}: {{drive: [{names}], read: [P{1120 + n % 2}]}}" for n in range(jobs))]
    return "\n".join(lines) + "\n"


def folders(root: Path) -> Iterator[tuple[str, str, Path]]:
    """Target, size and folder of every engine."""
    for target in TARGETS:
        for size in SIZES:
            file, out = root / f"{target}_{size}.yaml", root / f"{target}_{size}"
            file.write_text(spec(target, size), encoding="ascii")
            plcgen.generate(file, out)
            yield target, size, out


if __name__ == "__main__":
    for _, _, folder in folders(Path(sys.argv[1])):
        print(folder)  # noqa: T201
