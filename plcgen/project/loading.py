"""From a spec file to a validated spec, with every problem of the file as a diagnostic at its place."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

from plcgen.diagnostics import Diagnostic, Report, Span
from plcgen.diagnostics.suggest import did_you_mean
from plcgen.input.text import read_text
from plcgen.input.yaml import Node, parse_yaml, resolve_plain
from plcgen.project import schema

SpecPath = tuple[str | int, ...]


@dataclass(frozen=True, slots=True)
class LoadedSpec:
    """A validated spec together with the positions of its values."""

    file: str
    text: str
    spec: schema.Spec
    root: Node

    def span(self, path: SpecPath) -> Span:
        """Where the value at ``path`` stands (or the nearest value above it).

        A parameter in short form (``P50304: 100.0``) stands where its key does.
        """
        if len(path) > 2 and path[-1] in {"parameter", "item"} and isinstance(path[-2], int):
            items = self.root.find(path[:-2])
            if items.kind == "map":
                return next(islice(items.pairs.values(), path[-2], None), (items, items))[0].span
        return self.root.find(path).span

    def key_span(self, path: SpecPath) -> Span:
        """Where the key at ``path`` stands."""
        return self.root.find(path[:-1]).key_span(str(path[-1]))


def load_spec(path: Path, report: Report) -> LoadedSpec | None:
    """Read and validate a spec file.

    Raises:
        DiagnosticError: if the file cannot be read as text at all.
    """
    return parse_spec(read_text(path), path.as_posix(), report)


def parse_spec(text: str, file: str, report: Report) -> LoadedSpec | None:
    """Validate spec text; problems go to ``report``; None if it cannot be used."""
    root = parse_yaml(text, file, report)
    ambiguous = {(d.span.line, d.span.column) for d in report}
    if root is None:
        if not report.has_errors:
            report.add(Diagnostic("PG101", "the file is empty", Span(file, 1, 1, 1, 1), help=_SHAPE))
        return None
    if root.kind != "map":
        report.add(Diagnostic("PG106", "a spec is a mapping with plc, drives and jobs", root.span, help=_SHAPE))
        return None
    try:
        spec = schema.validate(root.data())
    except schema.ValidationError as problems:
        found = _diagnose(problems.errors(include_url=False, include_context=True), root)
        report.extend(d for d in found if (d.span.line, d.span.column) not in ambiguous)
        return None
    if report.has_errors:
        return None
    return LoadedSpec(file, text, spec, root)


_SHOULD = re.compile(r"\A[a-z]+ should (be|have)")
_SHAPE = "start from an example: plcgen new"
_RANGE_ERRORS = (
    "greater_than", "less_than", "too_short", "too_long", "value_error",
    "string_too", "string_pattern", "literal_error", "finite",
)  # fmt: skip
_EXPECTED = {
    "string_type": "text", "int_type": "a whole number", "int_from_float": "a whole number", "float_type": "a number",
    "bool_type": "true or false", "dict_type": "a mapping", "model_type": "a mapping", "tuple_type": "a list",
    "list_type": "a list",
}  # fmt: skip


def _diagnose(errors: Iterable[Any], root: Node) -> list[Diagnostic]:
    """One diagnostic per place: the alternatives of a union are one problem, not several."""
    by_place: dict[tuple[int, int, str], list[Any]] = {}
    for error in errors:
        span = root.find(error["loc"]).span
        kind = error["type"] if error["type"] in {"extra_forbidden", "missing"} else "value"
        detail = str(error["loc"][-1]) if kind != "value" else ""
        by_place.setdefault((span.line, span.column, kind + detail), []).append(error)
    return [_one(group, root) for group in by_place.values()]


def _one(group: list[Any], root: Node) -> Diagnostic:
    error = group[0]
    path: SpecPath = tuple(error["loc"])
    where = ".".join(map(str, path[:-1])) or "the spec"
    if error["type"] == "extra_forbidden":
        return _unknown_key(path, where, root)
    if error["type"] == "missing":
        node = root.find(path[:-1])
        keys = ", ".join(schema.field_names(path[:-1]))
        return Diagnostic("PG105", f'{where} lacks the key "{path[-1]}"', node.span, help=f"keys here: {keys}")
    node = root.find(path)
    given = f" instead of {_shown(node)}"
    if len(group) > 1 and all(e["type"] in _EXPECTED for e in group):
        wanted = " or ".join(dict.fromkeys(_EXPECTED[e["type"]] for e in group))
        return Diagnostic("PG106", f"expected {wanted}{given}", node.span)
    if error["type"] in _EXPECTED:
        number = node.kind == "scalar" and not node.plain and isinstance(resolve_plain(node.raw), int | float)
        help_ = "remove the quotes" if number else ""
        return Diagnostic("PG106", f"expected {_EXPECTED[error['type']]}{given}", node.span, help=help_)
    if error["type"] == "literal_error":
        options = [option.strip(" '") for option in error["ctx"]["expected"].replace(" or ", ",").split(",")]
        hint = did_you_mean(str(node.value), options)
        help_ = f"{hint} allowed: {', '.join(options)}".strip()
        return Diagnostic("PG107", f'"{node.raw}" is not a value of "{_key(path)}"', node.span, help=help_)
    code = "PG107" if error["type"].startswith(_RANGE_ERRORS) else "PG106"
    message = str(error["msg"]).removeprefix("Value error, ")
    message, counted, _ = f"{message[0].lower()}{message[1:]}".partition(" after validation")
    message = _SHOULD.sub(r"must \1", message) + ("" if counted else f", not {_shown(node)}")
    return Diagnostic(code, f'"{_key(path)}": {message}', node.span)


def _unknown_key(path: SpecPath, where: str, root: Node) -> Diagnostic:
    name = str(path[-1])
    allowed = schema.field_names(path[:-1])
    hint = did_you_mean(name, allowed) or "remove the key"
    help_ = f"{hint} keys here: {', '.join(allowed)}" if allowed else hint
    return Diagnostic("PG104", f'unknown key "{name}" in {where}', root.find(path[:-1]).key_span(name), help=help_)


def _key(path: SpecPath) -> str:
    return next((str(step) for step in reversed(path) if isinstance(step, str)), "value")


def _shown(node: Node) -> str:
    if node.kind == "map":
        return "a mapping"
    if node.kind == "seq":
        return "a list"
    if node.value is None:
        return "nothing"
    text = node.raw if len(node.raw) <= 40 else node.raw[:37] + "..."
    return f'"{text}"'
