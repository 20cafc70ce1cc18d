"""Which PLC a file of an exported project belongs to: several PLCs in one folder have names of their own.

The TIA Portal's version control interface writes one folder for each PLC, with the groups of its project tree inside,
in the language of its user interface; software units have the same groups once more, below their PLC. plcgen writes a
folder for each spec, whose manifest names the PLC.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from itertools import islice
from pathlib import Path

from plcgen.base.files.files import read_bounded
from plcgen.s7.read.generated import MANIFEST, MAX_MANIFEST, known_files, project_of

GROUPS = frozenset(
    """program blocks|plc data types|plc tags|watch and force tables|software units
    programmbausteine|plc-datentypen|plc-variablen
    bloques de programa|tipos de datos plc|variables plc
    blocs de programme|types de données api|variables api
    blocchi di programma|tipi di dati plc|variabili plc
    程序块|plc 数据类型|plc 变量""".replace("\n    ", "|").split("|")
)
"""Names of the groups of a PLC in the project tree, in lower case, as the languages of the TIA Portal have them."""


def plc_folder(path: Path, root: Path | None = None) -> Path | None:
    """The outermost folder around a file that has groups of a PLC in it; None if there is none.

    A software unit lies below its PLC: its blocks see those of the PLC. Folders above ``root`` say nothing: they are
    others where a copy lies.
    """
    found = None
    for folder in _inside(path, root):
        if folder.name.lower() in GROUPS and folder != root:
            found = folder.parent
    return found


def by_plc(paths: Iterable[Path], arguments: Sequence[Path] = ()) -> dict[Path | None, list[Path]]:
    """Files by the folder of their PLC; without one None. One PLC only is no reason to tell its files from others.

    ``arguments`` are the folders that were named; if it is one, nothing above it counts, and what belongs to no PLC
    below it belongs to the one that it is itself, if it is one.
    """
    files = list(paths)
    root = arguments[0] if len(arguments) == 1 and any(arguments[0] in path.parents for path in files) else None
    for folder_of in (lambda path: plc_folder(path, root), _of_specs(files, root)):
        found: dict[Path | None, list[Path]] = {}
        for path in files:
            found.setdefault(folder_of(path), []).append(path)
        if len(found.keys() - {None}) > 1:
            if root is not None and root in found:
                found[root] += found.pop(None, [])
            return found
    return {None: files}


def _inside(path: Path, root: Path | None) -> Iterator[Path]:
    """Folders around a file from the inside to the outside, the last one is ``root``."""
    for folder in path.parents:
        yield folder
        if folder == root:
            return


def _of_specs(paths: Iterable[Path], root: Path | None) -> Callable[[Path], Path | None]:
    """The folder of the PLC of a file, as the manifests of generated folders tell them apart.

    Generated folders beside each other with the name of one PLC belong to that PLC. What lies around the folders of
    only one PLC is a part of it: sources written by hand for this machine.
    """
    plcs: dict[Path, tuple[Path, str]] = {}
    for folder in {folder for path in paths for folder in islice(_inside(path, root), 2)}:
        with suppress(OSError, ValueError):
            data = read_bounded(folder / MANIFEST, MAX_MANIFEST)
            if known_files(data):
                plcs[folder] = (folder.parent, project_of(data) or "")
    inside: dict[Path, set[tuple[Path, str]]] = defaultdict(set)
    for folder, plc in plcs.items():
        for above in _inside(folder / MANIFEST, root):
            inside[above].add(plc)
    folders: dict[Path, Path] = {}
    first: dict[tuple[Path, str], Path] = {}
    for folder, plc in sorted(plcs.items()):
        own = [above for above in _inside(folder / MANIFEST, root) if len(inside[above]) == 1] or [folder]
        folders[own[-1]] = first.setdefault(plc, own[-1])
    return lambda path: next((folders[above] for above in path.parents if above in folders), None)


def plc_names(folders: Iterable[Path | None], arguments: Sequence[Path] = ()) -> dict[Path | None, str]:
    """A name for each folder of a PLC: as much of its path as tells it from the others.

    If one folder is named, the path begins there; the PLC that it is itself has an empty name, as have files that
    belong to none.
    """
    given = [folder for folder in folders if folder is not None]
    root = arguments[0] if len(arguments) == 1 else None
    inside = root is not None and all(root in (folder, *folder.parents) for folder in given)
    parts = {folder: folder.relative_to(root).parts if inside and root else folder.parts for folder in given}
    found: dict[Path | None, str] = {}
    for count in range(1, max(map(len, parts.values()), default=0) + 1):
        found = {folder: "/".join(own[-count:]) for folder, own in parts.items()}
        if len(set(found.values())) == len(found):
            break
    return {None: "", **found}
