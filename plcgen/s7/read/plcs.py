"""Which PLC a file of an exported project belongs to: several PLCs in one folder have names of their own.

The TIA Portal's version control interface writes one folder for each PLC, with the groups of its project tree inside,
in the language of its user interface; software units have the same groups once more, below their PLC. plcgen writes a
folder for each spec, whose manifest names the PLC.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable
from contextlib import suppress
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


def plc_folder(path: Path) -> Path | None:
    """The outermost folder around a file that has groups of a PLC in it; None if there is none.

    A software unit lies below its PLC: its blocks see those of the PLC.
    """
    found = None
    for folder in path.parents:
        if folder.name.lower() in GROUPS:
            found = folder.parent
    return found


def by_plc(paths: Iterable[Path]) -> dict[Path | None, list[Path]]:
    """Files by the folder of their PLC; without one None. One PLC only is no reason to tell its files from others."""
    files = list(paths)
    for folder_of in (plc_folder, _of_specs(files)):
        found: dict[Path | None, list[Path]] = {}
        for path in files:
            found.setdefault(folder_of(path), []).append(path)
        if len(found.keys() - {None}) > 1:
            return found
    return {None: files}


def _of_specs(paths: Iterable[Path]) -> Callable[[Path], Path | None]:
    """The folder of the PLC of a file, as the manifests of generated folders tell them apart.

    Generated folders beside each other with the name of one PLC belong to that PLC. What lies around the folders of
    only one PLC is a part of it: sources written by hand for this machine.
    """
    plcs: dict[Path, tuple[Path, str]] = {}
    for folder in {folder for path in paths for folder in list(path.parents)[:2]}:
        with suppress(OSError, ValueError):
            data = read_bounded(folder / MANIFEST, MAX_MANIFEST)
            if known_files(data):
                plcs[folder] = (folder.parent, project_of(data) or "")
    inside: dict[Path, set[tuple[Path, str]]] = defaultdict(set)
    for folder, plc in plcs.items():
        for above in (folder, *folder.parents):
            inside[above].add(plc)
    folders: dict[Path, Path] = {}
    first: dict[tuple[Path, str], Path] = {}
    for folder, plc in sorted(plcs.items()):
        own = [above for above in (folder, *folder.parents) if len(inside[above]) == 1] or [folder]
        folders[own[-1]] = first.setdefault(plc, own[-1])
    return lambda path: next((folders[above] for above in path.parents if above in folders), None)


def plc_names(folders: Iterable[Path | None]) -> dict[Path | None, str]:
    """A name for each folder of a PLC: as much of its path as tells it from the others."""
    given = [folder for folder in folders if folder is not None]
    found: dict[Path | None, str] = {None: ""}
    for count in range(1, max((len(folder.parts) for folder in given), default=0) + 1):
        found.update((folder, "/".join(folder.parts[-count:])) for folder in given)
        if len(set(found.values())) == len(found):
            break
    return found
