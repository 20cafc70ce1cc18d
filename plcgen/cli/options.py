"""Options that several verbs share, and what they do to the console."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click
from click.core import ParameterSource

from plcgen.base.files.files import YAML_SUFFIXES
from plcgen.cli.completed import devices
from plcgen.cli.output import Console

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from plcgen.report.registry import OutputFormat

Callback = TypeVar("Callback", bound=Callable[..., Any])

_CONTEXT: dict[str, Any] = {"help_option_names": ["-h", "--help"], "max_content_width": 100}
CONFIGURED = frozenset({"check", "generate", "verify", "review", "diff", "lock"})
"""Verbs whose defaults ``plcgen.toml`` may set."""
_SOURCES = frozenset({".scl", ".udt", ".db", ".awl", ".stl", ".sdf", ".asc"})


class _NamedPath(click.Path):
    """A path that is not empty: an empty one would silently mean the current folder."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if value == "":
            self.fail("the path is empty", param, ctx)
        return super().convert(value, param, ctx)


PATH = _NamedPath(path_type=Path, readable=False)
"""What cannot be read is a problem of the file, not of the command line."""


def _quiet(ctx: click.Context, _param: click.Parameter, value: bool) -> None:  # noqa: FBT001 - click's signature
    if value:
        ctx.ensure_object(Console).quiet = True


def _force(ctx: click.Context, _param: click.Parameter, value: bool) -> None:  # noqa: FBT001 - click's signature
    if value:
        ctx.ensure_object(Console).force = True


def _color(ctx: click.Context, _param: click.Parameter, value: Any) -> None:
    if value:
        ctx.ensure_object(Console).color = value


def common_options() -> list[click.Parameter]:
    """``--quiet`` and ``--color``, which work before and behind the verb."""
    return [
        click.Option(
            ["-q", "--quiet"], is_flag=True, expose_value=False, callback=_quiet, help="Show only diagnostics."
        ),
        click.Option(
            ["--color"],
            type=click.Choice(["auto", "always", "never"]),
            metavar="WHEN",
            expose_value=False,
            callback=_color,
            help="Colours: auto (terminal, no NO_COLOR), always, never.",
        ),
    ]


class Examples(click.Command):
    """A command with the common options whose help ends with examples, printed as they are."""

    def __init__(self, *args: Any, examples: Sequence[str] = (), **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.context_settings = dict(_CONTEXT)
        self.params += common_options()
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

    def make_context(
        self, info_name: str | None, args: list[str], parent: click.Context | None = None, **extra: Any
    ) -> click.Context:
        """Take what the command line does not say from ``plcgen.toml``, except for help."""
        if info_name in CONFIGURED and not {"-h", "--help"} & set(args):
            from plcgen.cli.config import configured

            extra["default_map"], weak = configured(info_name)
            ctx = super().make_context(info_name, args, parent, **extra)
            used = [param for param in weak if ctx.get_parameter_source(param) is ParameterSource.DEFAULT_MAP]
            ctx.ensure_object(Console).weakened = tuple(weak[param] for param in used)
            return ctx
        return super().make_context(info_name, args, parent, **extra)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the verb, unless its result would overwrite one of its inputs, or what is somebody's input elsewhere."""
        target = ctx.params.get("output") or ctx.params.get("path")
        if isinstance(target, Path) and target.is_file():
            for name, value in ctx.params.items():
                read = value if isinstance(value, tuple) else (value,)
                if name in {"output", "path"}:
                    continue
                for path in read:
                    if isinstance(path, Path) and _would_destroy(target, path):
                        raise click.UsageError(f"{target} is a source that is read: write the result elsewhere", ctx)
        output = ctx.params.get("output")
        if isinstance(output, Path) and output.is_file() and _is_source(output):
            raise click.UsageError(f"{output} is a spec or a source: write the result elsewhere", ctx)
        if isinstance(output, Path):
            ctx.ensure_object(Console).replaceable(output)  # before any work is done
        return super().invoke(ctx)


def verb(name: str, *examples: str, help: str | None = None) -> Callable[[Callable[..., int]], click.Command]:  # noqa: A002
    """Make a verb of a function that takes its parameters by name; the help is its docstring if it is not given."""
    return click.command(name, cls=Verb, examples=examples, help=help)


def _is_source(target: Path) -> bool:
    """Whether a file is a spec or a PLC source, or one of those that plcgen generated into a folder."""
    if target.suffix.lower() in _SOURCES | YAML_SUFFIXES:
        return True
    from plcgen.s7.read.generated import MANIFEST, manifest_of

    path = target.resolve()
    known = ((manifest_of(folder) or {}, path.relative_to(folder).as_posix()) for folder in path.parents[:2])
    return any(name in files or (files and name == MANIFEST) for files, name in known)


def _would_destroy(target: Path, read: Path) -> bool:
    """Whether an existing file is ``read``, or a PLC source below the folder ``read``."""
    try:
        if not read.is_dir():
            return target.samefile(read)
        inside = target.resolve().is_relative_to(read.resolve())
    except OSError:
        return False
    return inside and target.suffix.lower() in _SOURCES


def strict_option(verb: Callback) -> Callback:
    """Add ``--strict``."""
    return click.option("--strict", is_flag=True, help="Treat facts for which no document was found as errors.")(verb)


def output_option(*more: str) -> Callable[[Callback], Callback]:
    """Add ``--output FILE``, which may have ``more`` names, and ``--force``, which the console keeps."""
    option = click.option(
        "-o", *more, "--output", "output", type=PATH, metavar="FILE", help="Write the result to FILE instead of stdout."
    )
    return lambda verb: option(force_option("Overwrite a FILE that plcgen did not write.")(verb))


def force_option(what: str) -> Callable[[Callback], Callback]:
    """Add ``--force``, which lets the console replace any file."""
    return click.option("--force", is_flag=True, expose_value=False, callback=_force, help=what)


def device_option(
    help_: str = "Device profile, or the path of one.", **settings: Any
) -> Callable[[Callback], Callback]:
    """Add ``--device``, which completes the names of devices; ``settings`` are those of click."""
    return click.option("--device", metavar="DEVICE", shell_complete=devices, help=help_, **settings)


def faults_option(default: str | None = "quick", told: str = "quick") -> Callable[[Callback], Callback]:
    """Add ``--faults``; ``told`` is the default as the help says it."""
    from plcgen.proof.effort import FAULTS

    help_ = f"How many faults the generated SCL runs through.  [default: {told}]"
    return click.option("--faults", type=click.Choice(FAULTS), default=default, help=help_)


def folder_option(what: str) -> Callable[[Callback], Callback]:
    """Add ``--out DIR`` for the generated files of a spec; the parameter is called ``folder``."""
    help_ = f"{what}.  [default: <spec>_generated beside the spec]"
    return click.option("--out", "folder", type=PATH, metavar="DIR", help=help_)


_JSON = "plcgen.json"
"""Where a call remembers that ``--json`` was given."""

if TYPE_CHECKING:
    _ParamType = click.ParamType[Any]
else:
    _ParamType = click.ParamType  # generic from click 8.4 on


class _FormatName(_ParamType):
    """Name of a format that shows a kind of result; which there are is looked up when somebody asks."""

    name = "format"

    def __init__(self, kind: str) -> None:
        self.kind = kind

    @property
    def names(self) -> tuple[str, ...]:
        from plcgen.report import registry

        return registry.formats_for(self.kind)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> OutputFormat:
        """The format itself."""
        from plcgen.report.registry import OutputFormat, output_format

        if isinstance(value, OutputFormat):
            return value
        found = output_format(value)
        if found is None or not found.shows(self.kind):
            self.fail(f"{value!r} is not one of {', '.join(map(repr, self.names))}.", param, ctx)
        return found

    def shell_complete(self, _ctx: click.Context, _param: click.Parameter, incomplete: str) -> list[CompletionItem]:
        """Names that begin like what is typed."""
        from click.shell_completion import CompletionItem

        return [CompletionItem(name) for name in self.names if name.startswith(incomplete)]


class _FormatOption(click.Option):
    """``--format``, whose help names the formats that there are."""

    def get_help_record(self, ctx: click.Context) -> tuple[str, str] | None:
        """Look them up."""
        if isinstance(self.type, _FormatName):
            self.help = f"One of {', '.join(self.type.names)}.  [default: {self.default}]"
        return super().get_help_record(ctx)


class _ToolchainOption(click.Option):
    """``--toolchain``, which was ``--tia`` until 0.2.0: that name still works and is not shown."""

    def get_help_record(self, ctx: click.Context) -> tuple[str, str] | None:
        """Without the old name."""
        record = super().get_help_record(ctx)
        return (record[0].replace(", --tia", ""), record[1]) if record is not None else None


def _document_version(ctx: click.Context, param: click.Parameter, value: str) -> str:
    """Version of the documents of a toolchain."""
    from plcgen.project.target import XML_VERSIONS, toolchain_id

    found = XML_VERSIONS.get(toolchain_id(value))
    if found is None:
        raise click.BadParameter(f'"{value}" is not one of {", ".join(XML_VERSIONS)}', ctx, param)
    return found


def toolchain_option(what: str) -> Callable[[Callback], Callback]:
    """Add ``--toolchain``, the tool that documents are for; the parameter ``version`` is theirs."""
    return click.option(
        "--toolchain",
        "--tia",
        "version",
        cls=_ToolchainOption,
        default="tia-v16",
        show_default=True,
        metavar="TOOL",
        callback=_document_version,
        help=f"{what}: tia-v14sp1, tia-v15 .. tia-v21.",
    )


def format_option(kind: str, default: str = "text") -> Callable[[Callback], Callback]:
    """Add ``--format`` for a kind of result, and ``--json`` as its short form; the parameter is called ``format_``."""
    type_ = _FormatName(kind)

    def chosen(ctx: click.Context, param: click.Parameter, value: OutputFormat) -> OutputFormat:
        return type_.convert("json", param, ctx) if ctx.meta.get(_JSON) else value

    name = click.option(
        "-f", "--format", "format_", cls=_FormatOption, type=type_, default=default, metavar="FORMAT", help=" ",
        callback=chosen,
    )  # fmt: skip
    # eager and without a parameter of its own: what two options of one name mean differs between versions of click
    short = click.option(
        "--json",
        is_flag=True,
        is_eager=True,
        expose_value=False,
        callback=_json_asked,
        help="The same as --format json.",
    )
    return lambda verb: name(short(verb))


def _json_asked(ctx: click.Context, _param: click.Parameter, value: bool) -> None:  # noqa: FBT001 - the face of click
    ctx.meta[_JSON] = value


def stream_option(verb: Callback) -> Callback:
    """Add ``--json`` for verbs that tell events as they come; the parameter is called ``as_json``."""
    return click.option("--json", "as_json", is_flag=True, help="Write JSON for programs.")(verb)


def console() -> Console:
    """Return the console of this call."""
    return click.get_current_context().ensure_object(Console)
