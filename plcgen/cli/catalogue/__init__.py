"""``plcgen catalogue``: the group of verbs for what is known about drive parameters."""

from __future__ import annotations

from plcgen.cli.groups import Sections, VerbGroup

SECTIONS: Sections = (
    (
        "Parameters",
        (
            ("show", "Show what is known about parameters, how, and from where."),
            ("import", "Lay a list of STARTER, SCOUT or Startdrive over it."),
            ("diff", "Compare two versions of it."),
            ("drift", "Compare a list of a drive with the jobs of a spec."),
        ),
    ),
)

command = VerbGroup(
    "catalogue",
    help="Look into the catalogue of drive parameters.",
    sections=SECTIONS,
    package="plcgen.cli.catalogue",
    examples=(
        "plcgen catalogue show P1120 --device sinamics-g120",
        "plcgen catalogue show --device sinamics-s120 --draw 10 --seed 1",
        "plcgen catalogue import expert_list.csv --device sinamics-g120",
    ),
)
