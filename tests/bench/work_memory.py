"""Size of a plant of 20 drives with 3 jobs each on an S7-300: now, and as recorded earlier (``data/work_memory.json``).

The estimator and its rules are older than the first record; all records are by the same rules.
``python -m tests.bench.work_memory FOLDER`` prints the figures of any folder of STEP 7 V5 sources.
"""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path

from tests.bench.specs import plant

RECORDS = Path(__file__).parent / "data" / "work_memory.json"


def sizes(folder: Path) -> dict[str, int]:
    """Figures of a folder of sources: lines, blocks, bytes."""
    from plcgen.s7.memory.estimate import estimate
    from plcgen.s7.scl.dialect import Dialect

    found = estimate(folder, Dialect.STEP7_V5)
    blocks = [block for block in found.blocks if block.kind == "FB"]
    databases = [block.number or 0 for block in found.blocks if block.kind == "DB"]
    return {
        "fb_lines": sum(block.lines for block in blocks),
        "fb_code_lines": sum(block.code_lines for block in blocks),
        "fbs": len(blocks),
        "dbs": len(databases),
        "highest_db": max(databases, default=0),
        "code_bytes": found.code,
        "data_bytes": found.data,
        "total_bytes": found.total,
    }


def generated() -> dict[str, int]:
    """Figures of the plant as it is generated now."""
    from plcgen import api

    with tempfile.TemporaryDirectory() as folder:
        spec = Path(folder) / "plant.yaml"
        spec.write_text(plant(), encoding="utf-8")
        api.generate(spec, Path(folder) / "out")
        return sizes(Path(folder) / "out")


def main() -> None:
    """Print the recorded figures and those of now."""
    print("20 drives x 3 jobs on an S7-300, STEP 7 V5, estimated by docs/memory.md")
    rows = [(f"{record['what']} ({record['commit']})", record["sizes"]) for record in json.loads(RECORDS.read_text())]
    for name, row in [*rows, ("now", generated())]:
        print(
            f"  {name:<50} {row['fb_lines']:>6} lines of FBs, {row['fbs']:>3} FBs, {row['dbs']:>3} DBs to DB"
            f"{row['highest_db']}, {row['total_bytes']:>7} bytes ({row['code_bytes']} + {row['data_bytes']})"
        )


if __name__ == "__main__":
    if len(sys.argv) > 1:
        print(json.dumps(sizes(Path(sys.argv[1])), indent=2))
    else:
        main()
