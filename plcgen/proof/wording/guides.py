"""IMPORT.md and xml/IMPORT.md line by line: what they must say of this project, and nothing else."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterator, Sequence
from difflib import SequenceMatcher
from functools import cache, partial
from pathlib import Path

from plcgen.project.nouns import Project
from plcgen.proof.folder import Folder, plain, rendered
from plcgen.proof.wording.model import GuideLine, Wording
from plcgen.s7.types.blocks import BlockKind

SCRIPT, WORKBOOK = "the script was not run against a TIA Portal", "the workbook was not imported into a TIA Portal"
WATCH = "watch tables follow the Openness manual; no genuine export was available to compare with"
VERSION = "no genuine export of this TIA Portal version was available to compare with"
EARLY, INFERRED = ("V14 SP1", "V15", "V15.1"), ("V14 SP1", "V15", "V15.1", "V20")
"""Versions of which no genuine document was at hand: not at all, or none with a code block."""
GUIDE, DOCUMENTS = "IMPORT.md", "xml/IMPORT.md"
_RULE = re.compile(r"\|(?:-+:?\|)+|```\w*|")
_BAR = re.compile(r"(?<!\\)\|")
_STEP = re.compile(r"\d+\. `+ ?(?P<path>[^`]+?) ?`+")
_CALL = re.compile(r'^[ \t]*(?P<called>"[^"\n]+"(?:\."[^"\n]+")?)\((?P<end>\);)?', re.MULTILINE)
CULTURES = {"en": "en-US", "de": "de-DE", "zh": "zh-CN", "fr": "fr-FR", "it": "it-IT", "es": "es-ES"}
"""What the TIA Portal calls a language of which a spec says only the first part."""


def cultures(project: Project) -> tuple[str, ...]:
    """Languages of the spec, as the TIA Portal writes them."""
    return tuple(dict.fromkeys(CULTURES.get(language, language) for language in project.languages))


def check_guide(project: Project, folder: Path, stated: Sequence[Wording], text: str) -> Iterator[tuple[int, str]]:
    """The import guide; that its order compiles is looked at elsewhere."""
    parts = [one.guide() for one in stated]
    watch = "watch_v5" if project.target.v5 else "watch_xml" if project.target.xml_version else "watch_plain"
    wanted = [
        GuideLine(f"# {project.name}: how to import"),
        *map(GuideLine, _steps(project, folder, stated)),
        GuideLine(
            "A PLC has one spec: the files of a second one would replace blocks of the same name or number. "
            "plcgen compares the specs of a folder. "
            f"Generated for {project.target.toolchain}. These files belong to you."
        ),
        *map(GuideLine, (*_said("reloaded"), *_said(watch), *_foreign(project), *_flags(project))),
        *(line for before, _ in parts for line in before),
    ]
    behind = [line for _, after in parts for line in after]
    lines = text.split("\n")
    if project.loaded.spec.plc.sources == "one":
        yield from differences([*wanted, *behind], lines, 0)
        return
    wanted.append(GuideLine("## Order"))
    start = next((at for at, line in enumerate(lines) if line == "## Order"), len(lines)) + 1
    end = next((at for at in range(start, len(lines)) if lines[at] and not _STEP.fullmatch(lines[at])), len(lines))
    yield from differences(wanted, lines[:start], 0)
    yield from _order(folder, lines[start:end], start)
    yield from differences(behind, lines[end:], end)


def _order(folder: Path, lines: Sequence[str], start: int) -> Iterator[tuple[int, str]]:
    count = 0
    for at, line in enumerate(lines, start + 1):
        found = _STEP.fullmatch(line)
        if found is not None:
            count += 1
            if not line.startswith(f"{count}. "):
                yield at, f"{line} is number {count}"
            if not (folder / found["path"]).is_file():
                yield at, f"there is no {found['path']}"


def _steps(project: Project, folder: Path, stated: Sequence[Wording]) -> Iterator[str]:
    """What is done in which order, with the files that there are."""
    form = project.loaded.spec.plc.sources
    source = next((path.name for path in sorted(folder.glob("*.scl"))), "")
    calls = ", ".join(f"`{call}`" for call in _calls(folder))
    if project.target.v5:
        blocks = "".join(f"{name}, " for one in stated for name in one.system_blocks)
        yield from _said(f"v5_{form}", blocks=blocks, source=source, calls=calls)
        return
    steps = [form, f"main_{form}"]
    if (folder / "tags.csv").is_file():
        steps.insert(0, "tags")
    version = project.target.xml_version
    made = sorted(folder.glob("xml/*Tags.xml"))
    table = made[0].name if made else f"{project.prefix}{stated[0].tag_table}.xml"
    for number, step in enumerate([*steps, *(["openness"] if version is not None else [])], 1):
        yield from _said(step, n=number, table=table, version=version, source=source, calls=calls)


def _calls(folder: Path) -> Iterator[str]:
    """The calls that the example has, without their parameters."""
    for path in (folder / "example/Main.scl", folder / "scl/Main.scl"):
        if path.is_file():
            for found in _CALL.finditer(path.read_text("utf-8-sig", "replace")):
                yield f"{found['called']}({'' if found['end'] else '..'});"


def _foreign(project: Project) -> Iterator[str]:
    """Places of the user's own program that the calls name."""
    rows = [
        f"| `{place.text()}` | {'WORD' if signal == 'status' else 'BOOL'} | {job.key} | {signal} |"
        for job in project.jobs
        for signal, place in job.trigger.symbols()
    ]
    yield from (*_said("foreign"), *rows) if rows else ()


def _flags(project: Project) -> Iterator[str]:
    """Bits and words of the flag memory that start jobs and show how they end, as the spec has them."""
    rows = [
        f"| `{str(signals[signal]).removeprefix('%')}` | {job.key} | {signal} |"
        for job in project.jobs
        for signals in [dict(job.trigger.flags())]
        for signal in ("execute", "busy", "done", "error", "status")
        if signal in signals
    ]
    yield from (*_said("flags"), *rows) if rows else ()


def check_documents_guide(
    project: Project, folder: Folder, stated: Sequence[Wording], text: str
) -> Iterator[tuple[int, str]]:
    """The page about the SimaticML documents: version, steps of the script, languages, what is experimental."""
    version, script = project.target.xml_version or "", project.target.t15
    lines = text.split("\n")
    said = [line for line in lines if re.match(r"\d+\. [a-z ]+: `", line)]
    steps = _listed_steps(folder.path) if script else said
    words = {
        "project": project.name,
        "version": version,
        "languages": ", ".join(f"`{name}`" for name in cultures(project)),
    }
    parts = ("documents", "script" if script else "no_script")
    faults = [line for part in ("faults", f"faults_{parts[1]}", "faults_end") for line in _said(part, **words)]
    front = [*(line for part in parts for line in _said(part, **words)), "## Order", *steps, *faults]
    yield from differences([*map(GuideLine, front), *_experimental(project, folder, stated)], lines, 0)
    titles = [line.partition(". ")[2].partition(":")[0] for line in steps]
    if titles != [title for title in _texts()["titles"] if title in titles] or len(titles) != len(set(titles)):
        yield 1, f"the steps are called {', '.join(titles)}"
    if not script:
        yield from _complete(folder.path, said)


def _said(part: str, **words: object) -> list[str]:
    """Lines of a part of a guide."""
    return [line.format(**words) for line in _texts()[part]]


@cache
def _texts() -> dict[str, list[str]]:
    return tomllib.loads((Path(__file__).parent / "guides.toml").read_text("utf-8"))


def _listed_steps(folder: Path) -> list[str]:
    """The steps of the script, as the page lists them."""
    try:
        steps = json.loads((folder / "xml/import.json").read_text("utf-8"))["steps"]
        return [
            f"{number}. {step['title']}: {', '.join(f'`{name}`' for name in step['files'])}"
            for number, step in enumerate(steps, 1)
        ]
    except (OSError, ValueError, KeyError, TypeError):
        return []  # told where the script is looked at


def _complete(folder: Path, said: Sequence[str]) -> Iterator[tuple[int, str]]:
    listed = [name for line in said for name in re.findall(r"`([^`]+)`", line)]
    found = {path.name for path in folder.glob("xml/*.xml")}
    for name in sorted({*listed} ^ found):
        yield 1, f"{name} {'does not exist' if name in listed else 'is not listed'}"


def _experimental(project: Project, folder: Folder, stated: Sequence[Wording]) -> Iterator[GuideLine]:
    """Documents that are experimental, by why they are; of an early version, "all other documents" are."""
    by_note: dict[str, set[str]] = {note: set() for note in (*(one.note for one in stated), WATCH, VERSION)}
    for name in sorted(path.name for path in folder.path.glob("xml/*.xml")):
        if note := unproven(project, folder, stated, f"xml/{name}"):
            by_note[note].add(name)
    if any(by_note.values()):
        yield from map(GuideLine, _said("experimental"))
    for note, names in by_note.items():
        if names:
            rest = note == VERSION and project.target.xml_version in EARLY
            accepts = partial(_says, {"all other documents"} if rest else names, note)
            yield GuideLine(f"- {', '.join(f'`{name}`' for name in sorted(names))}: {note}", accepts)


def unproven(project: Project, folder: Folder, stated: Sequence[Wording], path: str) -> str:
    """Why a file is experimental, "" if it is not."""
    if path in {"tags.xlsx", "xml/import.ps1"}:
        return WORKBOOK if path == "tags.xlsx" else SCRIPT
    name, version = path.removeprefix("xml/").removesuffix(".xml"), project.target.xml_version
    if not path.endswith(".xml"):
        return ""
    if name.startswith("Watch_"):
        return WATCH
    block = folder.text.get(name.upper())
    if block is not None and block.kind is BlockKind.FB:
        return next((one.note for one in stated if one.title(block) is not None), "")
    made = block is not None and (block.kind is BlockKind.OB or bool(block.instance_of))
    return VERSION if version in (INFERRED if made else EARLY) else ""


def _says(names: set[str], note: str, text: str) -> bool:
    front, _, said = text.partition(": ")
    return text.startswith("- ") and said == note and set(re.findall(r"`([^`]+)`", front)) == names


def check_line_ends(text: str) -> Iterator[tuple[int, str]]:
    """``.gitattributes``: git must not change the ends of lines, for hashes and importers read bytes."""
    if [line for line in text.split("\n") if line and not line.startswith("#")] != ["* -text"]:
        yield 1, 'it does not say "* -text", and nothing else'


def broken_tables(text: str) -> Iterator[tuple[int, str]]:
    """Tables that nobody sees as such: the rule stands in the second line and nowhere else, all rows are as wide."""
    width, row = 0, 0
    for number, line in enumerate(text.split("\n"), 1):
        cells = len(_BAR.findall(line)) if line.startswith("|") else 0
        row = row + 1 if cells else 0
        width = cells if row == 1 else width
        if cells and ((_RULE.fullmatch(line) is not None) != (row == 2) or cells != width):
            yield number, f'"{line}" is no row {row} of a table with {width - 1} columns'


def differences(wanted: Sequence[GuideLine], lines: Sequence[str], start: int) -> Iterator[tuple[int, str]]:
    """Lines that nobody states, and what is missing; blank lines and rules of tables do not count."""
    found = [(number, line) for number, line in enumerate(lines, start + 1) if not _RULE.fullmatch(line.strip())]
    texts = {plain(one.text): one.text for one in wanted}
    others = [one for one in wanted if one.accepts is not None]
    said = []
    for _, line in found:
        text = rendered(line)
        if text not in texts:
            text = next((plain(one.text) for one in others if one.agrees(line)), text)
        said.append(text)
    right = [plain(one.text) for one in wanted]
    for tag, one, two, three, four in SequenceMatcher(None, right, said, autojunk=False).get_opcodes():
        if tag == "equal":
            continue
        missing = [texts[text] for text in right[one:two]]
        place = found[three][0] if three < len(found) else start + len(lines)
        if three == four:
            yield from ((place, f'the line "{text}" is missing') for text in missing)
        for number, line in found[three:four]:
            yield number, f'no source for "{line}"' + (f'; it must say "{missing[0]}"' if missing else "")
