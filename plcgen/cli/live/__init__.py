"""``plcgen live``: the group of verbs that talk to real drives and CPUs."""

from __future__ import annotations

from plcgen.cli.groups import Sections, VerbGroup

SECTIONS: Sections = (
    (
        "Drives",
        (
            ("read", "Read parameters of a drive."),
            ("compare", "Compare a drive with a spec or a list."),
            ("faults", "Show faults and alarms, with titles."),
            ("backup", "Save all parameters of a drive object as a list."),
            ("write", "Write parameters (with --yes-write)."),
        ),
    ),
    ("CPUs", (("db", "Compare data blocks in a CPU with a spec."),)),
    ("Simulate", (("device", "Be a drive on PROFINET, for records alone."),)),
)


command = VerbGroup(
    "live",
    help="Read from drives and CPUs; write says so in its name, and needs --yes-write.",
    sections=SECTIONS,
    package="plcgen.cli.live",
    examples=(
        "plcgen live read P1120 r0945[0..3] --drive 192.168.0.5 --device sinamics-g120",
        "plcgen live backup pump.csv --port pn://192.168.0.5 --device sinamics-s120",
        "plcgen live compare job.yaml --drive pump=192.168.0.5",
        "plcgen live db job.yaml --cpu 192.168.0.1",
    ),
)
