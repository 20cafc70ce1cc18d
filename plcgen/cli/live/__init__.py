"""``plcgen live``: the group of verbs that read from real drives and CPUs."""

from __future__ import annotations

from plcgen.cli.groups import Sections, VerbGroup

SECTIONS: Sections = (
    (
        "Drives",
        (
            ("read", "Read parameters of a drive."),
            ("compare", "Compare the values that a spec writes with a drive."),
        ),
    ),
    ("CPUs", (("db", "Compare data blocks in a CPU with a spec."),)),
)


command = VerbGroup(
    "live",
    help="Read from drives and CPUs over the S7 protocol. None of these verbs writes.",
    sections=SECTIONS,
    package="plcgen.cli.live",
    examples=(
        "plcgen live read P1120 r0945[0..3] --drive 192.168.0.5 --device sinamics-g120",
        "plcgen live compare job.yaml --drive pump=192.168.0.5",
        "plcgen live db job.yaml --cpu 192.168.0.1",
    ),
)
