"""YAML text -> nodes with line and column for every value; the only importer of PyYAML.

The tree is built here from parser events, without recursion, so depth, size and alias expansion are bounded.
Plain scalars follow YAML 1.2 with S7 additions (``16#0A``, ``W#16#C47F``); what YAML 1.1 would silently turn
into something else (``NO``, ``010``, ``12:30``, ``1_000``) is refused with the spelling that is safe.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Note, Report, Span
from plcgen.base.files.brackets import hide_indexes, show_indexes
from plcgen.base.files.wording import at_bracket, at_tab, plain_words, reader_position

MAX_BYTES = 16 * 1024 * 1024
MAX_DEPTH = 40
MAX_NODES = 1_000_000
MAX_NUMBER = 40
"""Longest number in characters: what is longer is text, and then of the wrong type."""

Scalar: TypeAlias = str | int | float | bool | None


@dataclass(slots=True)
class YamlNode:
    """One YAML value: a mapping (``pairs``), a sequence (``items``) or a scalar (``value``, ``raw`` text)."""

    kind: Literal["map", "seq", "scalar"]
    span: Span
    value: Scalar = None
    raw: str = ""
    plain: bool = False
    pairs: dict[str, tuple[YamlNode, YamlNode]] = field(default_factory=dict)
    items: list[YamlNode] = field(default_factory=list)

    def get(self, key: str) -> YamlNode | None:
        """Value node of a mapping's key, or None."""
        pair = self.pairs.get(key)
        return pair[1] if pair else None

    @property
    def children(self) -> Sequence[YamlNode]:
        """Values of a mapping, or the items of a sequence."""
        return [value for _, value in self.pairs.values()] if self.kind == "map" else self.items

    def walk(self) -> Iterator[YamlNode]:
        """This node and all below it; a node that several aliases share comes once."""
        seen, left = {id(self)}, [self]
        while left:
            node = left.pop()
            yield node
            below = [each for each in node.children if id(each) not in seen]
            seen.update(map(id, below))
            left += below

    def key_span(self, key: str) -> Span:
        """Where a mapping's key stands; the mapping itself if the key is absent."""
        pair = self.pairs.get(key)
        return pair[0].span if pair else self.span

    def find(self, path: Iterable[str | int]) -> YamlNode:
        """Follow keys and indexes as far as they exist; the last node found.

        An index into a mapping means its n-th pair: short forms turn mappings into lists.
        """
        node = self
        for step in path:
            if node.kind == "map" and str(step) in node.pairs:
                node = node.pairs[str(step)][1]
            elif isinstance(step, int) and step < len(node.children):
                node = node.children[step]
        return node

    def data(self) -> Any:
        """Plain Python data: dict, tuple and scalars; the depth is bounded by ``MAX_DEPTH``."""
        if self.kind == "map":
            return {key: value.data() for key, (_, value) in self.pairs.items()}
        if self.kind == "seq":
            return tuple(item.data() for item in self.items)
        return self.value


def plain_node(data: Any, span: Span) -> YamlNode:
    """Wrap plain data as nodes that all stand at one place."""
    if isinstance(data, Mapping):
        pairs = {str(key): (YamlNode("scalar", span, str(key)), plain_node(value, span)) for key, value in data.items()}
        return YamlNode("map", span, pairs=pairs)
    if isinstance(data, list | tuple):
        return YamlNode("seq", span, items=[plain_node(item, span) for item in data])
    return YamlNode("scalar", span, data, str(data))


_INT = re.compile(r"[-+]?(?:0|[1-9][0-9]*)\Z")
_FLOAT = re.compile(r"[-+]?(?:[0-9]+\.[0-9]*|\.[0-9]+|[0-9]+(?=[eE]))(?:[eE][-+]?[0-9]+)?\Z")
_HEX = re.compile(r"0x[0-9A-Fa-f]+\Z")
_S7 = re.compile(r"(?:(?:B|W|DW|L|BYTE|WORD|DWORD)#)?(16|8|2)#([0-9A-Fa-f_]+)\Z")
_WORDS: dict[str, Scalar] = {"": None, "~": None, "null": None, "Null": None, "NULL": None}
_WORDS |= dict.fromkeys(("true", "True", "TRUE"), True) | dict.fromkeys(("false", "False", "FALSE"), False)

_COMMA = (re.compile(r"[-+]?[0-9]+,[0-9]+\Z"), "a decimal comma is read as text", "write a decimal point")
_TRAPS: tuple[tuple[re.Pattern[str], str, str], ...] = (
    (
        re.compile(r"(?i:yes|no|on|off)\Z"),
        "YAML 1.1 reads it as a truth value, YAML 1.2 as text",
        'write true or false, or "{0}" in quotes for the text',
    ),
    (
        re.compile(r"[-+]?0[0-9]+(?:\.[0-9]*)?\Z|0o[0-7]+\Z"),
        "a leading zero means octal to some readers",
        'write the number without the zero, 16#.. for hexadecimal, or "{0}" in quotes',
    ),
    (
        re.compile(r"[-+]?[0-9]+(?::[0-5]?[0-9])+(?:\.[0-9]*)?\Z"),
        "YAML 1.1 reads it as a number to base 60",
        'put it in quotes: "{0}"',
    ),
    (
        re.compile(r"[-+]?[0-9][0-9_]*_[0-9_.]*\Z"),
        "an underscore inside a number is read differently by YAML 1.1 and 1.2",
        "write the digits without underscores",
    ),
    (
        re.compile(r"[-+]?\.(?i:inf|nan)\Z"),
        "no drive parameter is infinite or not a number",
        "write a finite number",
    ),
    _COMMA,
)


def resolve_plain(text: str) -> Scalar:
    """Value of a plain (unquoted) scalar; text that is no number, truth value or null stays text."""
    if text in _WORDS:
        return _WORDS[text]
    if len(text) > MAX_NUMBER:
        return text
    if _INT.match(text):
        return int(text)
    if _FLOAT.match(text):
        return float(text)
    if _HEX.match(text):
        return int(text, 16)
    s7 = _S7.match(text)
    if s7:
        try:
            return int(s7[2].replace("_", ""), int(s7[1]))
        except ValueError:
            return text
    return text


class _Builder:
    """Builds nodes from parser events with an explicit stack."""

    def __init__(self, file: str, report: Report, *, hidden: bool = False) -> None:
        self.file = file
        self.hidden = hidden
        self.report = report
        self.root: YamlNode | None = None
        self.stack: list[tuple[YamlNode, YamlNode | None]] = []
        self.anchors: dict[str, YamlNode] = {}
        self.sizes: dict[int, int] = {}
        self.count = 0
        self.documents = 0

    def span(self, event: Any) -> Span:
        start, end = event.start_mark, event.end_mark
        return Span(self.file, start.line + 1, start.column + 1, end.line + 1, end.column + 1)

    def error(self, code: str, message: str, span: Span, help_: str = "", notes: tuple[Note, ...] = ()) -> None:
        self.report.add(Diagnostic(code, message, span, help=help_, notes=notes))

    def grow(self, amount: int, span: Span) -> None:
        self.count += amount
        if self.count > MAX_NODES:
            self.error("PG109", f"the file expands to more than {MAX_NODES} values", span, "split the file")
            self.report.raise_on_errors()

    def open(self, node: YamlNode, anchor: str | None) -> None:
        if anchor:
            self.anchors[anchor] = node
        if len(self.stack) >= MAX_DEPTH:
            self.too_deep(node.span)
            self.report.raise_on_errors()
        self.stack.append((node, None))
        self.sizes[id(node)] = self.count

    def too_deep(self, span: Span) -> None:
        self.error("PG109", f"nested more than {MAX_DEPTH} levels deep", span, "six levels are enough")

    def close(self, event: Any) -> None:
        node, pending = self.stack.pop()
        if pending is not None:
            self.error("PG101", "key without a value", pending.span)
        end = event.end_mark
        node.span = Span(self.file, node.span.line, node.span.column, end.line + 1, end.column + 1)
        self.sizes[id(node)] = self.count - self.sizes[id(node)]
        self.place(node)

    def place(self, node: YamlNode) -> None:
        self.grow(1, node.span)
        if not self.stack:
            self.root = node
            return
        parent, key = self.stack[-1]
        if parent.kind == "seq":
            parent.items.append(node)
        elif key is None:
            self.stack[-1] = (parent, node)
        else:
            self.stack[-1] = (parent, None)
            self.pair(parent, key, node)

    def pair(self, parent: YamlNode, key: YamlNode, node: YamlNode) -> None:
        if key.kind != "scalar":
            self.error("PG101", "a key must be a single word", key.span)
            return
        if key.plain and key.raw == "<<":
            self.merge(parent, node)
            return
        name = key.raw
        if key.plain and not key.raw.strip("0123456789") and node.plain and not node.raw and _after_comma(parent, key):
            self.error("PG108", f"ambiguous value: {_COMMA[1]}", key.span, _COMMA[2])
            return
        earlier = parent.pairs.get(name)
        if earlier is not None and earlier[0].value is not _MERGED:
            self.error(
                "PG103",
                f'key "{name}" appears twice',
                key.span,
                "YAML would silently keep the last one: remove or rename one of them",
                (Note("first use", earlier[0].span),),
            )
            return
        parent.pairs[name] = (key, node)

    def merge(self, parent: YamlNode, node: YamlNode) -> None:
        for source in node.items if node.kind == "seq" else [node]:
            if source.kind != "map":
                self.error("PG101", 'the merge key "<<" needs a mapping', source.span)
                continue
            for name, (key, value) in source.pairs.items():
                copied = YamlNode("scalar", key.span, _MERGED, key.raw)
                parent.pairs.setdefault(name, (copied, value))

    def scalar(self, event: Any) -> None:
        span = self.span(event)
        text: str = show_indexes(event.value) if self.hidden else event.value
        plain = not event.style and event.implicit[0]
        value: Scalar = text
        if event.tag is not None:
            self.tag(event.tag, span)
        elif plain:
            value = resolve_plain(text)
            if not self.expects_key():
                self.trap(text, value, span)
        node = YamlNode("scalar", span, value, text, plain)
        if event.anchor:
            self.anchors[event.anchor] = node
        self.place(node)

    def expects_key(self) -> bool:
        """Whether the next node is a key: keys are always read as text, so an axis may be called y."""
        return bool(self.stack) and self.stack[-1][0].kind == "map" and self.stack[-1][1] is None

    def trap(self, text: str, value: Scalar, span: Span) -> None:
        if not isinstance(value, str) or not text or len(text) > 40:
            return
        for pattern, why, fix in _TRAPS:
            if pattern.match(text):
                self.error("PG108", f"ambiguous value {text}: {why}", span, fix.format(text))
                return

    def tag(self, tag: str, span: Span) -> None:
        self.error(
            "PG109",
            f"YAML tag {tag.replace('tag:yaml.org,2002:', '!!')} is not accepted",
            span,
            "write plain values only: remove the tag",
        )

    def alias(self, event: Any) -> None:
        span = self.span(event)
        node = self.anchors.get(event.anchor)
        if node is None:
            self.error("PG101", f'alias "*{event.anchor}" has no anchor', span, "if it is a text, put it in quotes")
            node = YamlNode("scalar", span)
        elif any(node is ancestor for ancestor, _ in self.stack):
            self.error("PG109", f'alias "*{event.anchor}" contains itself', span, "write the values out")
            self.report.raise_on_errors()
        self.grow(self.sizes.get(id(node), 1), span)
        self.place(node)


def _after_comma(parent: YamlNode, key: YamlNode) -> bool:
    """Whether digits without a value follow a whole number and a comma: ``{a: 5,0}`` is a 5 and a key 0 to YAML."""
    if not parent.pairs or key.span.line != (last := next(reversed(parent.pairs.values()))[1]).span.end_line:
        return False
    return bool(last.plain and _INT.match(last.raw)) and key.span.column == (last.span.end_column or 0) + 1


_MERGED = "\0merged"


def parse_yaml(text: str, file: str, report: Report) -> YamlNode | None:
    """Parse one YAML document; problems go to ``report``; None if nothing usable was found."""
    import yaml

    loader: Any = getattr(yaml, "CSafeLoader", None)
    shown, text = text, hide_indexes(text)
    builder = _Builder(file, report, hidden=text != shown)
    try:
        parser = loader(text) if loader else yaml.SafeLoader(text)
        for event in _events(parser):
            if not _feed(builder, event):
                break
    except yaml.MarkedYAMLError as problem:
        mark = problem.problem_mark or problem.context_mark
        line, column = (mark.line + 1, mark.column + 1) if mark else (1, 1)
        what, help_ = at_bracket(shown, problem.problem_mark) or (
            plain_words(problem.problem, problem.context),
            "check the indentation and the brackets on this line and the one before",
        )
        place = Span(file, line, column, line, column + 1)
        if "nesting depth" in (problem.problem or ""):  # a bound of libyaml from PyYAML 6.0.4 on, far above ours
            builder.too_deep(place)
            return None
        if at_tab(text, problem.problem_mark):
            what, help_ = "a tab where only spaces are allowed", "indent with spaces: YAML does not allow tabs"
        builder.error("PG101", what, place, help_)
        return None
    except yaml.reader.ReaderError as problem:
        position = reader_position(problem, text)
        line = text.count("\n", 0, position) + 1
        column = position - (text.rfind("\n", 0, position) + 1) + 1
        shown = f"the character U+{ord(text[position]):04X} is not allowed" if position < len(text) else "not readable"
        builder.error("PG101", shown, Span(file, line, column, line, column + 1), "remove it, or write it as an escape")
        return None
    except DiagnosticError:
        return None
    return builder.root


def _events(parser: Any) -> Iterator[Any]:
    import yaml

    while True:
        event = parser.get_event()
        if event is None or isinstance(event, yaml.StreamEndEvent):
            return
        yield event


def _feed(builder: _Builder, event: Any) -> bool:
    """Hand one event to the builder; False ends the reading."""
    import yaml

    if isinstance(event, yaml.ScalarEvent):
        builder.scalar(event)
    elif isinstance(event, (yaml.MappingStartEvent, yaml.SequenceStartEvent)):
        if event.tag is not None:
            builder.tag(event.tag, builder.span(event))
        kind: Literal["map", "seq"] = "map" if isinstance(event, yaml.MappingStartEvent) else "seq"
        builder.open(YamlNode(kind, builder.span(event)), event.anchor)
    elif isinstance(event, (yaml.MappingEndEvent, yaml.SequenceEndEvent)):
        builder.close(event)
    elif isinstance(event, yaml.AliasEvent):
        builder.alias(event)
    elif isinstance(event, yaml.DocumentStartEvent):
        builder.documents += 1
        if builder.documents > 1:
            builder.error("PG101", "a second YAML document starts here", builder.span(event), "one file, one document")
            return False
    return True


def load_yaml(text: str, file: str) -> YamlNode:
    """Parse one YAML document.

    Raises:
        DiagnosticError: with every problem found, if there is one or the document is empty.
    """
    report = Report()
    node = parse_yaml(text, file, report)
    if node is None and not report.has_errors:
        report.add(Diagnostic("PG101", "the file is empty", Span(file, 1, 1, 1, 1)))
    report.raise_on_errors()
    assert node is not None  # raise_on_errors leaves only this case
    return node
