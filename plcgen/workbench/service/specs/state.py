"""What is known of one version of a spec; each part is worked out when it is asked for, once."""

from __future__ import annotations

import pathlib
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property
from typing import TYPE_CHECKING, Any

from plcgen.base.diagnostics import Report, Span
from plcgen.base.files.yaml import YamlNode
from plcgen.project.composing import Composed, compose
from plcgen.project.includes import Read
from plcgen.workbench.service.documents import Document, Documents
from plcgen.workbench.service.specs.sketch import Path, Sketch, sketch

if TYPE_CHECKING:
    from plcgen.api import CheckResult
    from plcgen.build.sheet import ExchangeSheet
    from plcgen.ds47.plan.nouns import DrivePlan, PlannedDrive
    from plcgen.project.nouns import Project


@dataclass(slots=True)
class Specs:
    """What is known of the specs among some documents."""

    documents: Documents
    _known: dict[pathlib.Path, SpecState] = field(default_factory=dict)

    def state(self, document: Document) -> SpecState:
        """What is known of a version, worked out once for each version and each change elsewhere."""
        generation = self.documents.generation
        known = self._known.get(document.path)
        if known is None or known.document is not document or known.generation != generation:
            known = SpecState.of(document, generation, self.documents.read, known)
            if self.documents.find(document.path) is document:
                self._known[document.path] = known
        return known

    def including(self, part: Document) -> tuple[Document, ...]:
        """The open specs that include a document."""
        others = (one for one in self.documents if one is not part and one.is_yaml and "include" in one.text)
        return tuple(one for one in others if self.state(one).includes(part.file))

    def forget(self) -> None:
        """Keep what is known of open documents only."""
        self._known = {path: one for path, one in self._known.items() if self.documents.find(path) is not None}


@dataclass(frozen=True)
class SpecState:
    """A version of a spec; ``before`` is the last project of an earlier version."""

    document: Document
    generation: int
    read: Read
    before: Project | None

    @classmethod
    def of(cls, document: Document, generation: int, read: Read, earlier: SpecState | None) -> SpecState:
        """The state of a version after an earlier one, of which only the project is kept."""
        return cls(document, generation, read, None if earlier is None else earlier.known_project)

    @property
    def known_project(self) -> Project | None:
        """The project, if it has been asked for, else the one before: nothing is planned for this question."""
        checked: CheckResult | None = self.__dict__.get("checked")
        return self.before if checked is None or checked.project is None else checked.project

    @cached_property
    def checked(self) -> CheckResult:
        """What ``check`` says."""
        from plcgen import api

        return api.check(self.document.path, read=self._text)

    def _text(self, path: Any, file: str) -> str:
        """The text of this version, whether its document is open or not."""
        return self.document.text if path == self.document.path else self.read(path, file)

    @cached_property
    def project(self) -> Project | None:
        """The project as far as it could be planned, else the last one."""
        return self.checked.project or self.before

    @cached_property
    def composed(self) -> Composed | None:
        """The tree with included files and the values of variables; None while the text is broken."""
        return compose(self.document.text, self.document.file, Report(), self._text)

    @cached_property
    def sketch(self) -> Sketch:
        """The outline of the text, broken or not."""
        return sketch(self.document.text, self.document.file)

    @property
    def is_spec(self) -> bool:
        """Whether the text is a spec or a part of one, or nothing yet: there are other YAML files in the world.

        ``jobs``, ``variables`` and ``include`` are keys of other programs, too.
        """
        keys = {each.path[0] for each in self.sketch.entries if len(each.path) == 1}
        known = keys & _spec_keys()
        return not keys or bool(known - _COMMON) or 3 * len(known) >= 2 * len(keys)

    @property
    def is_part(self) -> bool:
        """Whether it is no spec of its own: other files include it."""
        return self.sketch.get("plc") is None and self.sketch.get("include") is None and bool(self.sketch.entries)

    def includes(self, file: str) -> bool:
        """Whether it is made of a file, too."""
        return self.composed is not None and any(name == file for name, _ in self.composed.included)

    @property
    def drive_plan(self) -> DrivePlan | None:
        """The plan of the drives."""
        from plcgen.ds47.plan.nouns import DrivePlan

        return None if self.project is None else self.project.plan(DrivePlan)

    @cached_property
    def exchanges(self) -> tuple[ExchangeSheet, ...]:
        """Every telegram of every job, as a reviewer sees it."""
        plans = () if self.project is None else self.project.plans
        return tuple(one for plan in plans for one in plan.protocol.review_sheet(plan).exchanges)

    def drive(self, key: str) -> PlannedDrive | None:
        """A drive of the plan."""
        plan = self.drive_plan
        return None if plan is None else next((one for one in plan.drives if one.key == key), None)

    def names(self, *pattern: str) -> Sequence[tuple[Path, str]]:
        """The keys below paths of this text and, of the tree, of included files; ``*`` stands for any key."""
        found: dict[str, Path] = {}
        for entry in self.sketch.entries:
            if len(entry.path) == len(pattern) + 1 and matches(entry.path[:-1], pattern):
                found.setdefault(str(entry.path[-1]), entry.path)
        nodes: list[tuple[Path, YamlNode]] = [((), self.composed.root)] if self.composed is not None else []
        for step in pattern:
            nodes = [
                ((*path, key), value)
                for path, node in nodes
                for key, (_, value) in node.pairs.items()
                if step in {"*", key}
            ]
        for path, node in nodes:
            for key in node.pairs:
                found.setdefault(key, (*path, key))
        return [(path, key) for key, path in found.items()]


def matches(path: Sequence[str | int], pattern: Sequence[str]) -> bool:
    """Whether a path has a shape: ``*`` is any key, ``#`` any number."""
    return len(path) == len(pattern) and all(
        wanted == step or (wanted == "*" and isinstance(step, str)) or (wanted == "#" and isinstance(step, int))
        for step, wanted in zip(path, pattern, strict=True)
    )


_COMMON = frozenset({"jobs", "variables", "include", "version"})


@cache
def _spec_keys() -> frozenset[str]:
    from plcgen.project.loading import spec_keys

    return frozenset(spec_keys(()))


def at_start(file: str) -> Span:
    """The beginning of a file."""
    return Span(file, 1, 1, 1, 1)
