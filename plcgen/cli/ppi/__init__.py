"""``plcgen ppi``: the group of verbs for S7-200 stations."""

from __future__ import annotations

from plcgen.cli.groups import Sections, VerbGroup

SECTIONS: Sections = (
    (
        "Telegrams",
        (
            ("encode", "Print request telegrams as hex."),
            ("decode", "Explain telegrams and captures byte by byte."),
        ),
    ),
    (
        "Values",
        (
            ("read", "Read values by address or symbol."),
            ("monitor", "Read values again and again."),
            ("log", "Keep values in a file: CSV, JSON lines, SQLite."),
            ("write", "Write values (with --yes-write)."),
        ),
    ),
    (
        "Memory as a file",
        (
            ("backup", "Read memory into a file."),
            ("compare", "Compare memory with a backup."),
            ("restore", "Write a backup into a station (with --yes-write)."),
        ),
    ),
    (
        "The CPU",
        (
            ("info", "Show CPU type and firmware."),
            ("run", "Put the CPU into RUN (with --yes-run)."),
            ("stop", "Put the CPU into STOP (with --yes-stop)."),
        ),
    ),
    (
        "For other programs",
        (("gateway", "Let S7 clients reach an S7-200 over TCP (ISO-on-TCP)."),),
    ),
    ("Replace", (("migrate", "Turn a symbol table into blocks and tags of an S7-1200."),)),
    ("Simulate", (("serve", "Simulate an S7-200 on a pseudo terminal, serial port or TCP port."),)),
)


command = VerbGroup(
    "ppi",
    help="Talk to S7-200 PLCs over PPI: telegrams, values, a simulated station.",
    sections=SECTIONS,
    package="plcgen.cli.ppi",
    modules={"info": "cpu", "run": "cpu", "stop": "cpu", "backup": "memory", "compare": "memory", "restore": "memory"},
    examples=(
        "plcgen ppi read VB100 VD200:REAL M0.0 --port /dev/ttyUSB0",
        "plcgen ppi monitor VW100 --port socket://192.168.1.50:4000",
        "plcgen ppi decode --file capture.txt",
    ),
)
