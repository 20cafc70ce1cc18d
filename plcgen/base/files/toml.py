"""TOML text -> the nodes that YAML becomes, with the line and column of tables and keys.

``tomllib`` reads, and says where a syntax error is. Where keys stand is looked up in the lines; what a line does not
show (keys of inline tables, values over several lines) has the place of the key above it.
"""

from __future__ import annotations

import re
import tomllib
from typing import Any

from plcgen.base.diagnostics import Diagnostic, Report, Span
from plcgen.base.files.yaml import MAX_NUMBER, YamlNode, plain_node

_TABLE = re.compile(r"\s*\[\s*([^\[\]#]+?)\s*\]")
_KEY = re.compile(r"\s*([A-Za-z0-9_-]+|\"[^\"]*\"|'[^']*')\s*=\s*(\S(?:.*\S)?)?")
_PLACE = re.compile(r" \(at (?:line (\d+), column (\d+)|end of document)\)\Z")
MAX_DEPTH = 20
"""Deepest nesting of tables: ours have one level."""
MAX_BYTES = 1024 * 1024
_PART = r"(?:[A-Za-z0-9_-]+|\"[^\"\n]*\"|'[^'\n]*')[ \t]*"
_DEEP_KEY = re.compile(
    rf"(?:^[ \t]*(?:\[+[ \t]*)?|[{{,][ \t]*)(?:{_PART}\.[ \t]*){{{MAX_DEPTH}}}",
    re.MULTILINE,
)
_LONG_NUMBER = re.compile(rf"(?<![\w.+-])[+-]?[0-9_]{{{MAX_NUMBER + 1},}}(?![\w.])")


def parse_toml(text: str, file: str, report: Report) -> YamlNode | None:
    """Parse a TOML document; problems go to ``report``; None if it cannot be read."""
    if len(text) > MAX_BYTES:
        message = f"larger than {MAX_BYTES // 1024 // 1024} MiB"
        report.add(Diagnostic("PG109", message, Span(file, 1, 1), help="name folders instead of single files"))
        return None
    deep = _DEEP_KEY.search(text)  # tomllib takes the square of their length for them
    if deep is not None:
        report.add(Diagnostic("PG109", "nested too deeply", _span_at(text, deep, file), help=_SHALLOW))
        return None
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as problem:
        found = _PLACE.search(str(problem))
        line, column = (int(found[1]), int(found[2])) if found and found[1] else (text.count("\n") + 1, 1)
        what = _PLACE.sub("", str(problem))
        place = Span(file, line, column, line, column + 1)
        help_ = "text needs quotes, and a table needs a line of its own: [verify]"
        report.add(Diagnostic("PG101", f"{what[:1].lower()}{what[1:]}", place, help=help_))
        return None
    except ValueError:  # int() refuses thousands of digits
        number = _LONG_NUMBER.search(text)
        place = Span(file, 1, 1) if number is None else _span_at(text, number, file)
        report.add(
            Diagnostic("PG107", "this number has too many digits", place, help="no key here needs such a number")
        )
        return None
    except RecursionError:
        report.add(Diagnostic("PG109", "nested too deeply", Span(file, 1, 1), help=_SHALLOW))
        return None
    return _placed(data, _places(text, file), (), Span(file, 1, 1, 1, 1))


_SHALLOW = "one level of tables is enough"


def _span_at(text: str, found: re.Match[str], file: str) -> Span:
    line = text.count("\n", 0, found.start()) + 1
    column = found.start() - text.rfind("\n", 0, found.start())
    return Span(file, line, column, line, column + 1)


Path = tuple[str, ...]


def _placed(data: dict[str, Any], places: dict[Path, tuple[Span, Span]], path: Path, above: Span) -> YamlNode:
    pairs: dict[str, tuple[YamlNode, YamlNode]] = {}
    for key, value in data.items():
        at, of_value = places.get((*path, key), (above, above))
        below = isinstance(value, dict) and len(path) < MAX_DEPTH
        node = _placed(value, places, (*path, key), at) if below else plain_node(value, of_value)
        pairs[key] = (YamlNode("scalar", at, key, key), node)
    return YamlNode("map", above, pairs=pairs)


def _places(text: str, file: str) -> dict[Path, tuple[Span, Span]]:
    """Where each key stands, and where its value begins, by the path of the key."""
    found: dict[Path, tuple[Span, Span]] = {}
    table: Path = ()
    for number, line in enumerate(text.splitlines(), 1):
        header, key = _TABLE.match(line), _KEY.match(line)
        if header:
            table = tuple(part.strip(" \"'") for part in header[1].split("."))
            span = Span(file, number, header.start(1) + 1, number, header.end(1) + 1)
            found.setdefault(table, (span, span))
        elif key:
            at = Span(file, number, key.start(1) + 1, number, key.end(1) + 1)
            value = Span(file, number, key.start(2) + 1, number, key.end(2) + 1) if key[2] else at
            found.setdefault((*table, key[1].strip("\"'")), (at, value))
    return found
