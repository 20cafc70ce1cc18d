"""Who may ask: this machine, with the token of the address, from the page itself; and how much at once.

A page of another site can send requests to this server, and a name of its own can point to this machine (DNS
rebinding). Neither knows the token; the first is refused by Origin and Fetch Metadata, the second by Host.
"""

from __future__ import annotations

import secrets

from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

MAX_BODY = 16 * 1024 * 1024
"""Bytes of a request; what the tools of the page read has the same bound."""
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self' 'nonce-{nonce}'; img-src 'self' data:; "
    "connect-src 'self'; frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
FRAMED = "sandbox allow-scripts allow-modals allow-downloads; frame-ancestors 'self'"
"""Of the pages that ``plcgen.report`` makes: the rest of their policy stands in themselves."""
_ALWAYS = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
}


class Guard:
    """Lets through what comes from the page at ``http://127.0.0.1:port/token/`` and nothing else."""

    def __init__(self, app: ASGIApp, token: str, port: int) -> None:
        self._app, self._root = app, f"/{token}"
        self._hosts = {f"127.0.0.1:{port}", f"localhost:{port}"}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, or refuse it. There are no WebSockets."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        if scope["type"] != "http":
            return
        nonce = secrets.token_urlsafe(12)
        refused = self._refusal(scope)
        if refused is not None:
            await PlainTextResponse(refused[1], refused[0], headers=_ALWAYS)(scope, receive, send)
            return
        scope = {**scope, "root_path": self._root, "nonce": nonce}

        async def answer(message: Message) -> None:
            if message["type"] == "http.response.start":
                names = {name.lower() for name, _ in message["headers"]}
                more = {**_ALWAYS, "Content-Security-Policy": POLICY.format(nonce=nonce)}
                message["headers"] += [
                    (name.lower().encode(), text.encode())
                    for name, text in more.items()
                    if name.lower().encode() not in names
                ]
            await send(message)

        await self._app(scope, receive, answer)

    def _refusal(self, scope: Scope) -> tuple[int, str] | None:
        """Status and reason of a request that is not answered."""
        headers: dict[str, str] = {name.decode("latin-1"): text.decode("latin-1") for name, text in scope["headers"]}
        host = headers.get("host", "")
        if host not in self._hosts:
            return 421, "this server is known as 127.0.0.1 and localhost only"
        path: str = scope["path"]
        token, _, _ = path.removeprefix("/").partition("/")
        if not secrets.compare_digest(token.encode(), self._root.removeprefix("/").encode()):
            return 404, "not found: open the address that plcgen serve has printed"
        reading = scope["method"] in {"GET", "HEAD"}
        origin = headers.get("origin")
        if origin is not None and origin != f"http://{host}":
            return 403, "a page of another origin has asked"
        if not reading and origin is None:
            return 403, "a request that changes something must say its origin"
        if not reading and headers.get("content-type", "").partition(";")[0] != "application/json":
            return 415, "the body must be JSON"
        site, mode = headers.get("sec-fetch-site", "same-origin"), headers.get("sec-fetch-mode", "")
        if site not in {"same-origin", "none"} and not (reading and mode == "navigate"):
            return 403, "a page of another site has asked"
        if (
            int(headers.get("content-length") or 0) > MAX_BODY
            if headers.get("content-length", "0").isdecimal()
            else True
        ):
            return 413, "the request is too large"
        return None
