"""The server: the page, its files, and one address for every question."""

from __future__ import annotations

import secrets
import socket
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from anyio import to_thread
from pydantic import ValidationError
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, Response
from starlette.routing import Route

from plcgen.base.diagnostics import ArgumentError, DiagnosticError, PlcgenError
from plcgen.workbench.serve import becomes, desk
from plcgen.workbench.serve.desk import Body, Desk
from plcgen.workbench.serve.guard import FRAMED, MAX_BODY, Guard
from plcgen.workbench.serve.page import FOLDER, asset
from plcgen.workbench.serve.room import Room
from plcgen.workbench.serve.spec import problem_data

if TYPE_CHECKING:
    from starlette.types import ASGIApp

Answer = Callable[[Any], dict[str, Any]]


def questions(one: Desk) -> dict[str, tuple[type[Body], Answer]]:
    """By name: what a question may be given, and who answers it."""
    known: tuple[tuple[type[Body], Answer], ...] = (
        (desk.Nothing, one.folder), (desk.File, one.read), (desk.Save, one.save), (desk.New, one.new),
        (desk.Text, one.check), (desk.At, one.complete), (desk.At, one.hover), (desk.At, one.rename),
        (desk.Text, one.format), (desk.Search, one.search), (desk.Partner, one.kinds), (desk.Change, one.change),
        (desk.Text, one.becomes), (desk.Part, one.part), (desk.Text, one.tags), (desk.Write, one.write),
        (desk.Load, one.load), (desk.Steps, one.step), (desk.Words, one.put), (desk.Strike, one.strike),
        (desk.Withdraw, one.withdraw),
        (desk.Prove, one.verify), (desk.Against, one.review), (desk.Again, one.replay),
        (desk.File, one.bases), (desk.Nothing, one.state), (desk.Nothing, one.cancel),
        (desk.Text, one.lock), (desk.Save, one.relock), (desk.Lists, one.texts),
        (desk.Files, one.look), (desk.Audit, one.audit), (desk.Words, one.explain),
        (desk.Files, one.layout), (desk.Pair, one.diff), (desk.Convert, one.convert),
    )  # fmt: skip
    return {answer.__name__: (shape, answer) for shape, answer in known}


def application(folder: Path, token: str, port: int, bench: Path) -> ASGIApp:
    """The server of a folder, reached at ``/token/`` of the port; ``bench`` is a folder of its own."""
    one = Desk(Room(folder), bench)
    known = questions(one)

    async def page(request: Request) -> Response:
        text = (FOLDER / "page.html").read_text("utf-8")
        return HTMLResponse(text.replace("{nonce}", request.scope["nonce"]))

    async def file(request: Request) -> Response:
        found = asset(request.path_params["name"])
        return Response("not found", 404) if found is None else Response(found[0], media_type=found[1])

    async def ask(request: Request) -> Response:
        question = known.get(request.path_params["name"])
        if question is None:
            return JSONResponse({"problems": []}, 404)
        shape, answer = question
        return await _answered(request, shape, answer, one.room)

    async def made(request: Request) -> Response:
        text = one.pages.get(request.path_params["number"])
        policy = {"Content-Security-Policy": FRAMED}
        return Response("not found", 404) if text is None else HTMLResponse(text, headers=policy)

    async def archive(request: Request) -> Response:
        def zipped(asked: desk.Text) -> dict[str, Any]:
            path = one.room.find(asked.name)
            return {"data": becomes.zipped(one.made(asked), path), "name": f"{path.stem}.zip"}

        return await _answered(request, desk.Text, zipped, one.room)

    routes = [
        Route("/", page),
        Route("/page/{name}", file),
        Route("/ask/{name}", ask, methods=["POST"]),
        Route("/made/{number:int}", made),
        Route("/zip", archive, methods=["POST"]),
    ]
    return Guard(Starlette(routes=routes), token, port)


async def _answered(request: Request, shape: type[Body], answer: Answer, room: Room) -> Response:
    """The answer of a thread: some take long, and the page asks for others meanwhile."""
    body = bytearray()
    async for piece in request.stream():
        body += piece
        if len(body) > MAX_BODY:  # whatever length was announced
            return JSONResponse({"problems": [{"message": "the request is too large", "severity": "error"}]}, 413)
    try:
        asked = shape.model_validate_json(body)
    except ValidationError as problem:
        return JSONResponse({"problems": [{"message": str(problem.errors()[0]["msg"]), "severity": "error"}]}, 400)
    try:
        found = await to_thread.run_sync(answer, asked)
    except DiagnosticError as problem:
        return JSONResponse({"problems": [problem_data(one, room.shown) for one in problem.diagnostics]}, 422)
    except (ArgumentError, PlcgenError) as problem:
        return JSONResponse({"problems": [{"message": str(problem), "severity": "error"}]}, 422)
    if "data" in found:
        headers = {"Content-Disposition": f'attachment; filename="{found["name"]}"'}
        return Response(found["data"], media_type="application/zip", headers=headers)
    return JSONResponse(found)


def serve(folder: Path, port: int, told: Callable[[str], None]) -> None:
    """Serve a folder on this machine until Ctrl-C; ``told`` gets the address. Raises OSError if the port is taken."""
    import uvicorn

    with (
        socket.socket(socket.AF_INET, socket.SOCK_STREAM) as listener,
        tempfile.TemporaryDirectory(prefix="plcgen-serve-") as bench,
    ):
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(("127.0.0.1", port))
        listener.listen()  # who is told the address may ask at once
        chosen = listener.getsockname()[1]
        token = secrets.token_urlsafe(24)
        config = uvicorn.Config(
            application(folder, token, chosen, Path(bench)), log_level="warning", access_log=False, lifespan="off",
            server_header=False, ws="none", h11_max_incomplete_event_size=64 * 1024,
        )  # fmt: skip
        told(f"http://127.0.0.1:{chosen}/{token}/")
        uvicorn.Server(config).run(sockets=[listener])
