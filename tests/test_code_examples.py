"""The shell examples of the table of codes run: the first one is reported with its code, the second one is not."""

from __future__ import annotations

import re
import shlex
import shutil
import socket
import subprocess
from collections.abc import Iterable
from contextlib import ExitStack
from functools import cache
from itertools import groupby
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from plcgen.base.diagnostics import pages
from plcgen.base.diagnostics.codes import CodeInfo, all_codes, code
from plcgen.base.line.tcp import TcpServer
from plcgen.cli.main import cli, run
from plcgen.ppi.sim import Bus, Station
from plcgen.ppi.sim.serve import Serving
from plcgen.ppi.sim.station import Switch
from tests.ds47.live.servers import DriveServer, free_port, running

SPEC = """\
plc: {{name: Press 4, family: s7-300, toolchain: step7-v5}}
drives: {{fan: {{device: sinamics-g120, address: 256}}}}
jobs: {{{job}}}
"""
FILES = {
    "press4.yaml": SPEC.format(job="read_speed: {drive: fan, read: [r0021]}"),
    "job.yaml": SPEC.format(job="write_ramp: {drive: fan, write: {P1120: 10.0}}"),
    "plcgen.toml": '[verify]\nfaults = "none"\n',
    "types/Motor.udt": 'TYPE "typeMotor"\nVERSION : 0.1\nSTRUCT\n  speed : Int;\nEND_STRUCT;\nEND_TYPE\n',
    "Motor.db": "DATA_BLOCK \"Motor\"\n{ S7_Optimized_Access := 'FALSE' }\nVERSION : 0.1\nNON_RETAIN\n"
    'STRUCT\n  main : "typeMotor";\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n',
    "Motor.scl": "FUNCTION_BLOCK \"Motor\"\n{ S7_Optimized_Access := 'FALSE' }\nVERSION : 0.1\n"
    "VAR_INPUT\n  speed : Int;\nEND_VAR\nBEGIN\nEND_FUNCTION_BLOCK\n",
    "Motor_DB.db": "DATA_BLOCK \"Motor_DB\"\n{ S7_Optimized_Access := 'FALSE' }\nVERSION : 0.1\nNON_RETAIN\n"
    '"Motor"\nBEGIN\nEND_DATA_BLOCK\n',
}
"""What is in the folder; ``out`` is generated from it."""
BEFORE = {
    "PG110": "mkdir jobs; cp press4.yaml jobs",
    "PG501 bad": "cp Motor.db Press_4.scl",
    "PG502": "sed -i 1s/^/x/ out/Press_4.scl",
    "PG504 bad": "sed -i s/r0021/r0025/ press4.yaml",
    "PG505 bad": "mkdir out/.plcgen-stage-left",
    "PG506": "rm -r out; mkdir out elsewhere",
    "PG507 bad": "mkdir documents",
    "PG508": "cp press4.yaml a.yaml; cp press4.yaml b.yaml",
    "PG613": "cp Motor.scl mine.scl; mkdir elsewhere",
    "PG624": "plcgen generate job.yaml; mkdir -m 777 everybody; mkdir -m 700 own",
    "PG630": "mkdir -p old/plc plc; cp Motor.db old; cp Motor.db types/Motor.udt old/plc; cp -r old/plc .",
    "PG630 bad": "sed -i s/main/first/ Motor.db",
    "PG631": "mkdir old new; cp Motor.db types/Motor.udt old; cp Motor.db types/Motor.udt new",
    "PG632": "mkdir -p plc/db; cp Motor.db types/Motor.udt plc/db",
}
"""What examples need, or what the comment of one says: of no use to a reader, who has a folder."""
NOT_RUN = {
    ("PG508", "bad"): "one would have to wait for the other for half a minute",
    ("PG509", "bad"): "somebody has to save the file while it runs",
    ("PG626", "bad"): "it asks the network for a name",
    ("PG626", "good"): "it needs a cluster",
    **{(code, which): "a device on UDP: tests/ds47/live" for code in ("PG708", "PG709") for which in ("bad", "good")},
    ("PG721", "good"): "it serves until somebody ends it",
    ("PG722", "bad"): "somebody has to pull out an adapter",
    ("PG722", "good"): "it serves until somebody ends it",
    ("PG723", "bad"): "it installs a package",
    ("PG723", "good"): "it installs a package",
    **{("PG725", which): "it keeps values until somebody ends it" for which in ("bad", "good")},
    **{
        (code, which): "it needs a backup of the station: tests/cli/test_ppi_backup.py"
        for code in ("PG726", "PG727")
        for which in ("bad", "good")
    },
    ("PG902", "bad"): "there would have to be a bug",
}
"""Why an example is only parsed."""

Command = tuple[str, ...]


def split(script: str) -> list[Command]:
    """The commands of a script; comments are none."""
    found = []
    for line in script.splitlines():
        words = shlex.shlex(line, posix=True, punctuation_chars=True)
        words.whitespace_split = True
        parts = groupby(words, lambda word: word in {";", "&", "&&", "|"})
        found += [tuple(part) for separates, part in parts if not separates]
    return found


def examples() -> list[tuple[str, str, str]]:
    """Code, ``bad`` or ``good``, and the script."""
    infos = [info for info in map(code, all_codes()) if info.language == "sh"]
    return [(info.code, which, getattr(info, which)) for info in infos for which in ("bad", "good")]


def execute(commands: list[Command]) -> tuple[int, str]:
    """Exit code of the last command, and all output of plcgen."""
    end = 0
    with CliRunner().isolation() as streams:
        for name, *words in commands:
            end = run(words) if name == "plcgen" else subprocess.run([name, *words], check=True).returncode
        return end, "".join(stream.getvalue().decode() for stream in streams[:2])


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the files of the examples, to be copied."""
    folder = tmp_path_factory.mktemp("examples") / "folder"
    (folder / "types").mkdir(parents=True)
    for name, text in FILES.items():
        (folder / name).write_text(text, "utf-8")
    assert execute([("plcgen", "generate", str(folder / "press4.yaml"), "--out", str(folder / "out"))])[0] == 0
    return folder


def stand_ins(code: str, which: str, words: set[str], opened: ExitStack) -> dict[str, str]:
    """What stands here for devices, addresses and folders of an example: simulated ones, which nothing can damage."""
    found = {
        "/read-only": "press4.yaml/out",
        "/etc": str(Path("elsewhere").absolute()),
        "/tmp": "everybody",
        "~/.cache/plcgen-verdicts": "own",
        "/dev/ttyUSB7": "/dev/plcgen-no-such-port",
        "192.168.0.55": f"127.0.0.1:{free_port()}",
    }
    if "127.0.0.1:4000" in words:
        taken = opened.enter_context(socket.create_server(("127.0.0.1", 0)))
        found["127.0.0.1:4000"] = f"127.0.0.1:{taken.getsockname()[1]}"
    if "/dev/ttyUSB0" in words:
        switch = Switch.STOP if (code, which) == ("PG719", "bad") else Switch.TERM
        found["/dev/ttyUSB0"] = opened.enter_context(Serving(Bus([Station(switch=switch)]), TcpServer("127.0.0.1:0")))
    if "192.168.0.5" in words:
        ramp = "41 40 00 00" if (code, which) == ("PG707", "bad") else "41 20 00 00"  # 12.0 and 10.0
        values = {(1120, 1024): ramp, (52, 1024): "03 E8", (21, 1024): "44 7A 00 00"}
        drive = DriveServer({place: bytes.fromhex(data) for place, data in values.items()})
        found["192.168.0.5"] = opened.enter_context(running(drive))
    return found


@pytest.mark.slow
@pytest.mark.parametrize(
    ("code", "which", "script"), [each for each in examples() if each[:2] not in NOT_RUN], ids=lambda each: each[:5]
)
def test_an_example_does_what_it_says(
    code: str, which: str, script: str, generated: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The bad one is reported with its code; the good one is not, and ends well."""
    monkeypatch.setenv("PLCGEN_CACHE", str(generated.parent / "verdicts"))
    monkeypatch.chdir(shutil.copytree(generated, tmp_path / "folder"))
    execute([command for key in (code, f"{code} {which}") for command in split(BEFORE.get(key, ""))])
    commands = split(script)
    with ExitStack() as opened:
        words = stand_ins(code, which, {word for command in commands for word in command}, opened)
        end, said = execute([tuple(words.get(word, word) for word in command) for command in commands])
    assert (f"[{code}]" in said) == (which == "bad"), said
    assert which == "bad" or end == 0, said


def test_every_example_runs_or_says_why_not() -> None:
    """What is prepared or left out is an example of the table."""
    assert NOT_RUN.keys() <= {(code, which) for code, which, _ in examples()}
    assert {key[:5] for key in BEFORE} <= {code for code, _, _ in examples()}


ROOT = click.Context(cli, **cli.context_settings)


def verb(words: Iterable[str]) -> tuple[click.Command, click.Context, list[str]]:
    """The command that words begin with, its group, and the words after it; plcgen itself if it is none."""
    command: click.Command = cli
    context, rest = ROOT, list(words)
    while isinstance(command, click.Group) and rest and (found := command.get_command(context, rest[0])):
        context = click.Context(found, parent=context) if isinstance(found, click.Group) else context
        command, rest = found, rest[1:]
    return command, context, rest


def verbs(info: CodeInfo) -> list[click.Command]:
    """The verbs of the examples of a code; their arguments and options exist and have values that they can take."""
    found = []
    for name, *words in split(f"{info.bad}\n{info.good}") if info.language == "sh" else ():
        if name == "plcgen":
            command, group, rest = verb(words)
            assert not isinstance(command, click.Group), (info.code, words)
            command.make_context(command.name, rest, parent=group)  # UsageError
            found.append(command)
    return found


@cache
def every(group: click.Group) -> list[click.Command]:
    """All verbs of a group and of the groups in it."""
    found = [command for name in group.list_commands(ROOT) if (command := group.get_command(ROOT, name))]
    below = [every(each) if isinstance(each, click.Group) else [each] for each in found]
    return [command for commands in below for command in commands]


NO_VERBS = {"cannot", "did", "divide", "does", "from", "has", "is", "never", "or", "then", "uses", "was"}
"""Words that follow the name of the tool in a sentence."""


def test_commands_of_the_pages_can_be_typed() -> None:
    """Those of examples as they are; in sentences, verbs exist, and options are those of a verb of the page or any."""
    typed = 0
    for info in map(code, all_codes()):
        known = verbs(info)
        typed += len(known)
        assert info.language == "sh" or not re.search("^plcgen ", f"{info.bad}\n{info.good}", re.MULTILINE), info.code
        prose = re.sub(r"^```.*?^```$", "", pages.page(info), flags=re.DOTALL | re.MULTILINE)
        for words in re.findall(r"\bplcgen ([\w -]+)", prose):
            command, _, rest = verb(words.split())
            assert command is not cli or rest[0] in NO_VERBS, (info.code, words)
            assert command is cli or not isinstance(command, click.Group), (info.code, words)
            known.append(command)
        options = {
            name
            for command in known or every(cli)
            for parameter in command.get_params(click.Context(command, parent=ROOT))
            for name in parameter.opts
        }
        assert set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", prose)) <= options, info.code
    assert typed > 60


def test_the_command_of_the_index_can_be_typed() -> None:
    """It prints the page that it names."""
    (command,) = re.findall("`(plcgen .+?)`", pages.index())
    assert execute(split(command)) == (0, execute([("plcgen", "explain", "PG303")])[1])
