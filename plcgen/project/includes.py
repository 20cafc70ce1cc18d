"""``include:``: files that a file is made of, laid together as one tree in which every value keeps its place.

The file that includes wins over what it includes; two included files must not say different things of one key. Below
``jobs`` an entry is whole: what is sent to a drive stands in one place.
"""

from __future__ import annotations

import posixpath
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Note, Report, Span
from plcgen.base.files.files import below, refusal
from plcgen.base.files.yaml import MAX_BYTES, MAX_NODES, YamlNode, parse_yaml

KEY = "include"
WHOLE = "jobs"
SUFFIXES = (".yaml", ".yml")
MAX_FILES = 50
MAX_LEVELS = 8

Read = Callable[[Path, str], str]
"""Text of a file by its path and what messages call it: from disk, or what an editor has; raises DiagnosticError."""


@dataclass(slots=True)
class Gathered:
    """A tree of several files: texts of the included ones by name, and whether all of them could be read."""

    root: YamlNode
    texts: dict[str, str] = field(default_factory=dict)
    complete: bool = True


def gather(root: YamlNode, file: str, report: Report, read: Read) -> Gathered:
    """Lay a tree over the files that it includes; what is wrong goes to ``report``.

    They lie in the folder of ``file`` or below, also behind links; a path begins at the file in which it stands.
    """
    if root.kind != "map" or KEY not in root.pairs:
        return Gathered(root)
    name = posixpath.basename(file)
    gathering = _Gathering(Path(file).parent, report, read)
    whole = gathering.laid(root, (name,))
    return Gathered(whole, gathering.texts, gathering.complete)


def included_names(root: YamlNode) -> Iterator[tuple[str, Span]]:
    """What ``include:`` of a file names, each with its place; what is no text is left to the shape of the file."""
    node = root.get(KEY)
    for item in () if node is None else [node] if node.kind == "scalar" else node.items:
        if item.kind == "scalar" and isinstance(item.value, str):
            yield item.value, item.span


@dataclass(slots=True)
class _Gathering:
    """Reads files below ``folder``, each once; names in ``trees`` are relative to it."""

    folder: Path
    report: Report
    read: Read
    texts: dict[str, str] = field(default_factory=dict)
    trees: dict[str, YamlNode | None] = field(default_factory=dict)
    complete: bool = True
    steps: int = 0

    def laid(self, root: YamlNode, way: tuple[str, ...]) -> YamlNode:
        """A file over those that it includes; ``way`` are the names of the files that lead to it, itself last."""
        whole, own = root, frozenset(map(id, root.walk()))
        for name, place in included_names(root):
            part = self.part(posixpath.normpath(posixpath.join(posixpath.dirname(way[-1]), name)), place, way)
            if part is not None:
                whole = self.merged(whole, part, "", own)
        return whole

    def part(self, name: str, place: Span, way: tuple[str, ...]) -> YamlNode | None:
        """An included file with what it includes itself; None if there is nothing to be had of it."""
        if name in way:
            self.refuse(f"{name} includes itself", place, "remove one of the two lines")
            return None
        if name not in self.trees:
            self.trees[name] = None
            root = self.opened(name, place, way)
            if root is not None:
                whole = self.laid(root, (*way, name))
                pairs = {key: pair for key, pair in whole.pairs.items() if key != KEY}
                self.trees[name] = YamlNode("map", whole.span, pairs=pairs)
        return self.trees[name]

    def opened(self, name: str, place: Span, way: tuple[str, ...]) -> YamlNode | None:
        """The tree of one file."""
        path = below(self.folder, name)
        message, help_ = self.refusal(path, name, way)
        if path is None or message:
            self.refuse(message, place, help_)
            return None
        shown = path.as_posix()
        text = self.text(path, shown, place)
        if text is None:
            return None
        root = parse_yaml(text, shown, self.report)
        if root is not None and root.kind == "map":
            self.shape(root)
            return root
        self.complete = False
        if root is not None:
            self.report.add(Diagnostic("PG106", "an included file is a mapping with keys of a spec", root.span))
        elif not any(found.span.file == shown for found in self.report):
            self.report.add(Diagnostic("PG101", "the file is empty", Span(shown, 1, 1, 1, 1)))
        return None

    def refusal(self, path: Path | None, name: str, way: tuple[str, ...]) -> tuple[str, str]:
        """Why a file is not read, and what to do; empty if it is."""
        if path is None:
            return f"{name} {refusal(name)}", "copy it to the folder of the spec"
        if not name.lower().endswith(SUFFIXES):
            return f"{name} is not a YAML file", "its name must end in .yaml or .yml"
        if len(way) > MAX_LEVELS:
            return f"{name} is included through more than {MAX_LEVELS} files", "include it directly"
        if len(self.texts) >= MAX_FILES:
            return f"more than {MAX_FILES} files are included", "combine several of them into one"
        return "", ""

    def text(self, path: Path, shown: str, place: Span) -> str | None:
        """The text of a file that is called ``shown``."""
        try:
            text = self.read(path, shown)
        except DiagnosticError as problem:
            first = problem.diagnostics[0]
            if first.code == "PG110":
                why = first.message.removeprefix("cannot read the file: ")
                self.refuse(
                    f"{shown} cannot be read: {why}", place, "the path is relative to the file that includes it"
                )
            else:
                self.report.extend(problem.diagnostics)
                self.complete = False
            return None
        self.texts[shown] = text
        if sum(map(len, self.texts.values())) > MAX_BYTES:
            self.refuse("the included files are larger than 16 MiB together", place, "include fewer")
            return None
        return text

    def refuse(self, message: str, place: Span, help_: str) -> None:
        """Say that a file cannot be included."""
        self.report.add(Diagnostic("PG112", message, place, help=help_))
        self.complete = False

    def shape(self, root: YamlNode) -> None:
        """Say what is wrong with ``include:`` of an included file, which no model sees."""
        node = root.get(KEY)
        items = [] if node is None else node.items if node.kind == "seq" else [node]
        for item in items:
            if item.kind != "scalar" or not isinstance(item.value, str):
                self.report.add(Diagnostic("PG106", "expected the path of a file", item.span))
                self.complete = False

    def merged(self, upper: YamlNode, lower: YamlNode, key: str, own: frozenset[int]) -> YamlNode:
        """Two mappings below ``key`` as one; of what both say, the ``own`` values of the file that includes win."""
        pairs = dict(upper.pairs)
        self.steps += len(lower.pairs)
        if self.steps > MAX_NODES:  # aliases multiply
            self.complete = False
            self.report.add(Diagnostic("PG109", f"the files hold more than {MAX_NODES} values", upper.span))
            self.report.raise_on_errors()
        for name, (place, value) in lower.pairs.items():
            known = pairs.get(name)
            if known is None:
                pairs[name] = (place, value)
            elif known[1] is value:
                continue
            elif key != WHOLE and known[1].kind == value.kind == "map":
                pairs[name] = (known[0], self.merged(known[1], value, name, own))
            elif id(known[1]) not in own:
                self.twice(name, key, known[0].span, place.span)
            elif key == WHOLE:
                self.twice(name, key, place.span, known[0].span)
        return YamlNode("map", upper.span, pairs=pairs)

    def twice(self, name: str, key: str, one: Span, place: Span) -> None:
        if key == WHOLE:
            message, help_ = (
                f'the job "{name}" is defined in two files',
                "keep one of them: a job is never put together from two files",
            )
        else:
            message = f'two included files define "{name}"'
            help_ = "define it in one of them, or in the file that includes both: that definition wins"
        self.report.add(Diagnostic("PG113", message, place, help=help_, notes=(Note("the other one", one),)))
