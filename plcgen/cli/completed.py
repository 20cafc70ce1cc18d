"""What the Tab key offers as values: devices, toolchains, diagnostic codes. Looked up when somebody asks."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import click
    from click.shell_completion import CompletionItem


def devices(_ctx: click.Context, _param: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Device profiles with their titles."""
    from click.shell_completion import CompletionItem

    from plcgen.ds47.devices import device_names, find_device

    names = [name for name in device_names() if name.startswith(incomplete.lower())]
    return [CompletionItem(name, help=find_device(name).title) for name in names]


def toolchains(_ctx: click.Context, _param: click.Parameter, incomplete: str) -> list[str]:
    """Names of toolchains."""
    from typing import get_args

    from plcgen.project.schema import Toolchain

    return [name for name in get_args(Toolchain) if name.startswith(incomplete.lower())]


def codes(_ctx: click.Context, _param: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Diagnostic codes with their titles."""
    from click.shell_completion import CompletionItem

    from plcgen.api.explanation import list_codes

    return [CompletionItem(code, help=title) for code, _, title in list_codes() if code.startswith(incomplete.upper())]


def pages(_ctx: click.Context, _param: click.Parameter, incomplete: str) -> list[str]:
    """Pages of the documentation."""
    from plcgen.base.resources import documented

    return [name for name in documented() if name.startswith(incomplete)]
