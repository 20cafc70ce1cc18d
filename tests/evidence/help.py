"""Examples in SCL of the help of the TIA Portal, from a copy of it as Markdown: how many are read, which are refused.

Nothing of the text is kept: counts, and the heading of what is refused with the reason. A folder of the copy has files
such as ``SCL (S7-1200, S7-1500).md``.
"""

from __future__ import annotations

import html
import re
from collections.abc import Iterator
from pathlib import Path

from plcgen.base.diagnostics import Severity
from plcgen.s7.scl.parser import parse

_HEADING = re.compile(r"#{3,5} (?:([A-Za-z0-9_]+): )?")
_CODE = re.compile(
    r'["#%(].*(?::=|=>|\(|;|\bTHEN\b|\bDO\b)|//|END_|\b(?:IF|ELSE|ELSIF|CASE|FOR|WHILE|REPEAT|UNTIL|REGION|EXIT|CONTINUE|'
    r"RETURN|GOTO)\b|[A-Za-z_][A-Za-z0-9_]*\s*(?:\(|:=|:)|;|[0-9.,]+\s*:"
)
_OPENS = re.compile(r"\b(?:IF|CASE|FOR|WHILE|REPEAT|REGION)\b")
_CLOSES = re.compile(r"\bEND_(?:IF|CASE|FOR|WHILE|REPEAT|REGION)\b|\bUNTIL\b")
_FORMAL = re.compile(r"<[A-Za-z ]+[0-9]?>|\.\.\.")
"""What stands for operands or statements in a form: such an example is no code."""
_NO_CODE = ("|", "!", ">", "---", "**")


def report(folder: Path, *, save: bool = False) -> Iterator[str]:  # noqa: ARG001 - nothing is saved
    """Lines about the pages of SCL in a folder; none if there are none."""
    for path in sorted(folder.rglob("SCL (S7*.md")):
        found = list(examples(path.read_text(encoding="utf-8")))
        formal = [text for _, text in found if _FORMAL.search(text)]
        refused = [(heading, reason) for heading, text in found for reason in problem(text) if text not in formal]
        yield f"{path.stem}: {len(found)} examples, {len(formal)} of them forms, {len(refused)} refused"
        yield from (f"  {heading}: {reason}" for heading, reason in refused)


def examples(text: str) -> Iterator[tuple[str, str]]:
    """Heading and code of what follows a line ``SCL``, up to the first sentence."""
    heading, depth = "", 0
    code: list[str] | None = None
    for raw in [*text.splitlines(), "## end"]:
        line = html.unescape(raw).replace("`", "").replace("\u200b", "").replace("\\", "").strip()
        title = _HEADING.match(line)
        if code is not None and not title and not line.startswith(("##", *_NO_CODE)):
            over = not code or code[-1].endswith((";", ":")) or code[-1].startswith("END_")
            if not line or _CODE.match(line) or (code and (depth > 0 or not over)):
                code += [line] if line else []
                depth += len(_OPENS.findall(line)) - len(_CLOSES.findall(line))
                continue
        if code:
            yield heading, "\n".join(code)
        code, depth = ([] if line == "SCL" else None), 0
        heading = title[1] or heading if title else heading


def problem(code: str) -> list[str]:
    """Code and message of the first thing in an example that is refused; nothing if it is read."""
    text = f'FUNCTION_BLOCK "Example"\nBEGIN\n{code}\nEND_FUNCTION_BLOCK\n'
    errors = [found for found in parse(text, "help.scl").diagnostics if found.severity is Severity.ERROR]
    return [f"{errors[0].code} {errors[0].message}"] if errors else []
