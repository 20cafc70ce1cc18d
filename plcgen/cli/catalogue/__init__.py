"""``plcgen catalogue``: the group of verbs for what is known about drive parameters."""

from __future__ import annotations

from plcgen.cli.groups import Sections, VerbGroup

SECTIONS: Sections = (
    (
        "Parameters",
        (
            ("show", "Show the facts about parameters, with grade and source."),
            ("import", "Show what a list from STARTER, SCOUT or Startdrive adds to it."),
        ),
    ),
)

command = VerbGroup(
    "catalogue",
    help="Show the catalogue of drive parameters, and what a list of your own adds to it.",
    sections=SECTIONS,
    package="plcgen.cli.catalogue",
    examples=(
        "plcgen catalogue show P1120 --device sinamics-g120",
        "plcgen catalogue show --device sinamics-s120 --draw 10 --seed 1",
        "plcgen catalogue import expert_list.csv --device sinamics-g120",
    ),
)
