"""The addresses of a window: its page, the state and the data as JSON, the changes, the runs and their pages."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, JSONResponse, Response, StreamingResponse
from starlette.routing import Route

from mffit.errors import InputError
from mffit.viewer import project_html
from mffit.window import constants
from mffit.window.guard import App, Guard
from mffit.window.runs import out_of
from mffit.window.session import Session

SERVED = (".html", ".png", ".svg", ".json", ".csv", ".tir", ".toml")
"""Endings of the results that are served."""
SANDBOX = (
    "sandbox allow-scripts allow-popups allow-downloads; default-src 'none'; style-src 'unsafe-inline'; "
    "script-src 'unsafe-inline'; img-src 'self' data:"
)
"""For pages of results: their scripts have no origin, so they cannot ask the window for anything."""
REFUSED = 422
"""Status of a change that is not possible; the sentence is in the answer."""


def window_app(
    session: Session, *, token: str, port: int, closing: Callable[[], bool] = lambda: False
) -> App:
    """The ASGI application of a window, guarded; ``closing`` says whether the server is about to end."""

    async def page(request: Request) -> Response:
        if not request.url.path.endswith("/"):
            return Response(status_code=404)
        return HTMLResponse(await run_in_threadpool(_page, session))

    async def project(request: Request) -> Response:
        return JSONResponse(session.data)

    async def state(request: Request) -> Response:
        return JSONResponse(await run_in_threadpool(session.state))

    async def events(request: Request) -> Response:
        return StreamingResponse(_events(session, request, closing), media_type="text/event-stream")

    async def edit(request: Request) -> Response:
        content = await _content(request)
        name, seen, arguments = (content.get(key) for key in ("do", "seen", "with"))
        if not isinstance(name, str) or not isinstance(seen, str) or not isinstance(arguments, dict):
            return JSONResponse({"error": "a change needs do, seen and with"}, REFUSED)
        return await _answer(session, lambda: session.edit(name, seen, arguments))

    async def undo(request: Request) -> Response:
        return await _answer(session, session.undo)

    async def run(request: Request) -> Response:
        return await _answer(session, lambda: session.run(request.path_params["kind"]))

    async def stop(request: Request) -> Response:
        return await _answer(session, session.stop)

    async def result(request: Request) -> Response:
        found = within(out_of(session.file.path), request.path_params["path"])
        if found is None:
            return Response(status_code=404)
        return FileResponse(found, headers={"content-security-policy": SANDBOX})

    routes = [
        Route("/{token}/", page),
        Route("/{token}/project", project),
        Route("/{token}/state", state),
        Route("/{token}/events", events),
        Route("/{token}/edit", edit, methods=["POST"]),
        Route("/{token}/undo", undo, methods=["POST"]),
        Route("/{token}/stop", stop, methods=["POST"]),
        Route("/{token}/run/{kind}", run, methods=["POST"]),
        Route("/{token}/out/{path:path}", result),
    ]
    return Guard(Starlette(routes=routes), token=token, port=port)


def within(folder: Path, name: str) -> Path | None:
    """The file of a folder that a request names; None if there is none, or if it lies elsewhere."""
    try:
        path = (folder / name).resolve(strict=True)
    except (OSError, ValueError):
        return None
    inside = path.is_relative_to(folder.resolve()) and path.is_file()
    return path if inside and path.suffix in SERVED else None


def _page(session: Session) -> str:
    data, state = session.data, session.state()
    if data is not None:
        return project_html(data["name"], data, turn_slip=data["turn_slip"], star=data["star"], window=state)
    try:
        config = session.file.config()
        name, turn_slip = config.tyre.name, config.rig.on_disc
    except InputError:
        name, turn_slip = session.file.path.name, False
    return project_html(name, None, turn_slip=turn_slip, star=False, window=state)


async def _events(session: Session, request: Request, closing: Callable[[], bool]) -> AsyncIterator[str]:
    """The state whenever it changes, as server-sent events."""
    seen = ""
    while not closing() and not await request.is_disconnected():
        now = json.dumps(await run_in_threadpool(session.state))
        if now != seen:
            seen = now
            yield f"data: {now}\n\n"
        await asyncio.sleep(constants.LOOK_AGAIN)


async def _content(request: Request) -> dict[str, Any]:
    """The JSON object of a request; empty if it has none, or too large a one."""
    if int(request.headers.get("content-length", 0)) > constants.LARGEST_REQUEST:
        return {}
    try:
        found = json.loads(await request.body())
    except ValueError:
        return {}
    return found if isinstance(found, dict) else {}


async def _answer(session: Session, action: Callable[[], None]) -> Response:
    """The new state after an action, or the sentence why it was refused."""
    try:
        await run_in_threadpool(action)
    except InputError as error:
        return JSONResponse({"error": str(error), "state": await run_in_threadpool(session.state)}, REFUSED)
    return JSONResponse({"state": await run_in_threadpool(session.state)})
