"""Tables around the blocks: watch tables, tags, V5 symbols and compile order, import guide and layout sheet."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from plcgen.base.display.table import Row, csv_table
from plcgen.base.display.workbook import workbook_bytes
from plcgen.build.document import Document
from plcgen.build.guides import guide
from plcgen.build.nouns import Call, TagRow, WatchRow
from plcgen.build.one_source import source_path
from plcgen.build.overview import Overview
from plcgen.build.sources import SourceWriter
from plcgen.build.spelling import encodable
from plcgen.build.voice import voice_of
from plcgen.project.nouns import Project
from plcgen.s7.read.generated import ATTRIBUTES

_ATTRIBUTES = """\
# Written by plcgen: git leaves the line ends of these files as they are, whatever core.autocrlf says.
* -text
"""


def watch_document(name: str, rows: Sequence[WatchRow]) -> Document:
    """The watch table of a function block as CSV."""
    return _sheet(f"watch/{name}.csv", ("name", "address", "display format", "modify value"), rows)


def table_documents(project: Project, seen: Overview, sources: SourceWriter) -> Iterator[Document]:
    """The STEP 7 V5 symbol table and compile order or the tags, the import guide and the layout sheet."""
    order = _import_order(seen, sources)
    tags = [tag for rows in seen.tags.values() for tag in rows]
    if project.target.v5:
        yield sources.table("symbols.sdf", _symbols(project, seen, tags))
        if not sources.one:
            names = (path.split("/")[1].removesuffix(".scl") for path in order)
            yield sources.table("compile.inp", "".join(f"{name}\n" for name in names))
    elif tags:
        said = [tag._replace(text=voice_of(project).say(tag.text)) for tag in tags]
        yield Document("tags.csv", text=tag_sheet(said), encoding="utf-8-sig")
        yield Document("tags.xlsx", data=tag_workbook(seen.tags), experimental=WORKBOOK_NOTE)
    guides = [contribution.guide() for contribution in seen.contributions]
    view = {
        "project": project.name,
        "v5": project.target.v5,
        "t15": project.target.t15,
        "xml": project.target.xml_version,
        "toolchain": project.target.toolchain,
        "system_blocks": [name for contribution in seen.contributions for name in contribution.system_blocks],
        "tag_table": next(iter(seen.tags), ""),
        "parts": [part for before, _ in guides for part in before],
        "flags": [(str(at), job.key, signal) for job in project.jobs for signal, at in job.trigger.flags()],
        "foreign": list(_foreign(project)),
        "one": source_path(project) if sources.one else "",
        "main": sources.main_path,
        "calls": [_call(call, v5=project.target.v5) for call in seen.calls],
        "order": [*order, sources.main_path],
        "closing": [part for _, behind in guides for part in behind],
    }
    yield guide(project, "IMPORT.md", "text/import.md.j2", view)
    controls = [block.name for contribution in seen.contributions for block in contribution.controls]
    view = {"project": project.name, "controls": controls, "sheets": seen.sheets}
    yield guide(project, "LAYOUT.md", "text/layout.md.j2", view)
    yield Document(ATTRIBUTES, text=_ATTRIBUTES)


def _call(call: Call, *, v5: bool) -> str:
    """A call as it is copied; its parameters are in the example."""
    block = f'"{call.block}".' if v5 else ""
    return f'{block}"{call.instance}"({".." if call.begin or call.inputs or call.outputs else ""});'


def _sheet(path: str, header: Row, rows: Sequence[Row]) -> Document:
    """A table for a spreadsheet: semicolons and a byte order mark, as an Excel with German settings opens them."""
    return Document(path, text=csv_table(header, rows, ";"), encoding="utf-8-sig")


_TAGS = (
    "Name", "Path", "Data Type", "Logical Address", "Comment",
    "Hmi Visible", "Hmi Accessible", "Hmi Writeable", "Typeobject ID", "Version ID",
)  # fmt: skip
WORKBOOK_NOTE = "the workbook was not imported into a TIA Portal"


def tag_sheet(tags: Sequence[TagRow]) -> str:
    """Tags as CSV."""
    rows = [(tag.name, tag.type, f"%{tag.address}", tag.text) for tag in tags]
    return csv_table(("Name", "Data Type", "Logical Address", "Comment"), rows, ";")


def tag_workbook(tables: Mapping[str, Sequence[TagRow]]) -> bytes:
    """The tags by table as the editor of the TIA Portal exports and imports them.

    Sheet, columns and cells are those of public exports (github.com/AoufNihed/PLC, github.com/Canabis220/Robot), which
    all carry the property TIA_Version: the help of the TIA Portal says that an import without it fails.
    """
    rows = [
        (tag.name, table, tag.type, f"%{tag.address}", tag.text, "True", "True", "True", "", "")
        for table, tags in tables.items()
        for tag in tags
    ]
    return workbook_bytes({"PLC Tags": [_TAGS, *rows]}, {"TIA_Version": "1.0"})


def _foreign(project: Project) -> Iterator[tuple[str, str, str, str]]:
    """What of the user's program is named: symbol, type, job, what it is for."""
    for job in project.jobs:
        for signal, symbol in job.trigger.symbols():
            yield symbol.text(), "WORD" if signal == "status" else "BOOL", job.key, signal


def _import_order(seen: Overview, sources: SourceWriter) -> list[str]:
    """Source files in the order a compiler wants them: types, data, function blocks, their instances."""
    groups = (
        ("udt", seen.types),
        ("db", seen.data),
        ("scl", seen.programs),
        ("db", [call.instance for call in seen.calls]),
    )
    return [sources.path(folder, name) for folder, names in groups for name in names]


def _symbols(project: Project, seen: Overview, tags: Sequence[TagRow]) -> str:
    rows: list[Sequence[str]] = [symbol for contribution in seen.contributions for symbol in contribution.symbols]
    for block in project.blocks:
        address = f"{block.kind} {block.number}"
        rows.append((block.name, address, seen.symbols.get(block, address), ""))
    for tag in tags:
        area = tag.address.rstrip("0123456789.")
        said = voice_of(project).say(tag.text)
        text = said if encodable(said, project.target) else ""
        rows.append((tag.name, f"{area} {tag.address[len(area) :]}", tag.type.upper(), text[:80]))
    return "".join(map(_symbol_row, rows))


def _symbol_row(row: Sequence[str]) -> str:
    """A line of a symbol table: name, address, type and comment in quotes, in columns of 24, 12, 10 and 80.

    So are the 59 lines of SYMBOL.SDF, which STEP 7 brings along (public copy: github.com/ivangre4/PLC_Programms). A
    number ends in column 9; for a bit the point is in column 10, as in exports of the same table as ASC.
    """
    name, address, type_, comment = row
    cells = (name.ljust(24), _in_columns(address).ljust(12), _in_columns(type_).ljust(10), comment.ljust(80))
    return ",".join(f'"{cell}"' for cell in (cell.replace('"', "'") for cell in cells)) + "\n"


def _in_columns(text: str) -> str:
    """``UDT 470`` with its number where a symbol table has it; an elementary type as it is."""
    area, blank, number = text.partition(" ")
    if not blank:
        return text
    byte, point, bit = number.partition(".")
    return f"{area}{byte:>{9 - len(area)}}{point}{bit}"
