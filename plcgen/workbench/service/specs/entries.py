"""Entries put into the text of a spec at their places; all other lines stay as they are."""

from __future__ import annotations

from collections.abc import Sequence

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Report, Span
from plcgen.base.files.yaml import YamlNode, parse_yaml

_STEP = "  "


def refused(file: str, message: str, help_: str = "") -> DiagnosticError:
    """Why a spec is not changed."""
    return DiagnosticError([Diagnostic("PG901", message, Span(file), help=help_)])


class Entries:
    """A spec as text with the places of its nodes."""

    def __init__(self, text: str, name: str) -> None:
        self.name, self.text = name, text if text.endswith("\n") or not text else f"{text}\n"
        self.lines = self.text.splitlines(keepends=True)
        root = parse_yaml(self.text, name, Report())
        if root is None and self.text.strip():
            raise refused(name, "the form cannot be used while the text is no YAML", "correct the marked line first")
        self.root = root if root is not None and root.kind == "map" else None

    def at(self, *path: str) -> YamlNode | None:
        """The value at some keys."""
        node = self.root
        for key in path:
            node = node.get(key) if node is not None else None
        return node

    def add(self, path: Sequence[str], key: str, body: str) -> str:
        """The text with one more entry in the mapping at ``path``, which is made if it is missing.

        ``body`` is one line of flow YAML: what stands behind the key. Raises DiagnosticError if the key is there.
        """
        parent = self.at(*path)
        if parent is not None and key in parent.pairs:
            raise refused(self.name, f'there is "{key}" already', "choose another name")
        if parent is None or (parent.kind == "scalar" and parent.value is None):
            return self._first(path, key, body)
        if parent.kind != "map":
            raise refused(self.name, f'"{".".join(path)}" is no mapping', "correct it in the text")
        flowing = self.lines[parent.span.line - 1][parent.span.column - 1] == "{"
        return self._entry(parent, f"{key}: {body or 'null' if flowing else body}".rstrip(), "{}")

    def then(self, text: str) -> Entries:
        """The same spec with another text."""
        return Entries(text, self.name)

    def put(self, path: Sequence[str], key: str, body: str) -> str:
        """The text with an entry in the mapping at ``path``, in the place of the one there, if there is one."""
        old = self.at(*path, key)
        if old is None or old.kind != "scalar" or old.value is None:
            return self.add(path, key, body)
        span = old.span
        return self._put(span.line, span.column, body, span.end_column - span.column)

    def append(self, path: Sequence[str], item: str) -> str:
        """The text with one more item in the list at ``path``. Raises DiagnosticError if there is none."""
        parent = self.at(*path)
        if parent is None or parent.kind == "map":
            raise refused(self.name, f'there is no list "{".".join(path)}"', "write it in the text")
        if parent.kind == "scalar" and parent.value is not None:
            span = parent.span
            return self._put(span.line, span.column, f"[{parent.raw}, {item}]", span.end_column - span.column)
        return self._entry(parent, item, "[]")

    def drop(self, path: Sequence[str]) -> str:
        """The text without the entry that ``path`` ends with, or the item of a list by its number from 0.

        An entry above it that would be empty goes, too. Raises DiagnosticError if it is not there.
        """
        *above, last = path
        parent = self.at(*above)
        keys = list(parent.pairs) if parent is not None and parent.kind == "map" else []
        items = list(map(str, range(len(parent.items)))) if parent is not None and parent.kind == "seq" else keys
        if parent is None or last not in items:
            raise refused(self.name, f'there is no "{".".join(path)}" in this text', "look in the files it includes")
        if len(items) == 1 and above:
            return self.drop(above)
        firsts = [key.span for key, _ in parent.pairs.values()] or [item.span for item in parent.items]
        at = items.index(last)
        span = parent.span
        if self.lines[span.line - 1][span.column - 1] in "{[":
            return self._drop_flowing(parent, firsts, at)
        first, end = firsts[at].line, self._with_comments(_end(parent.children[at]), firsts[at].column)
        following = self.lines[end : end + 1]
        if first > 1 and not self.lines[first - 2].strip() and (not following or not following[0].strip()):
            first -= 1
        return "".join([*self.lines[: first - 1], *self.lines[end:]])

    def _drop_flowing(self, parent: YamlNode, firsts: Sequence[Span], at: int) -> str:
        """Without one entry of brackets, and its comma."""
        starts = [0]
        for line in self.lines:
            starts.append(starts[-1] + len(line))
        places = [starts[one.line - 1] + one.column - 1 for one in firsts]
        if at + 1 < len(firsts):
            return self.text[: places[at]] + self.text[places[at + 1] :]
        last = starts[parent.span.end_line - 1] + parent.span.end_column - 2
        begin = self.text.rindex(",", places[at - 1], places[at]) if at else places[at]
        return self.text[:begin] + self.text[last:]

    def _with_comments(self, last: int, column: int) -> int:
        """The last line of an entry with the comments below it that are indented deeper than its key."""
        for number in range(last, len(self.lines)):
            line = self.lines[number]
            if not line.lstrip().startswith("#") or len(line) - len(line.lstrip()) < column:
                return number
        return len(self.lines)

    def _entry(self, parent: YamlNode, entry: str, braces: str) -> str:
        """Put an entry behind the last one of a mapping or list, in its style."""
        line = self.lines[parent.span.line - 1]
        if line[parent.span.column - 1] == braces[0]:
            comma = ", " if parent.children else ""
            return self._put(parent.span.end_line, parent.span.end_column - 1, f"{comma}{entry}")
        last = max(_end(node) for node in (*parent.children, *(key for key, _ in parent.pairs.values())))
        indent = " " * (parent.span.column - 1)
        dash = "- " if braces == "[]" else ""
        last, firsts = self._with_comments(last, parent.span.column), [key.span for key, _ in parent.pairs.values()]
        apart = len(firsts) > 1 and not self.lines[firsts[-1].line - 2].strip()
        return self._insert(last, f"{chr(10) if apart else ''}{indent}{dash}{entry}\n")

    def _first(self, path: Sequence[str], key: str, body: str) -> str:
        """The first entry of a mapping that is empty or missing: behind the key, or a new key at the end."""
        *above, name = path
        parent = self.at(*above) if above else self.root
        if parent is not None and name in parent.pairs:
            place = parent.pairs[name][0].span
            indent = " " * (place.column - 1) + _STEP
            return self._insert(place.line, f"{indent}{key}: {body}".rstrip() + "\n")
        if above and parent is not None:
            return self.add(above, name, f"{{{key}: {body}}}" if body else f"{{{key}: }}")
        gap = "\n" if self.text.strip() else ""
        return f"{self.text.rstrip()}\n{gap}{name}:\n{_STEP}{key}: {body}".lstrip("\n").rstrip() + "\n"

    def _insert(self, line: int, text: str) -> str:
        """Put lines behind a line."""
        return "".join([*self.lines[:line], text, *self.lines[line:]])

    def _put(self, line: int, column: int, text: str, instead: int = 0) -> str:
        old = self.lines[line - 1]
        new = old[: column - 1] + text + old[column - 1 + instead :]
        return "".join([*self.lines[: line - 1], new, *self.lines[line:]])


def _end(node: YamlNode) -> int:
    """The last line that belongs to a node: the end of a block is where the next thing begins."""
    if node.children and node.kind != "scalar":
        deepest = max(_end(each) for each in (*node.children, *(key for key, _ in node.pairs.values())))
        return max(deepest, node.span.end_line if node.span.end_column > 1 and deepest == node.span.end_line else 0)
    end, first = node.span.end_line, node.span.line
    return max(first, end - 1) if node.span.end_column <= 1 else max(first, end)


def in_flow(reference: str) -> str:
    """A reference as it may stand in brackets."""
    return f'"{reference}"' if "[" in reference else reference


def add_parameter(entries: Entries, job: Sequence[str], reference: str, *, writes: bool) -> str:
    """The text with a parameter read or written by a job, by whatever of the two it does already."""
    node = entries.at(*job)
    if node is None or node.kind != "map":
        raise refused(entries.name, f'there is no job "{job[-1]}"', "choose a job of the list")
    key = "write" if writes else "read"
    there = node.get(key)
    number = reference.lstrip("PpRr")
    if there is not None and any(number == old.lstrip("PpRr") for old in _named(there)):
        raise refused(entries.name, f'the job "{job[-1]}" has "{reference}" already')
    if there is None:
        other = next((one for one in ("read", "write", "compare") if node.get(one) is not None), "")
        if other:
            does = f'the job "{job[-1]}" has "{other}": a job does one of them'
            raise refused(entries.name, does, f'add a job for "{key}", or choose one of the list that has it')
        return entries.add(job, key, f"{{{in_flow(reference)}: }}" if writes else f"[{in_flow(reference)}]")
    if there.kind == "map":
        return entries.add([*job, key], in_flow(reference), "")
    return entries.append([*job, key], in_flow(reference))


def _named(node: YamlNode) -> list[str]:
    if node.kind == "map":
        return list(node.pairs)
    return [node.raw] if node.kind == "scalar" else [item.raw for item in node.items if item.kind == "scalar"]
