"""Completion for Windows PowerShell 5.1 and PowerShell 7, which click does not bring."""

from __future__ import annotations

import os

from click.shell_completion import CompletionItem, ShellComplete, add_completion_class

NAME = "powershell"
_WORDS, _CURRENT = "COMP_WORDS", "COMP_CURRENT"

_SCRIPT = """\
Register-ArgumentCompleter -Native -CommandName %(prog_name)s -ScriptBlock {
    param($wordToComplete, $commandAst, $cursorPosition)
    $before = @($commandAst.CommandElements | Where-Object { $_.Extent.EndOffset -lt $cursorPosition })
    $env:%(complete_var)s = 'powershell_complete'
    $env:COMP_WORDS = ($before | ForEach-Object { $_.ToString() }) -join "`n"
    $env:COMP_CURRENT = $wordToComplete
    try {
        %(prog_name)s | ForEach-Object {
            $kind, $value, $text = $_ -split "`t", 3
            if ($kind -eq 'plain') {
                [System.Management.Automation.CompletionResult]::new($value, $value, 'ParameterValue', $text)
            }
        }
    } finally {
        Remove-Item Env:%(complete_var)s, Env:COMP_WORDS, Env:COMP_CURRENT -ErrorAction SilentlyContinue
    }
}
"""


class PowerShellComplete(ShellComplete):
    """Words before the cursor come one per line; each answer is kind, value and text with tabs between them.

    An answer of files is left to PowerShell, which completes names of files if nothing else is offered.
    """

    name = NAME
    source_template = _SCRIPT

    def get_completion_args(self) -> tuple[list[str], str]:
        """The words before the one at the cursor, without the program's name, and that one as far as it is typed."""
        words = [word.strip("'\"") for word in os.environ.get(_WORDS, "").splitlines()]
        return words[1:], os.environ.get(_CURRENT, "").strip("'\"")

    def format_completion(self, item: CompletionItem) -> str:
        """One line of the answer; a tool tip must not be empty."""
        text = " ".join((item.help or str(item.value)).split())
        return f"{item.type}\t{item.value}\t{text}"


def register() -> None:
    """Make click know it."""
    add_completion_class(PowerShellComplete)
