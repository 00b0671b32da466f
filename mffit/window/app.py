"""The addresses of a window: its page, the state and the data as JSON, the changes, the runs and their pages."""

import asyncio
import json
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.middleware import Middleware
from starlette.middleware.gzip import GZipMiddleware
from starlette.requests import ClientDisconnect, Request
from starlette.responses import FileResponse, HTMLResponse, JSONResponse, Response, StreamingResponse
from starlette.routing import Mount, Route

from mffit.as_json import plain
from mffit.errors import InputError
from mffit.sweeps.constants import LARGEST_UNPACKED
from mffit.sweeps.formats import ENDINGS
from mffit.viewer import project_html
from mffit.viewer.page import recordings_html
from mffit.window import constants
from mffit.window.guard import App, Entrance, Guard
from mffit.window.reading import ReadingProcess
from mffit.window.recordings_folder import RecordingsFolder
from mffit.window.runs import out_of
from mffit.window.session import ChangedElsewhere, Session
from tir.document import parse_document
from tir.errors import TirError
from tir.tyre import interpret

Endpoint = Callable[[Request], Awaitable[Response]]
SERVED = (".html", ".png", ".svg", ".json", ".csv", ".tir", ".toml")
"""Endings of the results that are served."""
SANDBOX = (
    "sandbox allow-scripts allow-popups allow-downloads; default-src 'none'; style-src 'unsafe-inline'; "
    "script-src 'unsafe-inline'; img-src 'self' data:"
)
"""For pages of results: their scripts have no origin, so they cannot ask the window for anything."""
REFUSED = 422
"""Status of a change that is not possible; the sentence is in the answer."""


class Opened:
    """What a window shows: a project, or a folder of recordings until a project is made of it, or a finished page."""

    def __init__(
        self,
        session: Session | None = None,
        folder: RecordingsFolder | None = None,
        html: str = "",
        reading: ReadingProcess | None = None,
    ) -> None:
        self._session, self._folder, self.html = session, folder, html
        self._reading = reading  #: where recordings are read; None: here

    @property
    def has_project(self) -> bool:
        """Whether a project is open."""
        return self._session is not None

    @property
    def session(self) -> Session:
        """The open project. Raises InputError if there is none."""
        if self._session is None:
            raise InputError("no project is open in this window")
        return self._session

    @property
    def folder(self) -> RecordingsFolder:
        """The folder with recordings that are in no project yet; raises as :attr:`session`."""
        if self._folder is None:
            path = self.session.file.path
            self._folder = RecordingsFolder(path.parent, path)
        return self._folder

    def of_folder(self, what: str, *given: Any) -> Any:
        """What a method of the folder returns; see :class:`ReadingProcess`."""
        if self._reading is None:
            return getattr(self.folder, what)(*given)
        return self._reading.ask(self.folder, what, *given)

    def make(self, choice: dict[str, Any]) -> None:
        """Make a project of the folder, and open it; as :meth:`RecordingsFolder.make`."""
        session = Session(self.of_folder("make", choice))
        session.run("fit")
        self._session, self._folder = session, None

    def add(self, choice: dict[str, Any]) -> None:
        """Add recordings to the open project, as :meth:`RecordingsFolder.added` reads them."""
        self.session.edit("add_recordings", str(choice.get("seen")), self.of_folder("added", choice))

    def edit(self, change: Mapping[str, Any]) -> None:
        """Carry out a change of ``tyre.toml``; as :meth:`Session.edit`."""
        name, seen, arguments = (change.get(key) for key in ("do", "seen", "with"))
        if not isinstance(name, str) or not isinstance(seen, str) or not isinstance(arguments, dict):
            raise InputError("a change needs do, seen and with")
        self.session.edit(name, seen, arguments)

    def stop_reading(self) -> None:
        """Stop reading recordings."""
        if self._reading is not None:
            self._reading.stop()

    def stop(self) -> None:
        """Stop what is under way."""
        self.stop_reading()
        if self._session is not None:
            self._session.stop()


@dataclass(frozen=True)
class Answers:
    """What the addresses of a window answer; ``closing`` says whether the server is about to end."""

    opened: Opened
    closing: Callable[[], bool]

    def showing(self, found: Callable[[], Any]) -> Endpoint:
        async def show(request: Request) -> Response:
            return JSONResponse(await run_in_threadpool(found))

        return show

    def acting(self, action: Callable[[dict[str, Any]], Any]) -> Endpoint:
        async def act(request: Request) -> Response:
            content = await _content(request)
            return await self._done(lambda: action(content))

        return act

    async def page(self, request: Request) -> Response:
        return HTMLResponse(await run_in_threadpool(_page, self.opened))

    async def adding(self, request: Request) -> Response:
        return HTMLResponse(await run_in_threadpool(_recordings_page, self.opened))

    async def store(self, request: Request) -> Response:
        folder, name = self.opened.folder, request.path_params["name"]
        content = await _body(request, int(LARGEST_UNPACKED))
        if content is None:
            most = f"{LARGEST_UNPACKED / 1e6:.0f} MB"
            raise InputError(f"{name} is larger than {most}; copy it into the folder")
        return await self._done(lambda: {"name": folder.store(name, content).name})

    async def run(self, request: Request) -> Response:
        return await self._done(lambda: self.opened.session.run(request.path_params["kind"]))

    async def events(self, request: Request) -> Response:
        states = _events(self.opened, request, self.closing)
        return StreamingResponse(states, media_type="text/event-stream")

    async def result(self, request: Request) -> Response:
        found = within(out_of(self.opened.session.file.path), request.path_params["path"])
        if found is None:
            return Response(status_code=404)
        return FileResponse(found, headers={"content-security-policy": SANDBOX})

    async def gone(self, request: Request, error: Exception) -> Response:
        return Response(status_code=400)  # no reader

    async def refused(self, request: Request, error: Exception) -> Response:
        """The sentence why something was refused."""
        assert isinstance(error, InputError)
        versions = error.versions if isinstance(error, ChangedElsewhere) else None
        found = {"error": str(error), "sentence": error.sentence, "key": error.key, "versions": versions}
        return await self._with_state(found, REFUSED)

    async def _done(self, action: Callable[[], Any]) -> Response:
        return await self._with_state(await run_in_threadpool(action) or {}, 200)

    async def _with_state(self, found: dict[str, Any], status: int) -> Response:
        """An answer with the new state of the project if one is open."""
        if self.opened.has_project:
            found = {**found, "state": await run_in_threadpool(self.opened.session.state)}
        return JSONResponse(plain(found), status)


def window_app(
    opened: Opened, *, entrance: Entrance, port: int, closing: Callable[[], bool] = lambda: False
) -> App:
    """The ASGI application of a window, guarded; ``closing`` says whether the server is about to end."""
    answers = Answers(opened, closing)
    shown: dict[str, Callable[[], Any]] = {
        "recordings": lambda: plain(opened.of_folder("table")),
        "project": lambda: opened.session.data or opened.session.readings,
        "settings": lambda: opened.session.settings(),
        "state": lambda: opened.session.state(),
    }
    actions: dict[str, Callable[[dict[str, Any]], Any]] = {
        "recognised": lambda content: opened.of_folder("recognised", content),
        "check": lambda content: opened.of_folder("check", content),
        "make": opened.make,
        "add": opened.add,
        "edit": opened.edit,
        "values": _values_of,
        "undo": lambda content: opened.session.undo(),
        "stop": lambda content: opened.session.stop(),
        "stop-reading": lambda content: opened.stop_reading(),
    }
    routes = [
        Route("/", answers.page),
        Route("/add", answers.adding),
        *(Route(f"/{name}", answers.showing(found)) for name, found in shown.items()),
        *(Route(f"/{name}", answers.acting(action), methods=["POST"]) for name, action in actions.items()),
        Route("/run/{kind}", answers.run, methods=["POST"]),
        Route("/store/{name}", answers.store, methods=["POST"]),
        Route("/events", answers.events),
        Route("/out/{path:path}", answers.result),
    ]
    application = Starlette(
        routes=[Mount("/{home}", routes=routes)],
        exception_handlers={InputError: answers.refused, ClientDisconnect: answers.gone},
        middleware=[Middleware(GZipMiddleware)],
    )
    return Guard(application, entrance=entrance, port=port)


def within(folder: Path, name: str) -> Path | None:
    """The file of a folder that a request names; None if there is none, or if it lies elsewhere."""
    try:
        path = (folder / name).resolve(strict=True)
    except (OSError, ValueError):
        return None
    inside = path.is_relative_to(folder.resolve()) and path.is_file()
    return path if inside and path.suffix in SERVED else None


def _page(opened: Opened) -> str:
    if opened.html:
        return opened.html
    if not opened.has_project:
        return _recordings_page(opened)
    session = opened.session
    data, state, here = session.data, session.state(), _here(session.file.path.parent)
    if data is not None:
        return project_html(
            data["name"], data, turn_slip=data["turn_slip"], star=data["star"], window=state, here=here
        )
    try:
        config = session.file.config()
        name, turn_slip = config.tyre.name, config.rig.on_disc
    except InputError:
        name, turn_slip = session.file.path.name, False
    return project_html(name, None, turn_slip=turn_slip, star=False, window=state, here=here)


def _recordings_page(opened: Opened) -> str:
    """The recordings of a folder, or those to add to a project."""
    folder, to = opened.folder.folder, opened.session.file.path.name if opened.has_project else ""
    return recordings_html(folder.name, to, _here(folder))


def _here(folder: Path) -> dict[str, Any]:
    """What a page needs to take recordings for a folder."""
    return {"folder": folder.name, "endings": ENDINGS}


def _values_of(given: Mapping[str, Any]) -> dict[str, Any]:
    """The numbers of a property file, SI, by name; ``given`` has its ``name`` and ``text``."""
    try:
        tyre = interpret(parse_document(str(given.get("text")), path=str(given.get("name"))))
    except TirError as error:
        raise InputError(str(error)) from None
    return {"values": {name: x for name, x in tyre.values.items() if isinstance(x, float)}}


async def _events(opened: Opened, request: Request, closing: Callable[[], bool]) -> AsyncIterator[str]:
    """The state whenever it changes, as server-sent events; an empty one without a project."""
    seen = ""
    while not closing() and not await request.is_disconnected():
        state = await run_in_threadpool(opened.session.state) if opened.has_project else {}
        now = json.dumps(state)
        if now != seen:
            seen = now
            yield f"data: {now}\n\n"
        await asyncio.sleep(constants.LOOK_AGAIN)


async def _content(request: Request) -> dict[str, Any]:
    """The JSON object of a request; empty if it has none. Raises InputError if it is too large."""
    body = await _body(request, int(constants.LARGEST_REQUEST))
    if body is None:
        raise InputError(f"a change has at most {constants.LARGEST_REQUEST / 1e6:g} MB; make it in parts")
    try:
        found = json.loads(body)
    except (ValueError, RecursionError):
        return {}
    return found if isinstance(found, dict) else {}


async def _body(request: Request, most: int) -> bytes | None:
    """The body of a request; None if it is larger than ``most`` bytes; no more than these are kept."""
    found = bytearray()
    async for chunk in request.stream():
        found += chunk
        if len(found) > most:
            return None
    return bytes(found)
