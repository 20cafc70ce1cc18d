"""SimaticML documents of a folder: which there are, what they are made of, and how much of them is read."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import DiagnosticError, Severity
from plcgen.s7.xml.reading.documents import read_simaticml, read_tag_table
from plcgen.s7.xml.reading.xml import load, local, parse_xml
from tests.evidence.round_trip import compare
from tests.evidence.signatures import Signature, engineering, objects, signatures

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

KEPT = Path(__file__).with_name("simaticml.tsv")
"""Signatures with the number of documents of every version that have them."""

_HEAD = "# SimaticML documents of public repositories: parent, element, attribute, value class, documents by version"


@dataclass(slots=True)
class Summary:
    """Counts of documents: by version, by kind of object, and of every signature by version."""

    versions: Counter[str] = field(default_factory=Counter)
    kinds: Counter[str] = field(default_factory=Counter)
    folders: set[str] = field(default_factory=set)
    found: dict[Signature, Counter[str]] = field(default_factory=dict)
    read: int = 0
    """Documents that are read without an error."""
    other: int = 0
    """XML files that are no SimaticML."""

    def add(self, root: Element, folder: str) -> None:
        """Count one document."""
        version = engineering(root)
        self.versions[version] += 1
        self.kinds.update(objects(root))
        self.folders.add(folder)
        for signature in set(signatures(root)):
            self.found.setdefault(signature, Counter())[version] += 1


def documents(folder: Path) -> Iterator[tuple[Path, Element | None]]:
    """Every XML file below a folder with its root; None if it is no SimaticML document of blocks, types or tables."""
    for path in sorted(folder.rglob("*.xml")):
        try:
            root = parse_xml(*load(path))
        except DiagnosticError:
            yield path, None
            continue
        yield path, root if local(root) == "Document" and any(objects(root)) and engineering(root) else None


def summary(folder: Path) -> Summary:
    """Counts of all documents below a folder, whose subfolders are repositories."""
    found = Summary()
    for path, root in documents(folder):
        if root is None:
            found.other += 1
        else:
            found.add(root, path.relative_to(folder).parts[0])
            problems = read_simaticml(path)[1] + read_tag_table(path)[1]
            found.read += not any(problem.severity is Severity.ERROR for problem in problems)
    return found


def write(found: Summary, path: Path = KEPT) -> None:
    """Keep the counts as lines of tab-separated columns, sorted."""
    rows = ("\t".join((*signature, _by_version(counts))) for signature, counts in sorted(found.found.items()))
    head = (
        f"{_HEAD}\n# {sum(found.versions.values())} in {len(found.folders)} repositories: {_by_version(found.versions)}"
    )
    path.write_text("\n".join([head, *rows, ""]), encoding="utf-8")


def read(path: Path = KEPT) -> dict[Signature, Counter[str]]:
    """The counts that are kept."""
    found: dict[Signature, Counter[str]] = {}
    for line in path.read_text(encoding="utf-8").splitlines():
        if not line.startswith("#"):
            parent, element, attribute, value, counts = line.split("\t")
            pairs = (pair.rpartition(" ") for pair in counts.split(", "))
            found[parent, element, attribute, value] = Counter({name: int(count) for name, _, count in pairs})
    return found


def _by_version(counts: Mapping[str, int]) -> str:
    return ", ".join(f"{name} {count}" for name, count in sorted(counts.items(), key=lambda item: age(item[0])))


def age(version: str) -> tuple[int, ...]:
    """Versions in their order: ``V14 SP1``, ``V15``, ``V15.1``, .."""
    return tuple(map(int, re.findall(r"[0-9]+", version)))


def unseen(made: Iterable[Signature], known: Mapping[Signature, object]) -> list[Signature]:
    """Signatures that no counted document has."""
    return sorted(set(made) - set(known))


def report(folder: Path, *, save: bool = False) -> Sequence[str]:
    """The figures of a folder; ``save`` keeps its counts."""
    found, trips = summary(folder), Counter[str]()
    if save:
        write(found)
    lines = [f"SimaticML: {sum(found.versions.values())} documents in {len(found.folders)} repositories"]
    lines += [f"  versions   {_by_version(found.versions)}"] if found.versions else []
    lines += [f"  {count:>6} {kind}" for kind, count in found.kinds.most_common()]
    lines.append(f"  {len(found.found)} signatures, {len(unseen(found.found, read()))} of them not among those kept")
    lines.append(f"  {found.read} read without an error")
    for repository in sorted(path for path in folder.iterdir() if path.is_dir()):
        trips += compare(repository, {path: root for path, root in documents(repository) if root is not None})
    if trips:
        lines.append(
            f"  {sum(trips.values())} blocks in SCL to text and back: {trips['same']} the same elements, "
            f"{trips['joined']} the same in one network instead of several, {trips['other']} others, "
            f"{trips['not made']} not made (a callee is not there)"
        )
    if found.other:
        lines.append(f"  {found.other} other XML files")
    return lines
