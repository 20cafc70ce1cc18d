"""The version of plcgen and the bytes that it generates: other bytes of an example need another version.

``make examples`` ends with ``python -m tests.build.versions``, which gives the next 0.2.0.devN to bytes that are new.
"""

from __future__ import annotations

import hashlib
import json
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RECORD = ROOT / "examples" / "versions.json"
VERSION = ROOT / "plcgen" / "_version.py"
_SAID = re.compile(r'__version__ = "([^"]+)"')


def manifests() -> list[Path]:
    """The manifests of all examples."""
    return sorted((ROOT / "examples").glob("*/**/manifest.json"))


def digest() -> str:
    """SHA-256 over the hash of every file of every example; the manifests themselves name the version."""
    found = hashlib.sha256()
    for path in manifests():
        for entry in json.loads(path.read_text("utf-8"))["files"]:
            found.update(f"{path.relative_to(ROOT).as_posix()} {entry['path']} {entry['sha256']}\n".encode())
    return found.hexdigest()


def stated() -> str:
    """The version in the source."""
    found = _SAID.search(VERSION.read_text("utf-8"))
    assert found is not None
    return found[1]


def record() -> dict[str, str]:
    """Digest by version, in the order in which they came."""
    known: dict[str, str] = json.loads(RECORD.read_text("utf-8"))
    return known


def following(version: str) -> str:
    """The next version of a development: 0.2.0.dev3 -> 0.2.0.dev4, 0.2.0 -> 0.2.1.dev1."""
    base, dot_dev, number = version.partition(".dev")
    if dot_dev:
        return f"{base}.dev{int(number) + 1}"
    front, _, last = base.rpartition(".")
    return f"{front}.{int(last) + 1}.dev1"


def main() -> None:
    """Give these bytes a version, if they have none, and write it down."""
    known, now, version = record(), digest(), stated()
    if known.get(version, now) != now:
        old, version = version, following(version)
        VERSION.write_text(VERSION.read_text("utf-8").replace(f'"{old}"', f'"{version}"'), "utf-8")
        for path in manifests():
            text = path.read_text("utf-8")
            path.write_text(text.replace(f'"generator": "plcgen {old}"', f'"generator": "plcgen {version}"'), "utf-8")
        sys.stdout.write(f"other bytes than {old}: this is {version} now\n")
    known[version] = now
    RECORD.write_text(json.dumps(known, indent=1) + "\n", "utf-8")


if __name__ == "__main__":
    main()
