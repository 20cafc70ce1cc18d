"""Options that several verbs share, and what they do to the console."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

import click

from plcgen.cli.output import Console

Callback = TypeVar("Callback", bound=Callable[..., Any])

CONTEXT: dict[str, Any] = {"help_option_names": ["-h", "--help"], "max_content_width": 100}
_SOURCES = frozenset({".scl", ".udt", ".db", ".awl", ".stl", ".sdf", ".asc"})
FORMATS = ("text", "json", "sarif", "junit", "github")


class _NamedPath(click.Path):
    """A path that is not empty: an empty one would silently mean the current folder."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if value == "":
            self.fail("the path is empty", param, ctx)
        return super().convert(value, param, ctx)


PATH = _NamedPath(path_type=Path)


class Examples(click.Command):
    """A command whose help ends with examples, printed as they are."""

    def __init__(self, *args: Any, examples: Sequence[str] = (), **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.examples = tuple(examples)

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the examples below the options."""
        super().format_epilog(ctx, formatter)
        if self.examples:
            with formatter.section("Examples"):
                for line in self.examples:
                    formatter.write(f"{'':>{formatter.current_indent}}{line}\n")


class Verb(Examples):
    """One verb of the command line; a file that it reads is never the one that it writes."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run the verb, unless its result would overwrite one of its inputs."""
        target = ctx.params.get("output") or ctx.params.get("path")
        if isinstance(target, Path) and target.is_file():
            for name, value in ctx.params.items():
                read = value if isinstance(value, tuple) else (value,)
                if name in {"output", "path"}:
                    continue
                for path in read:
                    if isinstance(path, Path) and _would_destroy(target, path):
                        raise click.UsageError(f"{target} is a source that is read: write the result elsewhere", ctx)
        return super().invoke(ctx)


def _would_destroy(target: Path, read: Path) -> bool:
    """Whether an existing file is ``read``, or a PLC source below the folder ``read``."""
    try:
        if not read.is_dir():
            return target.samefile(read)
        inside = target.resolve().is_relative_to(read.resolve())
    except OSError:
        return False
    return inside and target.suffix.lower() in _SOURCES


def _quiet(ctx: click.Context, _param: click.Parameter, value: bool) -> None:  # noqa: FBT001 - click's signature
    if value:
        ctx.ensure_object(Console).quiet = True


def _color(ctx: click.Context, _param: click.Parameter, value: Any) -> None:
    if value:
        ctx.ensure_object(Console).color = value


def common_options(verb: Callback) -> Callback:
    """Add ``--quiet`` and ``--color``, which work before and behind the verb."""
    quiet = click.option(
        "-q", "--quiet", is_flag=True, expose_value=False, callback=_quiet, help="Say only what is wrong."
    )
    color = click.option(
        "--color",
        type=click.Choice(["auto", "always", "never"]),
        metavar="WHEN",
        expose_value=False,
        callback=_color,
        help="Colours: auto (terminal, no NO_COLOR), always, never.",
    )
    return quiet(color(verb))


def output_option(verb: Callback) -> Callback:
    """Add ``--output FILE``."""
    option = click.option(
        "-o", "--output", type=PATH, metavar="FILE", help="Write the result to FILE instead of stdout."
    )
    return option(verb)


def format_options(*formats: str) -> Callable[[Callback], Callback]:
    """Add ``--format`` and its short form ``--json``; the parameter is called ``format_``."""

    def add(verb: Callback) -> Callback:
        choice = click.option(
            "-f",
            "--format",
            "format_",
            type=click.Choice(formats),
            default=formats[0],
            metavar="FORMAT",
            help=f"One of {', '.join(formats)}.  [default: {formats[0]}]",
        )
        short = click.option("--json", "format_", flag_value="json", help="The same as --format json.")
        return choice(short(verb))

    return add


def json_option(verb: Callback) -> Callback:
    """Add ``--json`` for verbs that know text and JSON only; the parameter is called ``as_json``."""
    return click.option("--json", "as_json", is_flag=True, help="Write JSON for programs.")(verb)


def console(ctx: click.Context) -> Console:
    """Return the console of this call."""
    return ctx.ensure_object(Console)
