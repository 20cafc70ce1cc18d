"""The examples in the help of every verb: each one parses, and what needs no file and no line of the user runs."""

import re
import shlex
from collections.abc import Iterator

import click
import pytest

from plcgen.cli.main import cli
from plcgen.ds47.live.connection import S7Connection

RUN = re.compile(r"(explain|schema|(ppi )?(encode|decode)|catalogue show|live read) ")


def _commands(command: click.Command) -> Iterator[click.Command]:
    yield command
    if isinstance(command, click.Group):
        context = click.Context(command)
        for name in command.list_commands(context):
            verb = command.get_command(context, name)
            assert verb is not None
            yield from _commands(verb)


def _examples() -> Iterator[str]:
    """Commands without the shell around them, the words behind them and what they pass on."""
    for command in _commands(cli):
        for line in getattr(command, "examples", ()):
            if line.startswith("plcgen "):
                yield re.split(r" {3,}| \| | > ", line)[0].removeprefix("plcgen ").strip()


EXAMPLES = sorted(set(_examples()))


@pytest.mark.parametrize("example", EXAMPLES)
def test_an_example_parses(example: str) -> None:
    """Verb, options and the number of arguments are those of the command line."""
    command: click.Command = cli
    words = shlex.split(example)
    while isinstance(command, click.Group):
        with command.make_context("plcgen", list(words[:1])) as context:
            found = command.get_command(context, words.pop(0))
            assert found is not None
            command = found
    command.make_context(command.name, words).close()


@pytest.mark.parametrize(
    "example", [one for one in EXAMPLES if RUN.match(f"{one} ") and not re.search(r"\.(yaml|json|txt)\b|pn://", one)]
)
def test_an_example_without_files_runs(plcgen, monkeypatch, example: str) -> None:
    """A drive that answers zeros stands behind ``live read``: what is asked for has to be known, at least."""
    monkeypatch.setattr(S7Connection, "__init__", lambda *_: None)
    monkeypatch.setattr(S7Connection, "__enter__", lambda self: self)
    monkeypatch.setattr(S7Connection, "__exit__", lambda *_: None)
    monkeypatch.setattr(S7Connection, "read", lambda _self, _db, _start, size: bytes(size))
    result = plcgen(*shlex.split(example))
    assert result.code == 0, result.err
