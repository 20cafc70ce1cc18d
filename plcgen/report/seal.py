"""How a result in a file is known as one that nobody changed since it was written: the next one may replace it.

The last line of a format that has comments is a hash over those above it; JSON says at its beginning who wrote it.
"""

from __future__ import annotations

import re

from plcgen.base.files.hashes import text_digest

_SEAL = re.compile(rb"\bplcgen result, sha256 ([0-9a-f]{64})\b")
_JSON = re.compile(
    rb'\{\s*"(tool": "plcgen"|\$schema": "[^"]*",\s*"(\$id": "urn:plcgen:|'
    rb'version": "[0-9.]*",\s*"runs": \[\s*\{\s*"tool": \{\s*"driver": \{\s*"name": "plcgen"))'
)
"""How our results begin, our schemas, and our SARIF."""


def sealed(text: str, comment: tuple[str, str]) -> str:
    """The text with a last line that nobody else could have written; ``comment`` stands around a remark."""
    body = text if not text or text.endswith("\n") else f"{text}\n"
    begin, end = comment
    return f"{body}{begin}plcgen result, sha256 {text_digest(body.encode('utf-8', 'replace'))}{end}\n"


def has_seal(data: bytes) -> bool:
    """Whether the last line of a file says that it is a result, changed since or not."""
    return _SEAL.search(data[_last_line(data) :]) is not None


def is_result(data: bytes) -> bool:
    """Whether a file is a result that nobody changed since, or empty."""
    if not data or _JSON.match(data):
        return True
    at = _last_line(data)
    found = _SEAL.search(data[at:])
    return found is not None and text_digest(data[:at]).encode() == found[1]


def _last_line(data: bytes) -> int:
    """Where the last line begins that is not empty."""
    return data.rstrip(b"\r\n").rfind(b"\n") + 1
