"""``plcgen`` that starts fast: a process has imported it, has run nothing of it, and forks for every call.

A call is a process of its own with the arguments, folder, environment and streams of its caller and with an exit code
of its own; all it does not do is import. How plcgen starts is for tests that start Python: ``tests/cli/test_main.py``
and the commands of docs/tutorial.md.
"""

from __future__ import annotations

import gc
import importlib
import json
import os
import pkgutil
import select
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import plcgen

ROOT = Path(__file__).parents[2]
TOOL = """\
#!{python} -IS
import json, os, socket, sys

asked = json.dumps((sys.argv[1:], os.getcwd(), dict(os.environ))).encode()
os.chdir({tools!r})  # the path of a socket must be short
with socket.socket(socket.AF_UNIX) as call:
    call.connect("calls")
    socket.send_fds(call, [asked], [0, 1, 2])
    call.shutdown(socket.SHUT_WR)
    code = json.loads(call.recv(99))
if code < 0:
    os.kill(os.getpid(), -code)
sys.exit(code)
"""
STREAMS = ("stdin", "stdout", "stderr")
READ_AT_THE_START = ("PYTHON", "LANG", "LC_", "TZ")
"""Beginnings of the variables that a running Python does not look at again."""


@contextmanager
def forking(tools: Path) -> Iterator[None]:
    """Put ``plcgen`` into a folder; it works until the end of the context."""
    command, environment = [sys.executable, "-P", __file__], {**os.environ, "PYTHONPATH": str(ROOT)}
    server = subprocess.Popen(command, cwd=tools, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    assert server.stdin is not None
    assert server.stdout is not None
    assert server.stdout.read(1), "the server has ended"
    tool = tools / "plcgen"
    tool.write_text(TOOL.format(python=sys.executable, tools=str(tools)), "utf-8")
    tool.chmod(0o755)
    yield
    server.stdin.close()
    server.stdout.close()
    assert server.wait(10) == 0


def serve() -> None:
    """Import plcgen and listen, until standard input ends."""
    for module in pkgutil.walk_packages(plcgen.__path__, "plcgen."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
    importlib.import_module("lxml.etree")
    importlib.import_module("yaml")
    os.cpu_count = lambda: 1  # the tests share out the cores among themselves
    with socket.socket(socket.AF_UNIX) as calls:
        calls.bind("calls")
        calls.listen()
        os.write(1, b"!")
        gc.collect()
        gc.freeze()
        while sys.stdin not in select.select([calls, sys.stdin], [], [])[0]:
            with suppress(ChildProcessError):
                while os.waitpid(-1, os.WNOHANG)[0]:
                    pass
            call = calls.accept()[0]
            if os.fork() == 0:
                calls.close()
                answer(call)
                return
            call.close()


def answer(call: socket.socket) -> None:
    """In a child: run what is asked for in a child of its own, and say how that ended."""
    text, streams, *_ = socket.recv_fds(call, 1 << 20, len(STREAMS))
    while more := call.recv(1 << 20):
        text += more
    arguments, folder, environment = json.loads(text)
    own, theirs = (
        {name: value for name, value in variables.items() if name.startswith(READ_AT_THE_START)}
        for variables in (os.environ, environment)
    )
    assert own == theirs, "a Python has to be started for other values of these"
    child = os.fork()
    if child == 0:
        call.close()
        run(arguments, folder, environment, streams)
    call.sendall(json.dumps(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])).encode())
    os._exit(0)


def run(arguments: list[str], folder: str, environment: dict[str, str], streams: list[int]) -> None:
    """Become ``plcgen`` with these arguments."""
    for number, (name, stream) in enumerate(zip(STREAMS, streams, strict=True)):
        os.dup2(stream, number)
        os.close(stream)
        old = getattr(sys, name)
        new = open(number, old.mode, 1 if number == 2 else -1, old.encoding, old.errors, closefd=False)  # noqa: SIM115
        setattr(sys, name, new)
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    sys.argv[1:] = arguments
    from plcgen.__main__ import main

    sys.exit(main())


if __name__ == "__main__":
    serve()
