"""Safe reading of XML: no DTD, no entities, no network, bounded size; the reading side's one user of lxml."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.base.files.files import read_bounded

if TYPE_CHECKING:
    from collections.abc import Iterator

    from lxml.etree import _Element as Element

MAX_BYTES = 64 * 1024 * 1024
"""Larger documents are refused with PG802 before they are read."""

_PROLOG = re.compile(rb"(?:[\s\xef\xbb\xbf\xfe\xff]|<\?[\s\S]*?\?>|<!--[\s\S]*?-->)*+")
"""What may stand before a document type: marks, blanks, declaration, comments."""

_DTD = "a document type declaration is not allowed: it can pull in files or blow the document up"


def load(source: Path | str | bytes, file: str | None = None) -> tuple[bytes, str]:
    """Bytes of a document and the name to use in messages.

    Raises DiagnosticError with PG802 (too large) or PG804 (cannot be read).
    """
    if isinstance(source, bytes):
        name, data = file or "<document>", source
    else:
        path = Path(source)
        name = file or str(path)
        try:
            data = read_bounded(path, MAX_BYTES)
        except OSError as error:
            reason = error.strerror or type(error).__name__
            raise _refusal("PG804", f"the file cannot be read: {reason}", Span(name)) from None
    if len(data) > MAX_BYTES:
        raise _refusal("PG802", f"the document has more than {MAX_BYTES} bytes", Span(name))
    return data, name


def parse_xml(data: bytes, file: str) -> Element:
    """Root element of a document.

    Raises DiagnosticError with PG810 (document type or entities) or PG811 (not well formed, with line and
    column).
    """
    from lxml import etree

    head = data.replace(b"\0", b"") if b"\0" in data[:1024] else data
    prolog = _PROLOG.match(head)
    doctype = prolog.end() if prolog else 0
    if head.startswith(b"<!DOCTYPE", doctype):
        line = head.count(b"\n", 0, doctype) + 1
        raise _refusal("PG810", _DTD, Span(file, line, doctype - head.rfind(b"\n", 0, doctype)))
    parser = etree.XMLParser(
        resolve_entities=False,
        no_network=True,
        load_dtd=False,
        dtd_validation=False,
        huge_tree=False,
        remove_comments=True,
        remove_pis=True,
    )
    try:
        root = etree.fromstring(data, parser)
    except etree.XMLSyntaxError as error:
        line, column = error.position
        message = re.sub(r", line \d+, column \d+( \(.*\))?$", "", error.msg or "the document is empty")
        raise _refusal("PG811", message, Span(file, max(line, 1), max(column, 1))) from None
    if root.getroottree().docinfo.internalDTD is not None:
        raise _refusal("PG810", _DTD, Span(file, 1, 1))
    return root


def _refusal(code: str, message: str, span: Span) -> DiagnosticError:
    return DiagnosticError([Diagnostic(code, message, span)])


def span(element: Element, file: str) -> Span:
    """Where an element starts: its line; XML keeps no columns."""
    line: Any = element.sourceline
    return Span(file, line or 1, 1)


class _Tags(dict[Any, str]):
    """Tag as lxml gives it to its name without namespace; what is no element has none. Bounded."""

    def __missing__(self, tag: Any) -> str:
        if len(self) >= MAX_TAGS:
            self.clear()
        self[tag] = name = tag.rpartition("}")[2] if isinstance(tag, str) else ""
        return name


MAX_TAGS = 4096
TAGS = _Tags()


def local(element: Element) -> str:
    """Tag without namespace; an unresolved entity reference has none."""
    return TAGS[element.tag]


def parts(element: Element) -> dict[str, list[Element]]:
    """Child elements by tag without namespace: one pass where several kinds are wanted."""
    found: dict[str, list[Element]] = {}
    for child in element:
        found.setdefault(TAGS[child.tag], []).append(child)
    return found


def namespace(element: Element) -> str:
    """Namespace of the tag, empty if it has none."""
    tag: Any = element.tag
    return tag[1:].partition("}")[0] if isinstance(tag, str) and tag.startswith("{") else ""


def children(element: Element | None, name: str | None = None) -> Iterator[Element]:
    """Child elements in order, all or those with one tag; namespaces do not matter."""
    if element is not None:
        for child in element:
            found = TAGS[child.tag]
            if found and name in (None, found):
                yield child


def child(element: Element | None, name: str) -> Element | None:
    """First child with a tag, or None."""
    return next(children(element, name), None)


def text(element: Element | None) -> str:
    """Text of an element, empty if there is no such element; blanks around it are kept."""
    return "" if element is None else element.text or ""


def multilingual(element: Element, composition: str) -> str:
    """First text that is not empty of the Comment or Title of an object."""
    return next((found for _, found in _texts(element, composition) if found.strip()), "")


def first_culture(element: Element) -> str:
    """The language that the texts of an object begin with: the same in every document of a project."""
    return next((culture for culture, _ in _texts(element, "Comment")), "")


def _texts(element: Element, composition: str) -> Iterator[tuple[str, str]]:
    for group in children(child(element, "ObjectList"), "MultilingualText"):
        if group.get("CompositionName") == composition:
            for item in children(child(group, "ObjectList"), "MultilingualTextItem"):
                listed = child(item, "AttributeList")
                yield text(child(listed, "Culture")), text(child(listed, "Text"))
