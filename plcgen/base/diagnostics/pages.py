"""The documentation pages of the codes: ``python -m plcgen.base.diagnostics.pages docs/codes`` writes them."""

from __future__ import annotations

import sys
from pathlib import Path

from plcgen.base.diagnostics.codes import AREAS, CodeInfo, all_codes, code

INDEX = "README.md"


def page(info: CodeInfo) -> str:
    """Markdown page of one code."""
    return "\n".join(
        [
            f"# {info.code}: {info.title}",
            "",
            f"Severity: {info.levels}. Area: {AREAS[info.code[2]].lower()}. [All codes]({INDEX})",
            "",
            "## Why",
            "",
            info.why,
            "",
            "## How to fix it",
            "",
            info.fix,
            "",
            "## Example",
            "",
            "Reported:",
            "",
            f"```{info.language}",
            info.bad,
            "```",
            "",
            "Accepted:",
            "",
            f"```{info.language}",
            info.good,
            "```",
            "",
        ]
    )


def index() -> str:
    """Markdown index of all codes, by area."""
    lines = ["# Codes", "", "Every message of plcgen has a code. `plcgen explain PG303` prints its page.", ""]
    for digit, area in AREAS.items():
        lines += [f"## {area}", "", "| code | meaning | severity |", "|---|---|---|"]
        lines += [
            f"| [{info.code}]({info.page}) | {info.title} | {info.levels} |"
            for info in map(code, all_codes())
            if info.code[2] == digit
        ]
        lines.append("")
    return "\n".join(lines)


def pages() -> dict[str, str]:
    """Every page by file name, the index included."""
    return {INDEX: index()} | {info.page: page(info) for info in map(code, all_codes())}


def write_pages(folder: Path) -> None:
    """Write all pages; pages of codes that no longer exist are removed."""
    folder.mkdir(parents=True, exist_ok=True)
    wanted = pages()
    for stale in folder.glob("PG*.md"):
        if stale.name not in wanted:
            stale.unlink()
    for name, text in wanted.items():
        (folder / name).write_text(text, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    write_pages(Path(sys.argv[1] if len(sys.argv) > 1 else "docs/codes"))
