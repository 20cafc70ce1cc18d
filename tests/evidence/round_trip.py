"""SCL blocks of genuine documents to text and back: the elements of their code, equal but for what is a default."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from plcgen import api
from plcgen.s7.read.plcs import by_plc
from plcgen.s7.xml.reading.xml import child, children, load, local, parse_xml, text
from tests.evidence.signatures import engineering

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

_DEFAULTS = {("Blank", "Num", "1"), ("NewLine", "Num", "1"), ("LineComment", "Inserted", "false")} | {
    ("LineComment", "NoClosingBracket", "false")
}
"""What the schemas of Siemens say of an attribute that is absent."""


def code_elements(block: Element) -> list[str] | None:
    """Elements of all networks of a block without UIds and defaults; None if one of them is not in SCL, or none is.

    A source does not say in which language its comments are: of a block with comments in one language, it is left out.
    """
    networks = [
        network
        for unit in children(child(block, "ObjectList"), "SW.Blocks.CompileUnit")
        for network in children(child(child(unit, "AttributeList"), "NetworkSource"))
    ]
    if any(local(network) != "StructuredText" for network in networks):
        return None
    languages = {text.get("Lang") for network in networks for text in network.iter("{*}MultiLanguageText")}
    left_out = {"UId", "Lang"} if len(languages) == 1 else {"UId"}
    return [element for network in networks for element in _elements(network, left_out)] or None


def _elements(network: Element, left_out: Collection[str]) -> Iterator[str]:
    pending: list[tuple[int, Element]] = [(0, part) for part in reversed(list(children(network)))]
    while pending:
        depth, element = pending.pop()
        tag = local(element)
        pairs = sorted((str(name), element.get(name, "")) for name in map(str, element.keys()) if name not in left_out)
        shown = " ".join(f"{name}={value}" for name, value in pairs if (tag, name, value) not in _DEFAULTS)
        content = text(element) if not len(element) else ""
        yield f"{depth} {tag} {shown} {content.replace('P# ', 'P#')}"
        pending += [(depth + 1, part) for part in reversed(list(children(element)))]


def compare(folder: Path, documents: dict[Path, Element]) -> Counter[str]:
    """Blocks of one repository, each PLC on its own: ``same``, ``other``, or ``not made``, as where a callee lacks.

    ``joined`` are those of several networks that are the same but for line breaks: a source has no networks.
    """
    counts: Counter[str] = Counter()
    for place, paths in by_plc(documents).items():
        if len(by_plc(documents)) == 1 or place is not None:
            counts += _compare(place or folder, {path: documents[path] for path in paths})
    return counts


def _compare(folder: Path, documents: dict[Path, Element]) -> Counter[str]:
    before = {path: (root, found) for path, root in documents.items() if (found := _blocks(root))}
    counts: Counter[str] = Counter()
    if not before:
        return counts
    newest = Counter(engineering(root) for root, _ in before.values()).most_common(1)[0][0]
    with TemporaryDirectory() as made:
        out = Path(made)
        api.convert(folder, to="scl", out=out / "scl", keep_going=True)
        api.convert(out / "scl", folder, to="xml", out=out / "xml", version=newest, keep_going=True)
        after = {name: code for path in (out / "xml").rglob("*.xml") for name, code in _read(path).items()}
    for _, found in before.values():
        for name, code in found.items():
            counts[_verdict(code, after.get(name))] += 1
    return counts


def _verdict(before: list[str], after: list[str] | None) -> str:
    if after is None or before == after:
        return "not made" if after is None else "same"
    return "joined" if _without_breaks(before) == _without_breaks(after) else "other"


def _without_breaks(elements: list[str]) -> list[str]:
    return [element for element in elements if not element.startswith("0 NewLine")]


def _read(path: Path) -> dict[str, list[str]]:
    return _blocks(parse_xml(*load(path)))


def _blocks(root: Element) -> dict[str, list[str]]:
    """Code of the SCL blocks of a document by name."""
    found = {}
    for block in children(root):
        code = code_elements(block) if local(block).startswith("SW.Blocks.") else None
        if code is not None:
            found[text(child(child(block, "AttributeList"), "Name"))] = code
    return found
