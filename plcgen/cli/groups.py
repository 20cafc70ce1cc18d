"""Groups of verbs with static help: a verb's module is imported when the verb is called, and no earlier."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from keyword import iskeyword
from types import MappingProxyType
from typing import Any

import click

from plcgen.cli.options import Examples

Sections = tuple[tuple[str, tuple[tuple[str, str], ...]], ...]
"""Titles with their verbs, each with one line of help."""


def _show_help() -> None:
    """What a group does without a verb."""
    ctx = click.get_current_context()
    if ctx.invoked_subcommand is None:
        click.echo(ctx.get_help())


class VerbGroup(Examples, click.Group):
    """A group whose verbs live in modules of the same name in ``package`` and whose help needs none of them.

    ``modules`` names the modules in which several verbs live, each under its own name. A module of a verb that is a
    keyword of Python ends in _.
    """

    def __init__(
        self,
        *args: Any,
        sections: Sections,
        package: str,
        modules: Mapping[str, str] = MappingProxyType({}),
        hint: Callable[[str], str] | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(*args, callback=_show_help, invoke_without_command=True, **kwargs)
        self.sections, self.package, self.modules, self.hint = sections, package, modules, hint

    @property
    def verbs(self) -> tuple[str, ...]:
        """Names of the verbs, in the order of the workflow."""
        return tuple(verb for _, verbs in self.sections for verb, _ in verbs)

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002 - click's signature
        """Verbs in the order of the workflow."""
        return list(self.verbs)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:  # noqa: ARG002
        """Import the verb's module."""
        if cmd_name not in self.verbs:
            return None
        module, command = self.modules.get(cmd_name, cmd_name), cmd_name if cmd_name in self.modules else "command"
        module += "_" if iskeyword(module) else ""
        found: click.Command = getattr(import_module(f"{self.package}.{module}"), command)
        return found

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
        """Write the static table of verbs."""
        for title, verbs in self.sections:
            with formatter.section(title):
                formatter.write_dl(list(verbs), col_spacing=3)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the verb, or say which one was probably meant."""
        name = str(args[0])
        if name not in self.verbs and not name.startswith("-"):
            raise click.UsageError(f'there is no verb "{name}"{self._hint(name)}', ctx)
        return super().resolve_command(ctx, args)

    def _hint(self, name: str) -> str:
        from plcgen.base.diagnostics.suggest import did_you_mean

        special = self.hint(name) if self.hint is not None else ""
        if special:
            return special
        hint = did_you_mean(name, self.verbs)
        return f", {hint}" if hint else f"; the verbs are {', '.join(self.verbs)}"
