"""``plcgen serve`` on the command line: where it listens, how it ends, what it says when it cannot begin."""

from __future__ import annotations

import http.client
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from plcgen.cli import serve
from plcgen.cli.main import run
from tests.projects import ROOT

COMMAND = [sys.executable, "-m", "plcgen", "serve", "--no-browser"]


def test_without_the_extra_one_line_installs_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Exit code 2, and the line."""
    monkeypatch.setattr(serve, "find_spec", lambda name: None if name == "uvicorn" else object())
    assert run(["serve", str(tmp_path), "--no-browser"]) == 2
    assert "pip install starlette uvicorn" in capsys.readouterr().err


def test_a_folder_is_needed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """One that is there."""
    assert run(["serve", str(tmp_path / "nowhere"), "--no-browser"]) == 2
    assert "there is no folder" in capsys.readouterr().err


def test_a_port_that_is_taken_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """With its number; no traceback, exit code 1."""
    pytest.importorskip("uvicorn", reason="the extra serve is not installed")
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        assert run(["serve", str(tmp_path), "--no-browser", "--port", str(port)]) == 1
    assert f"port {port} cannot be used" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGINT for one process")
def test_it_listens_on_this_machine_alone_until_ctrl_c(tmp_path: Path) -> None:
    """The address is printed first, answers with the page, and Ctrl-C is the end without an error."""
    pytest.importorskip("uvicorn", reason="the extra serve is not installed")
    with subprocess.Popen([*COMMAND, str(tmp_path)], stdout=subprocess.PIPE, text=True, cwd=ROOT) as process:
        assert process.stdout is not None
        address = process.stdout.readline().strip()
        assert address.startswith("http://127.0.0.1:")
        host, _, path = address.removeprefix("http://").partition("/")
        connection = http.client.HTTPConnection(host, timeout=20)
        try:
            connection.request("GET", f"/{path}")
            found = connection.getresponse().read()
        finally:
            connection.close()
            process.send_signal(signal.SIGINT)
        assert b"page/app.js" in found
        assert process.wait(30) == 0
