"""Requests to the server without a network: exactly the headers and the path that a test says."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("starlette", reason="the extra serve is not installed")

from plcgen.workbench.serve.app import application

TOKEN, PORT = "secret-of-the-address", 8123
OWN = f"http://127.0.0.1:{PORT}"
USUAL = {
    "host": f"127.0.0.1:{PORT}",
    "origin": OWN,
    "sec-fetch-site": "same-origin",
    "content-type": "application/json",
}


@dataclass
class Answer:
    """What came back."""

    status: int = 0
    headers: dict[str, str] = field(default_factory=dict)
    data: bytes = b""

    @property
    def text(self) -> str:
        """As text."""
        return self.data.decode()

    def json(self) -> Any:
        """As data."""
        return json.loads(self.data)


class Server:
    """The server of a folder."""

    def __init__(self, folder: Path) -> None:
        self.app = application(folder, TOKEN, PORT, folder.parent / "bench")

    def request(
        self, method: str, path: str, pieces: Iterable[bytes] = (b"",), headers: Mapping[str, str | None] | None = None
    ) -> Answer:
        """One request; a header that is None is left out."""
        sent = {name: text for name, text in {**USUAL, **(headers or {})}.items() if text is not None}
        scope = {
            "type": "http", "asgi": {"version": "3.0"}, "http_version": "1.1", "method": method, "scheme": "http",
            "path": path, "raw_path": path.encode(), "query_string": b"", "root_path": "", "client": ("127.0.0.1", 1),
            "server": ("127.0.0.1", PORT), "headers": [(name.encode(), text.encode()) for name, text in sent.items()],
        }  # fmt: skip
        answer, body = Answer(), list(pieces)

        async def receive() -> dict[str, Any]:
            piece = body.pop(0) if body else b""
            return {"type": "http.request", "body": piece, "more_body": bool(body)}

        async def send(message: Any) -> None:
            if message["type"] == "http.response.start":
                answer.status = message["status"]
                answer.headers = {name.decode(): text.decode() for name, text in message["headers"]}
            else:
                answer.data += message.get("body", b"")

        asyncio.run(self.app(scope, receive, send))
        return answer

    def get(self, path: str, **headers: str | None) -> Answer:
        """A page or a file; ``_`` in a name of a header stands for ``-``."""
        return self.request("GET", path, headers={name.replace("_", "-"): text for name, text in headers.items()})

    def ask(self, question: str, given: Mapping[str, Any] | None = None) -> Answer:
        """A question of the page."""
        return self.request("POST", f"/{TOKEN}/ask/{question}", [json.dumps(given or {}).encode()])

    def told(self, question: str, given: Mapping[str, Any] | None = None) -> Any:
        """Its answer, which is no refusal."""
        found = self.ask(question, given)
        assert found.status == 200, found.text
        return found.json()
