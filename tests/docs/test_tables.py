"""Tables of the docs that must name everything there is."""

from __future__ import annotations

import re
from collections.abc import Iterator

import click

import plcgen
from plcgen import api
from plcgen.cli.main import cli
from plcgen.ds47.words import CHANNEL_STATES, STATUS_WORDS, VARIANTS
from tests.docs.pages import PAGES, ROOT

_TABLE = re.compile(r"((?:^\|.*\n)+)<!-- keys: (.*) -->", re.MULTILINE)
_KEYS = re.compile(r"`(\w+)`")


def test_the_page_of_the_soft_cpu_names_every_code() -> None:
    """docs/soft-cpu.md has a row for every code that the soft CPU reports."""
    sources = " ".join(path.read_text("utf-8") for path in (ROOT / "plcgen" / "s7" / "cpu").rglob("*.py"))
    page = (ROOT / "docs" / "soft-cpu.md").read_text("utf-8")
    assert set(re.findall(r'"(PG8[23]\d)"', sources)) == set(re.findall(r"^\| (PG8[23]\d) ", page, re.MULTILINE))


def _verbs(group: click.Group, name: str = "") -> Iterator[tuple[str, click.Command]]:
    """Every verb of the command line with its words."""
    for key in group.list_commands(click.Context(group)):
        command = group.get_command(click.Context(group), key)
        assert command is not None
        words = f"{name} {key}".strip()
        yield words, command
        if isinstance(command, click.Group):
            yield from _verbs(command, words)


def test_the_page_of_the_command_line_has_every_verb() -> None:
    """docs/cli.md has a row for every verb; those of a group may share one."""
    page = (ROOT / "docs" / "cli.md").read_text("utf-8")
    rows = re.findall(r"^\| (`.*?) \|", page[: page.index("## The first job")].replace(r"\|", "/"), re.MULTILINE)
    named = {words.split()[0] for row in rows for words in re.findall(r"`(.*?)`", row)}
    assert {name for name in dict(_verbs(cli)) if " " not in name} - named == set()


def test_every_option_is_on_a_page() -> None:
    """Every option of every verb, by one of its spellings."""
    text = "\n".join(page.read_text("utf-8") for page in PAGES)
    named = set(re.findall(r"(?<![\w-])--[a-z][a-z0-9-]*", text))
    silent = [
        (words, *option.opts)
        for words, command in [("plcgen", cli), *_verbs(cli)]
        for option in command.params
        if isinstance(option, click.Option)
        and not option.hidden
        and not named.intersection([*option.opts, *option.secondary_opts])
    ]
    assert silent == []


def test_the_page_of_the_command_line_has_every_function() -> None:
    """docs/cli.md names every function of the package."""
    page = (ROOT / "docs" / "cli.md").read_text("utf-8")
    listed = page[page.index("## From Python") : page.index(" return what they find")].rpartition("```")[2]
    functions = {name for name in plcgen.__all__ if name.islower() and not name.startswith("_")}
    assert set(re.findall(r"`(\w+)`", listed)) == functions


def _documented() -> dict[str, set[str]]:
    """Keys that the pages explain, by the name of their object in the schema; several objects may share a table."""
    found: dict[str, set[str]] = {}
    for page in PAGES:
        for table, objects in _TABLE.findall(page.read_text("utf-8")):
            rows = table.splitlines()[2:]
            found[objects] = {key for row in rows for key in _KEYS.findall(row.split("|")[1])}
    return found


def test_every_key_of_a_spec_is_explained_and_none_is_invented() -> None:
    """docs/spec.md and docs/ppi-master.md have a table for each object of the schema, with exactly its keys."""
    schema = api.schema()
    objects = {name: set(part.get("properties", {})) for name, part in schema["$defs"].items()}
    objects["Spec"] = set(schema["properties"])
    wanted = {names: set().union(*(objects.pop(name) for name in names.split(", "))) for names in _documented()}
    assert wanted == _documented()
    assert {name for name, keys in objects.items() if keys} == set()


def _rows(mark: str) -> list[list[str]]:
    """Cells of the table of docs/generated-code.md that ends with this mark."""
    page = (ROOT / "docs" / "generated-code.md").read_text("utf-8")
    lines = page[: page.index(f"<!-- {mark} -->")].splitlines()
    table = []
    while lines and lines[-1].startswith("|"):
        table.insert(0, [cell.strip() for cell in lines.pop().strip("|").split("|")])
    return table[2:]


def test_the_page_of_the_blocks_has_every_status_word() -> None:
    """Value, name and meaning of each, in order."""
    assert _rows("status words") == [[f"{value:04X}", name, text] for name, value, text in STATUS_WORDS]


def test_the_page_of_the_blocks_has_every_state_of_a_channel() -> None:
    """Names and numbers; two may share a row."""
    found = [
        pair
        for names, numbers, _ in _rows("states")
        for pair in zip(names.split(", "), numbers.split(", "), strict=True)
    ]
    assert found == [(name.removeprefix("STATE_"), str(number)) for name, number, _ in CHANNEL_STATES]


def test_the_page_of_the_blocks_has_every_size_of_the_engine() -> None:
    """Name and what there is room for."""
    assert _rows("sizes") == [[str(cell) for cell in variant] for variant in VARIANTS]
