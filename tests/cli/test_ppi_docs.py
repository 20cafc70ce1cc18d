"""The examples of the page about PPI are executed as they stand."""

import re
from pathlib import Path

import pytest

from plcgen.line.tcp import TcpServer
from plcgen.protocols.ppi.sim import Bus, Station
from plcgen.protocols.ppi.sim.serve import Serving

PAGE = (Path(__file__).parents[2] / "docs" / "ppi.md").read_text("utf-8")
COMMANDS = re.findall(
    r"^\$ plcgen (.+)\n((?:(?!\$ |```).*\n)*)",
    "".join(re.findall(r"```console\n(.*?)```", PAGE, re.DOTALL)),
    re.MULTILINE,
)
EXAMPLES = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)


@pytest.mark.parametrize(("command", "output"), COMMANDS)
def test_commands(plcgen, command, output):
    """Each command prints what the page shows."""
    assert plcgen(*command.split()).out == output


def test_a_read(plcgen):
    """The first example, on a station that has these values."""
    shown = re.search(r"```text\n\$ plcgen (.+?) --port \S+\n(.*?)```", PAGE, re.DOTALL)
    plc = Station(values={"VW100": 1234, "M0.0": True, "T32": 17})
    for number, byte in enumerate((0x3F, 0xC0, 0, 0)):
        plc[f"VB{200 + number}"] = byte
    with Serving(Bus([plc]), TcpServer("127.0.0.1:0")) as name:
        assert plcgen(*shown[1].split(), "--port", name).out == shown[2]


def test_python(capsys):
    """The Python examples run."""
    with Serving(Bus([Station()]), TcpServer("127.0.0.1:0")) as name:
        for example in EXAMPLES:
            exec(compile(example, "docs/ppi.md", "exec"), {"PORT": name})  # noqa: S102 - our own page
    out = capsys.readouterr().out
    assert out.startswith("CPU 224\nVW100 0 \n")
    assert "VB9000 None 05h address out of range\n" in out
    assert out.endswith("an SD1 frame has 6 bytes (10 DA SA FC FCS 16), not 5\n")


def test_there_are_examples():
    """The page has not lost them."""
    assert (len(COMMANDS), len(EXAMPLES)) == (4, 2)
