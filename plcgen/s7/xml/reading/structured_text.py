"""StructuredText of SimaticML to SCL text; comments and layout are kept, UIds are not.

Names and texts from the document cannot become code: a quotation mark in a name, a line break in a comment or an
end of comment inside one is made harmless, and what cannot be written as SCL is reported.
"""

from __future__ import annotations

import re
from functools import lru_cache
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, Severity
from plcgen.s7.scl.parser import MAX_CHARACTERS
from plcgen.s7.xml.reading.types import is_literal
from plcgen.s7.xml.reading.xml import TAGS, local, span
from plcgen.s7.xml.spelling import Operand
from plcgen.s7.xml.writing.structured_text import is_plain

if TYPE_CHECKING:
    from collections.abc import Iterable

    from lxml.etree import _Element as Element

MAX_REPEAT = 10_000
"""Blanks or line breaks of one element."""

MAX_REPORTED = 100

_LINES = re.compile(r"[\r\n\x0b\x0c\x1c-\x1e\x85\u2028\u2029]+")
_POINTER = re.compile(r"P#\s+(?=\S)", re.IGNORECASE)
"""The TIA Portal may write a blank into a pointer, which SCL has not."""

_NUMBER = re.compile(r"[0-9]{1,9}")
_CONSTANTS = frozenset({"LiteralConstant", "TypedConstant", "AddressConstant", "AlarmConstant", "Unnamed"})
_GLOBAL = frozenset({"GlobalVariable", "Undef"})


class CodeReader:
    """Writes the SCL of one network; what it does not know is reported and left out."""

    def __init__(self, file: str, diagnostics: list[Diagnostic]) -> None:
        self.file = file
        self.diagnostics = diagnostics
        self.out: list[str] = []
        self.size = 0

    def read(self, network: Element) -> str:
        """SCL text of a StructuredText element."""
        self.elements(network)
        return "".join(self.out)

    def report(self, message: str, element: Element, severity: Severity = Severity.ERROR) -> None:
        """Add one PG812, up to a bound."""
        if len(self.diagnostics) < MAX_REPORTED:
            self.diagnostics.append(Diagnostic("PG812", message, span(element, self.file), severity))

    def elements(self, children: Iterable[Element]) -> None:
        """Write the children of an element, or some of them, in order."""
        out, tags = self.out, TAGS
        for element in children:
            name = tags[element.tag]
            if name == "Token":
                out.append(_token(element.get("Text", "")))
            elif name in {"Blank", "NewLine"}:
                count = element.get("Num")
                sign = " " if name == "Blank" else "\n"
                out.append(sign if count is None else self.repeated(sign, count, element))
            elif name == "Access":
                self.access(element)
            elif name == "Component":
                self.component(element, first=False, always=False)
            elif name == "Parameter":
                self.parameter(element)
            elif name in {"NamelessParameter", "Expression", "Reference"}:
                self.elements(element)
            elif name in {"LineComment", "Comment"}:
                out.append(_comment(name, element))
            elif name == "Text":
                out.append(_LINES.sub(" ", element.text or ""))
            elif not name.endswith("Attribute") and name not in _IGNORED:
                self.report(f"{name or 'an entity reference'} is unknown in StructuredText", element)

    def repeated(self, sign: str, count: str, element: Element) -> str:
        """Blanks or line breaks, up to a bound."""
        if not _NUMBER.fullmatch(count) or not 0 < int(count) <= MAX_REPEAT:
            self.report(f"Num {count[:20]} is not between 1 and {MAX_REPEAT}", element)
            return sign
        self.size += int(count)
        if self.size > MAX_CHARACTERS:
            return ""
        return sign * int(count)

    # --- operands ---------------------------------------------------------------------------------------

    def access(self, element: Element) -> None:
        """Write one operand or call."""
        scope = element.get("Scope", "")
        if scope not in _SCOPES:
            self.report(f"the Scope {scope[:40] or '(none)'} is unknown", element)
            return
        children = list(element)
        if len(children) == 1 and self.simple(children[0], scope):
            return
        inner = next((c for c in children if local(c) in _CONTENT), None)
        if inner is None:
            self.report(f"an Access with Scope {scope or '(none)'} has no known content", element)
            return
        name = local(inner)
        if name == "Symbol":
            self.symbol(inner, scope)
        elif name == "Constant":
            self.constant(inner, scope)
        elif name in {"CallInfo", "Instruction"}:
            self.call(inner, name)
        elif name == "Address":
            self.address(inner)
        elif name == "Label":
            self.out.append(_name(inner.get("Name", "")))
            self.elements(inner)
        elif name == "PredefinedVariable":
            self.out.append(_name(inner.get("Name", "")))
        elif name == "DataType":
            self.out.append(_LINES.sub(" ", inner.text or ""))
        elif name in {"Expression", "Reference"}:
            self.elements(inner)
        else:
            self.report(f"{name} is not SCL", inner)
        if len(children) == 1:
            return
        self.elements(behind for behind in children[children.index(inner) + 1 :] if local(behind) in _LAYOUT)

    def simple(self, inner: Element, scope: str) -> bool:
        """Write a variable that is one plain name, or a literal; most are."""
        tag = TAGS[inner.tag]
        if tag == "Constant" and len(inner):
            self.constant(inner, scope)
            return True
        if tag != "Symbol" or len(inner) != 1:
            return False
        component = inner[0]
        attributes = component.items()
        if len(component) or TAGS[component.tag] != "Component" or not attributes or attributes[0][0] != "Name":
            return False
        if not attributes[0][1] or len(attributes) > 2 or (len(attributes) == 2 and attributes[1][0] != "UId"):
            return False
        self.out.append(_variable(scope, str(attributes[0][1])))
        return True

    def symbol(self, element: Element, scope: str) -> None:
        """Write a variable: ``#a.b[1]``, ``"DB".c``; a dot that the document leaves out is put in."""
        out = self.out
        first = True
        dotted = True
        peripheral = False
        local_variable = scope not in _GLOBAL
        if self.numbered(element):
            return
        for part in element:
            name = local(part)
            if name == "Component":
                if not first and not dotted:
                    out.append(".")
                if first and local_variable:
                    out.append("#")
                peripheral = "Periphery" in part.get("SimpleAccessModifier", "") or peripheral
                self.component(part, first=first, always=first and not local_variable)
                first, dotted = False, False
            elif name == "Token":
                text = part.get("Text", "")
                dotted = dotted or text == "."
                out.append(_token(text))
            elif name == "Access":
                self.access(part)
            elif name == "Address":
                self.address(part)
            elif name in _LAYOUT:
                self.elements((part,))
        if peripheral:
            out.append(":P")
        if first:
            self.report("a Symbol without Component", element)

    def numbered(self, element: Element) -> bool:
        """Write an operand in a data block that is known by its name here: by its number, ``%DB2.DBW4``."""
        parts = [part for part in element if local(part) == "Address"]
        if len(parts) != 2 or len(element) != 3 or parts[1].get("BlockNumber") is not None:
            return False
        number = parts[0].get("BlockNumber")
        if number is None or parts[0].get("Area") != "DB":
            return False
        self.address(parts[1], number)
        return True

    def component(self, element: Element, *, first: bool, always: bool) -> None:
        """Write one name with quotes where it has or needs them, its indices and its slice."""
        out = self.out
        name = element.get("Name", "")
        bracket = False
        children = list(element) if len(element) else ()
        for part in children:
            if local(part) == "Token" and part.get("Text") == "[":
                bracket = True
        hash_ = "#" if not first and children and _says(element, "HasHash") else ""
        out.append(hash_ + _name(name, quoted=always or _has_quotes(element)))
        if bracket:
            self.elements(element)
        elif any(local(part) == "Access" for part in children):
            out.append("[")
            for position, part in enumerate(p for p in children if local(p) == "Access"):
                out.append(", " if position else "")
                self.access(part)
            out.append("]")
        piece = element.get("SliceAccessModifier", "undef")
        if piece != "undef":
            out.append(f".%{_clean(piece).upper()}")
        if not first and not name:
            self.report("a Component without Name", element)

    def constant(self, element: Element, scope: str) -> None:
        """Write a literal, or the name of a constant."""
        name = element.get("Name")
        if name is not None and scope not in _CONSTANTS:
            prefix = "#" if scope == "LocalConstant" else ""
            self.out.append(prefix + _name(name, quoted=scope == "GlobalConstant" or _has_quotes(element)))
            return
        value = name or ""
        for part in element:
            if TAGS[part.tag] == "ConstantValue":
                value = part.text or value
                break
        value = _POINTER.sub("P#", value, count=1) if value[:2] in {"P#", "p#"} else value
        if not is_literal(value):
            self.report(f"{value[:40] or '(nothing)'} is not a constant", element)
            return
        self.out.append(value)

    def address(self, element: Element, block: str | None = None) -> None:
        """Write an absolute operand; ``block`` is the number of its data block where that stands beside it."""
        area, bits, block = element.get("Area", ""), element.get("BitOffset", ""), element.get("BlockNumber", block)
        if area not in _AREAS or not _NUMBER.fullmatch(bits) or (block is not None and not _NUMBER.fullmatch(block)):
            self.report(f"an address in {area or '(no area)'} cannot be written in SCL", element)
            return
        kind = element.get("Type", "Bool")
        self.out.append(Operand(area, kind, int(bits), None if block is None else int(block)).text)

    # --- calls ------------------------------------------------------------------------------------------

    def call(self, element: Element, kind: str) -> None:
        """Write the call of a block (CallInfo) or of an instruction."""
        out = self.out
        name = element.get("Name", "")
        instance = next((part for part in element if local(part) == "Instance"), None)
        if instance is not None:
            self.symbol(instance, instance.get("Scope", ""))
        elif kind == "CallInfo":
            out.append(_name(name, quoted=True))
        elif name:
            out.append(_name(f"{name}{_typed(element)}"))
        parts = [part for part in element if local(part) not in _CALL_HEAD]
        if any(local(part) == "Token" and part.get("Text") == "(" for part in parts):
            self.parts(parts)
            return
        out.append("(")
        for position, part in enumerate(p for p in parts if local(p).endswith("Parameter")):
            out.append(", " if position else "")
            self.parts([part])
        out.append(")")

    def parts(self, parts: list[Element]) -> None:
        """Write some children of a call."""
        for part in parts:
            name = local(part)
            if name == "Token":
                self.out.append(_token(part.get("Text", "")))
            elif name == "Parameter":
                self.parameter(part)
            elif name == "NamelessParameter":
                self.elements(part)
            elif name in _LAYOUT:
                self.elements((part,))
            elif name not in _IGNORED and not name.endswith("Attribute"):
                self.report(f"{name} is unknown in a call", part)

    def parameter(self, element: Element) -> None:
        """Write ``name := value`` or ``name => value``."""
        self.out.append(_name(element.get("Name", ""), quoted=_has_quotes(element)))
        if len(element) and not any(TAGS[part.tag] == "Token" and part.get("Text") in {":=", "=>"} for part in element):
            self.out.append(" := ")
        self.elements(element)


_LAYOUT = frozenset({"Blank", "NewLine", "LineComment", "Comment"})
_IGNORED = frozenset({"TemplateValue", "AbsoluteOffset", "Instance", "ConstantType"})
_CALL_HEAD = frozenset({"Instance", "TemplateValue", "IntegerAttribute", "DateAttribute", "BooleanAttribute"})
_AREAS = frozenset({"Input", "Output", "Memory", "PeripheryInput", "PeripheryOutput", "DB", "Timer", "Counter"})
_SCOPES = frozenset(
    {"LocalVariable", "GlobalVariable", "LocalConstant", "GlobalConstant", "LiteralConstant", "TypedConstant", "Call"}
    | {
        "AddressConstant",
        "AlarmConstant",
        "NamedValueConstant",
        "Address",
        "Label",
        "PredefinedVariable",
        "Instruction",
    }
    | {"Statusword", "Expression", "Unnamed", "CallWithType", "UserType", "SystemType", "Reference", "Undef"}
)
"""Values of Scope in the schema of Siemens."""

_CONTENT = frozenset(
    {"Symbol", "Constant", "CallInfo", "Instruction", "Address", "Label", "PredefinedVariable", "DataType"}
    | {"Expression", "Reference", "Indirect", "Statusword"}
)


def _typed(instruction: Element) -> str:
    """What SCL puts behind the name of an instruction for the one type it is used with: ``SHL_WORD``."""
    types = [part.text or "" for part in instruction if local(part) == "TemplateValue" and part.get("Type") == "Type"]
    return f"_{types[0].strip().upper()}" if len(types) == 1 else ""


def _has_quotes(element: Element) -> bool:
    """Whether a name stands in quotes though it would need none."""
    return _says(element, "HasQuotes")


def _says(element: Element, attribute: str) -> bool:
    """Whether an attribute of a name is true."""
    for part in element:
        if local(part) == "BooleanAttribute" and part.get("Name") == attribute:
            return (part.text or "").strip() == "true"
    return False


@lru_cache(maxsize=4096)
def _variable(scope: str, name: str) -> str:
    """A variable of one component."""
    return _name(name, quoted=True) if scope in _GLOBAL else f"#{_name(name)}"


@lru_cache(maxsize=4096)
def _name(name: str, *, quoted: bool = False) -> str:
    """A name, in quotes where it has or needs them."""
    clean = _clean(name)
    return clean if is_plain(clean) and not quoted else f'"{clean}"'


def _clean(name: str) -> str:
    """A name on one line without quotation marks."""
    return _LINES.sub(" ", name).replace('"', "_")


@lru_cache(maxsize=1024)
def _token(text: str) -> str:
    """Text of a Token, on one line."""
    return _LINES.sub(" ", text)


def _comment(kind: str, element: Element) -> str:
    """A comment; one that would not end where it should becomes the other kind."""
    parts = [part for part in element if local(part) in {"Text", "Comment", "MultiLanguageText"}]
    text = next((found for part in parts if (found := _comment_text(part))), "")
    inserted = element.get("Inserted") == "true"
    if not inserted and not _LINES.search(text):
        return f"//{text}"
    if kind == "Comment":
        return f"(/*{text.replace('*/', '* /')}*/)"
    return f"(*{_balanced(text)}*)"


def _comment_text(part: Element) -> str:
    if local(part) == "Comment":
        return next((inner.text for inner in part if local(inner) == "MultiLanguageText" and inner.text), "")
    return part.text or ""


def _balanced(text: str) -> str:
    """Text of a comment whose delimiters open and close."""
    depth = 0
    for match in re.finditer(r"\(\*|\*\)", text):
        depth += 1 if match.group() == "(*" else -1
        if depth < 0:
            break
    return text if not depth else text.replace("*)", "* )").replace("(*", "( *")
