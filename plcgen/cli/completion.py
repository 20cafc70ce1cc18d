"""``plcgen completion``: the completion script of a shell."""

from __future__ import annotations

import click

from plcgen.cli.options import console, verb
from plcgen.cli.output import OK


@verb(
    "completion",
    'bash:  eval "$(plcgen completion bash)"          in ~/.bashrc',
    'zsh:   eval "$(plcgen completion zsh)"           in ~/.zshrc',
    "powershell:  plcgen completion powershell | Out-String | Invoke-Expression    in $PROFILE",
    "fish:  plcgen completion fish > ~/.config/fish/completions/plcgen.fish",
)
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish", "powershell"]))
def command(*, shell: str) -> int:
    """Print the script that completes verbs, options and files with the Tab key."""
    from click.shell_completion import get_completion_class

    from plcgen.cli.main import cli
    from plcgen.cli.powershell import register

    register()
    made = get_completion_class(shell)
    if made is None:
        raise click.UsageError(f"no completion for {shell}")
    script = made(cli, {}, "plcgen", "_PLCGEN_COMPLETE")
    console().result(script.source_template % script.source_vars())
    return OK
