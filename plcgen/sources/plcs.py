"""Which PLC a file of an exported project belongs to: several PLCs in one folder have names of their own.

The TIA Portal's version control interface writes one folder for each PLC, with the groups of its project tree inside,
in the language of its user interface; software units have the same groups once more, below their PLC.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

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
    found: dict[Path | None, list[Path]] = {}
    for path in paths:
        found.setdefault(plc_folder(path), []).append(path)
    return found if len(found.keys() - {None}) > 1 else {None: [path for group in found.values() for path in group]}


def plc_names(folders: Iterable[Path | None]) -> dict[Path | None, str]:
    """A name for each folder of a PLC: as much of its path as tells it from the others."""
    given = [folder for folder in folders if folder is not None]
    found: dict[Path | None, str] = {None: ""}
    for count in range(1, max((len(folder.parts) for folder in given), default=0) + 1):
        found.update((folder, "/".join(folder.parts[-count:])) for folder in given)
        if len(set(found.values())) == len(found):
            break
    return found
