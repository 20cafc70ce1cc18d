"""One word, one meaning: toolchains have one name in specs and options; a page has every option with what it means."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import get_args

import click
import pytest

from plcgen import api
from plcgen.cli.main import cli
from plcgen.project.schema import Toolchain
from plcgen.project.target import toolchain_id

PAGE = Path(__file__).resolve().parents[2] / "docs" / "options.md"


@pytest.mark.parametrize("name", get_args(Toolchain))
def test_case_does_not_matter(name: str) -> None:
    """As the tool writes itself, in capitals, without ``tia-``."""
    spellings = {name, name.upper(), name.removeprefix("tia-"), name.removeprefix("tia-").upper().replace("SP", " SP")}
    assert {toolchain_id(spelled) for spelled in spellings} == {name}


def test_a_spec_takes_any_spelling(tmp_path: Path) -> None:
    """``V19`` in a spec is the TIA Portal V19; what is none is told with what was meant."""
    text = "plc: {name: a, family: s7-1500, toolchain: «}\ndrives: {d: {device: sinamics-g120, hardware_id: 270}}\n"
    text += "jobs: {j: {drive: d, read: [r21]}}\n"
    spec = tmp_path / "job.yaml"
    spec.write_text(text.replace("«", "V19"), "utf-8")
    project = api.check(spec).project
    assert project is not None
    assert project.target.toolchain == "tia-v19"
    spec.write_text(text.replace("«", "tia-v99"), "utf-8")
    (found,) = api.check(spec).diagnostics
    assert (found.code, "tia-v19" in found.help) == ("PG107", True)


def test_old_names_work_and_are_not_shown(plcgen, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    """``--tia V18`` and ``schema --devices`` until the next release."""
    (tmp_path / "a.scl").write_text("FUNCTION_BLOCK A\nBEGIN\nEND_FUNCTION_BLOCK\n", "utf-8")
    for spelled in (["--tia", "V18"], ["--toolchain", "TIA-V18"]):
        assert plcgen("convert", "a.scl", "--to", "xml", "--out", spelled[1], *spelled).code == 0
    documents = [(tmp_path / name / "A.xml").read_bytes() for name in ("V18", "TIA-V18")]
    assert documents[0] == documents[1]
    assert b'version="V18"' in documents[0]
    assert "--tia" not in plcgen("convert", "--help").out
    assert plcgen("schema", "--devices").out == plcgen("devices").out
    assert "--devices" not in plcgen("schema", "--help").out


def verbs(group: click.Group, name: str = "") -> Iterator[tuple[str, click.Command]]:
    """Every verb with its whole name."""
    context = click.Context(group)
    for key in group.list_commands(context):
        found = group.get_command(context, key)
        assert found is not None
        if isinstance(found, click.Group):
            yield from verbs(found, f"{name}{key} ")
        else:
            yield f"{name}{key}", found


def rows() -> list[str]:
    """Option, meaning and verbs, an option with several meanings in several rows."""
    found: dict[tuple[str, str], list[str]] = {}
    for name, verb in verbs(cli):
        for option in verb.params:
            if isinstance(option, click.Option) and not option.hidden:
                shown = option.get_help_record(click.Context(verb))
                assert shown is not None, (name, option)
                said = " ".join(shown[1].partition("  [")[0].split())
                found.setdefault((shown[0], said), []).append(name)
    order = sorted(found.items(), key=lambda item: (item[0][0].lstrip("-"), item[0][1]))
    lines = (f"`{option}` ; {said} ; {', '.join(f'`{name}`' for name in names)}" for (option, said), names in order)
    return ["| " + line.replace("|", r"\|").replace(" ; ", " | ") + " |" for line in lines]


def test_every_option_is_on_the_page() -> None:
    """docs/options.md has each with its meaning and its verbs; ``python -m tests.cli.test_vocabulary`` writes it."""
    lines = PAGE.read_text("utf-8").splitlines()
    assert [line for line in lines if line.startswith("| `")] == rows()


if __name__ == "__main__":
    head = "# Options\n\nEvery option of every verb: a name that means several things has a row for each meaning.\n\n"
    PAGE.write_text(f"{head}| option | meaning | verbs |\n|---|---|---|\n" + "\n".join(rows()) + "\n", "utf-8")
