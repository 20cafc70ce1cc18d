"""What a SimaticML document is made of, without what its author wrote: elements, attributes, classes of values.

A signature is (parent, element, attribute, value class). The vocabulary of the TIA Portal is its own class, such as the
values of Scope or the names of sections, keywords, operators, system types and instructions; a name, a comment or a
number is only ``name``, ``text`` or ``number``. The attribute ``()`` stands for the attributes that an element has
together, ``.`` for the text inside.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

from plcgen.s7.scl.lexer import KEYWORDS
from plcgen.s7.xml.reading.xml import child, children, local, text

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

Signature = tuple[str, str, str, str]

TOGETHER, TEXT = "()", "."
_OTHER_CODE = frozenset({"FlgNet", "StatementList", "Graph"})
"""Code that is not written here: its elements are not looked into."""

_TELLING = {"Access": "Scope", "CallInfo": "BlockType", "Instance": "Scope", "Section": "Name"}
"""Attributes that decide what an element is: they are part of its name as a parent."""

_VOCABULARY = frozenset(
    {"Scope", "CompositionName", "BlockType", "Area", "Type", "SystemDefined", "Informative", "Inserted", "Remanence"}
    | {"Accessibility", "SimpleAccessModifier", "AccessModifier"}
)
_NAMES_OF_TIA = frozenset(
    {"Section", "BooleanAttribute", "StringAttribute", "IntegerAttribute", "PredefinedVariable", "Instruction"}
)
"""Elements whose Name is a word of the TIA Portal."""

_SETTINGS = frozenset(
    {"MemoryLayout", "ProgrammingLanguage", "InstanceOfType", "SecondaryType", "OfSystemLibElement", "Remanence"}
)
"""Attributes of objects whose text is a word of the TIA Portal."""

_TYPES = frozenset({"Datatype", "DataTypeName", "ConstantType"})
_WORD = re.compile(r"[A-Za-z_][\w.]{0,39}", re.ASCII)
_CONVERSION = re.compile(r"[A-Z]+[0-9]?_TO_[A-Z]+[0-9]?", re.ASCII)
_ARRAY = re.compile(r"Array\[(?P<bounds>[^\]]*)\] of (?P<element>.+)", re.IGNORECASE | re.DOTALL)
_LENGTH = re.compile(r"(W?String)\[.*\]", re.IGNORECASE | re.DOTALL)
_SIGNS = re.compile(r"[-+*/&=<>()\[\]{}.,:;^@?%]{1,3}")
_OPERAND = re.compile(r"%([A-Z]{1,2})[0-9.]+")
_LITERALS = (
    (re.compile(r"(?i:true|false)"), "true or false"),
    (re.compile(r"-?[0-9_]+"), "integer"),
    (re.compile(r"-?[0-9_]+\.[0-9_]+(?:[eE][-+]?[0-9]+)?"), "real"),
    (re.compile(r"(?:2|8|16)#[0-9A-Fa-f_]+"), "number with base"),
    (re.compile(r"'[\s\S]*'"), "string"),
    (re.compile(r"(?i:P#)\S[\s\S]*"), "P#"),
    (re.compile(r"(?i:P#)\s[\s\S]*"), "P# and a blank"),
)
_TYPED = re.compile(r"([A-Za-z_0-9]{1,20})#[\s\S]*", re.ASCII)


def signatures(root: Element) -> Iterator[Signature]:
    """Every signature of a document, as often as it occurs."""
    pending: list[tuple[str, Element]] = [("", root)]
    while pending:
        parent, element = pending.pop()
        tag = local(element)
        if not tag:
            continue
        yield from _of(parent, tag, element)
        if tag not in _OTHER_CODE:
            label = _label(parent, tag, element)
            pending += [(label, inner) for inner in children(element)]


def engineering(root: Element) -> str:
    """Version of the TIA Portal that a document names; empty if it names none."""
    found = child(root, "Engineering")
    return "" if found is None else found.get("version", "")


def objects(root: Element) -> Iterator[str]:
    """Tags of the objects that stand in a document by themselves."""
    return (local(element) for element in children(root) if local(element).startswith("SW."))


def _of(parent: str, tag: str, element: Element) -> Iterator[Signature]:
    names = sorted(map(str, element.keys()))
    telling = _TELLING.get(tag, "")
    shown = (f"{name}={element.get(name)}" if name == telling else name for name in names)
    yield parent, tag, TOGETHER, " ".join(shown)
    for name in names:
        yield parent, tag, name, _value(tag, name, element.get(name, ""))
    content = text(element).strip()
    if content or not len(element):
        yield parent, tag, TEXT, _content(tag, content)


def _label(parent: str, tag: str, element: Element) -> str:
    """What an element is as a parent: lists and sections belong to something."""
    if tag in {"AttributeList", "ObjectList"}:
        return f"{parent.rpartition('/')[2]}/{tag}"
    if tag in {"Interface", "Sections"} and "/" in parent:
        return f"{parent.partition('/')[0]}/{tag}"
    telling = _TELLING.get(tag)
    if telling and tag != "Section" and (found := element.get(telling)):
        return f"{tag} {found}"
    return tag


def _value(tag: str, name: str, value: str) -> str:
    if name in _VOCABULARY or (name == "Name" and tag in _NAMES_OF_TIA):
        return ("conversion" if _CONVERSION.fullmatch(value) else value) if _WORD.fullmatch(value) else "other"
    if name in _TYPES:
        return data_type(value)
    if tag == "Token" and name == "Text":
        return value.upper() if value.upper() in KEYWORDS or _SIGNS.fullmatch(value) else "word"
    if name == "Path":
        return ",".join("number" for _ in value.split(",")) if re.fullmatch(r"[-0-9, ]*", value) else "other"
    if name in {"ID", "Name"}:
        return name.lower()
    return "number" if value.isdigit() else "version" if name.lower() == "version" else "other"


def data_type(spelling: str) -> str:
    """A type without names of users, bounds and lengths: ``Array[,] of "user type"``."""
    array = _ARRAY.fullmatch(spelling)
    if array:
        return f"Array[{',' * array['bounds'].count(',')}] of {data_type(array['element'])}"
    if length := _LENGTH.fullmatch(spelling):
        return f"{length[1]}[]"
    if '"' in spelling:
        return '"user type"'
    return spelling if _WORD.fullmatch(spelling) else "other"


def _content(tag: str, content: str) -> str:
    if not content:
        return ""
    if tag in _TYPES:
        return data_type(content)
    if tag in {"ConstantValue", "StartValue", "Value"}:
        return literal(content)
    if content in {"true", "false"}:
        return content
    if tag in _SETTINGS and _WORD.fullmatch(content):
        return content
    if tag == "LogicalAddress":
        found = _OPERAND.fullmatch(content)
        return f"%{found[1]}" if found else "other"
    return "number" if content.isdigit() else "text"


def literal(content: str) -> str:
    """Class of a literal; what is none may be the name of a constant."""
    for pattern, found in _LITERALS:
        if pattern.fullmatch(content):
            return found
    typed = _TYPED.fullmatch(content)
    return (
        f"{typed[1].upper()}#" if typed else "name" if content[:1] in {'"', "#"} or content.isidentifier() else "other"
    )
