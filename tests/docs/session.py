"""Running the blocks of a page, one after the other, in one folder."""

from __future__ import annotations

import contextlib
import io
import os
import re
import socket
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.docs.pages import ROOT, Block

PORT_OF_THE_PAGES = "10222"
"""The pages serve at this TCP port; a test takes a free one instead."""


_PRINTED = re.compile(r"^ *print\(.+\)  # (.+)$", re.MULTILINE)


class Session:
    """A shell, a Python and a folder for one page."""

    def __init__(self, folder: Path, verdicts: Path, tool: Path | None) -> None:
        """``folder`` is empty and becomes the current one of everything that runs; ``verdicts`` are kept for others.

        ``tool`` is the folder of the ``plcgen`` of the commands; without it, Python starts for each. Servers always
        are what Python started.
        """
        self._folder = folder
        self._names: dict[str, Any] = {"__name__": "page"}
        self._servers: list[subprocess.Popen[str]] = []
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self._port = str(free.getsockname()[1])
        started = folder.parent / "bin"
        started.mkdir()
        (started / "plcgen").write_text(f'#!/bin/sh\nexec "{sys.executable}" -m plcgen "$@"\n')
        (started / "plcgen").chmod(0o755)
        self._paths = [f"{bin_}{os.pathsep}{os.environ['PATH']}" for bin_ in (tool or started, started)]
        self._environment = {
            **os.environ,
            "PATH": self._paths[0],
            "PYTHONPATH": str(ROOT),
            "COLUMNS": "100",
            "REPO": str(ROOT),
            "PLCGEN_CACHE": str(verdicts),
        }

    def run(self, block: Block) -> None:
        """Do what the block shows; AssertionError if something else happens."""
        if "not run" in block.notes:
            return
        if "setup" in block.notes:
            self._expect(block, block.notes["setup"], "", 0)
        if block.notes.get("server"):
            self._serve(block.notes["server"])
        if "file" in block.notes:
            path = self._folder / block.notes["file"]
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(block.text, encoding="utf-8")
        elif block.language == "python":
            self._python(block)
        commands = block.commands
        if commands and block.notes.get("server") == "":
            self._serve(commands.pop(0)[0])
        codes = [int(code) for code in block.notes["exit"].split()] if "exit" in block.notes else [0] * len(commands)
        for (command, output), code in zip(commands, codes, strict=True):
            self._expect(block, command, output, code)

    def _expect(self, block: Block, command: str, output: str, code: int) -> None:
        """The command ends as it should and prints what the page shows; a line of dots stands for any lines."""
        done = subprocess.run(
            ["bash", "-euc", self._local(command)],
            cwd=self._folder,
            env=self._environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            stdin=subprocess.DEVNULL,
            text=True,
            check=False,
            timeout=240,
        )
        assert done.returncode == code, f"{block.place}: $ {command}\nexit code {done.returncode}\n{done.stdout}"
        lines = self._local(output).splitlines(keepends=True)
        wanted = "".join(r"(?:.*\n)*?" if line == "...\n" else re.escape(line) for line in lines)
        shown = f"{block.place}: $ {command}\n{done.stdout}\ninstead of\n{output}"
        assert not output or re.fullmatch(wanted, done.stdout), shown

    def _python(self, block: Block) -> None:
        """Execute the block where those before it left off, then the tests that it defines.

        What a comment behind ``print(..)`` says must be among the printed lines.
        """
        known = set(self._names)
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile("\n" * block.line + self._local(block.text), block.page, "exec"), self._names)  # noqa: S102 - ours
        missing = set(_PRINTED.findall(block.text)) - set(printed.getvalue().splitlines())
        assert not missing, f"{block.place} printed\n{printed.getvalue()}and not {missing}"
        for name in sorted(set(self._names) - known):
            if name.startswith("test_"):
                test: Callable[..., None] = self._names[name]
                test(*[self._folder][: test.__code__.co_argcount])  # tmp_path, if it asks for one

    def _serve(self, command: str) -> None:
        """Start a command and wait for its first line: it listens."""
        server = subprocess.Popen(
            ["bash", "-euc", f"exec {self._local(command)}"],
            cwd=self._folder,
            env={**self._environment, "PATH": self._paths[1]},
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        self._servers.append(server)
        assert server.stdout is not None
        assert server.stdout.readline(), f"{command} ended"

    def _local(self, text: str) -> str:
        return text.replace(PORT_OF_THE_PAGES, self._port)

    def close(self) -> None:
        """End what still runs."""
        for server in self._servers:
            server.terminate()
            server.communicate(timeout=10)
