"""A client of the YAML language server that editors use: what it underlines, and what it offers at a place."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

PROGRAM = os.environ.get("YAML_LANGUAGE_SERVER") or shutil.which("yaml-language-server")
_CURSOR = "▮"


class YamlServer:
    """A running server; texts get the schema of the file ``schema``, and every request waits for its answer."""

    def __init__(self, process: subprocess.Popen[bytes], schema: Path) -> None:
        self.process, self.schema, self.number, self.files = process, schema, 0, 0
        capabilities = {"workspace": {"configuration": True}}
        self.request("initialize", {"processId": None, "rootUri": None, "capabilities": capabilities})
        self.send("initialized", {})

    def send(self, method: str, params: Any, **more: Any) -> None:
        """A notification, or with ``id`` a request."""
        self._write({"method": method, "params": params, **more})

    def _write(self, message: dict[str, Any]) -> None:
        data = json.dumps({"jsonrpc": "2.0", **message}).encode()
        assert self.process.stdin is not None
        self.process.stdin.write(f"Content-Length: {len(data)}\r\n\r\n".encode() + data)
        self.process.stdin.flush()

    def read(self) -> dict[str, Any]:
        """The next message; questions for settings are answered on the way."""
        stream = self.process.stdout
        assert stream is not None
        length = 0
        while line := stream.readline().strip():
            name, _, value = line.partition(b":")
            length = int(value) if name.lower() == b"content-length" else length
        assert length, "the server has ended"
        message: dict[str, Any] = json.loads(stream.read(length))
        if "id" in message and "method" in message:
            settings = {"validate": True, "completion": True, "hover": True, "schemaStore": {"enable": False}}
            asked = message["params"].get("items", []) if message["method"] == "workspace/configuration" else []
            found = [{**settings} if each.get("section") == "yaml" else {} for each in asked]
            self._write({"id": message["id"], "result": found if asked else None})
        return message

    def request(self, method: str, params: Any) -> Any:
        """The answer to a request."""
        self.number += 1
        self.send(method, params, id=self.number)
        while True:
            message = self.read()
            if message.get("id") == self.number and "method" not in message:
                assert "error" not in message, message
                return message["result"]

    def opened(self, text: str) -> tuple[str, list[dict[str, Any]]]:
        """Open a text as a file of its own; its name, and what the server underlines."""
        self.files += 1
        uri = f"file:///open/{self.files}.yaml"
        head = f"# yaml-language-server: $schema={self.schema.as_uri()}\n"
        document = {"uri": uri, "languageId": "yaml", "version": 1, "text": head + text}
        self.send("textDocument/didOpen", {"textDocument": document})
        while True:
            message = self.read()
            if message.get("method") == "textDocument/publishDiagnostics" and message["params"]["uri"] == uri:
                return uri, message["params"]["diagnostics"]

    def underlined(self, text: str) -> list[tuple[int, str]]:
        """Line from 1 and message of everything wrong with a text."""
        return [(each["range"]["start"]["line"], each["message"]) for each in self.opened(text)[1]]

    def offered(self, text: str) -> list[str]:
        """What is offered at ▮."""
        before, _, after = text.partition(_CURSOR)
        uri, _ = self.opened(before + after)
        place = {"line": before.count("\n") + 1, "character": len(before.rpartition("\n")[2])}
        found = self.request("textDocument/completion", {"textDocument": {"uri": uri}, "position": place})
        return [each["label"] for each in (found["items"] if isinstance(found, dict) else found)]

    def explained(self, text: str) -> str:
        """What is shown over ▮."""
        before, _, after = text.partition(_CURSOR)
        uri, _ = self.opened(before + after)
        place = {"line": before.count("\n") + 1, "character": len(before.rpartition("\n")[2])}
        found = self.request("textDocument/hover", {"textDocument": {"uri": uri}, "position": place})
        return "" if found is None else json.dumps(found["contents"], ensure_ascii=False)


@contextmanager
def yaml_server(schema: Path) -> Iterator[YamlServer]:
    """A server with one schema for all texts."""
    assert PROGRAM is not None
    command = [PROGRAM, "--stdio"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as process:
        try:
            yield YamlServer(process, schema)
        finally:
            process.kill()
