"""Access to the window: only from this machine, by its own address, with the cookie of a browser that was let in."""

import secrets
from collections.abc import Awaitable, Callable, MutableMapping
from typing import Any

from starlette.datastructures import MutableHeaders
from starlette.requests import Request
from starlette.responses import HTMLResponse, PlainTextResponse

HOSTS = ("127.0.0.1", "localhost")
HEADERS = {
    "cache-control": "no-store",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "referrer-policy": "no-referrer",
    "x-content-type-options": "nosniff",
    "x-frame-options": "DENY",
}
Scope = MutableMapping[str, Any]
App = Callable[[Scope, Callable[[], Awaitable[Any]], Callable[[Any], Awaitable[None]]], Awaitable[None]]
COOKIE = "mffit"
GO_ON = '<!doctype html><meta http-equiv="refresh" content="0; url={0}"><a href="{0}">Open the window</a>'
REFUSAL = "Refused: open an address that `mffit open` shows in its terminal; each opens one browser."


class Entrance:
    """How browsers get into a window: by an address that lets one in, for a cookie that it brings along from then on.

    The page has an address of its own, to which the cookie belongs: browsers keep cookies of all ports together, and would show
    it to the server of another user.
    """

    def __init__(self, entered: Callable[[str], None] = lambda address: None) -> None:
        self.home = f"/{secrets.token_urlsafe(12)}/"
        self.secret = secrets.token_urlsafe()
        self._addresses: set[str] = set()
        self._entered = entered  #: called with an address that was used

    def new_address(self) -> str:
        """An address, without host, that lets one browser in."""
        address = f"/enter/{secrets.token_urlsafe()}"
        self._addresses.add(address)
        return address

    def enter(self, path: str) -> bool:
        """Whether the path is an address that has let nobody in yet."""
        if path not in self._addresses:
            return False
        self._addresses.remove(path)
        self._entered(path)
        return True

    def knows(self, cookies: str) -> bool:
        """Whether the header of a request has the cookie."""
        given = [part.strip().encode("latin-1", "replace") for part in cookies.split(";")]
        wanted = f"{COOKIE}={self.secret}".encode()
        return any(secrets.compare_digest(one, wanted) for one in given)


class Guard:
    """Passes requests on whose host, origin and cookie are those of this window.

    The host is checked because a page of another site may let its own name point to this machine; the origin and
    ``Sec-Fetch-Site`` because it may send requests here; the cookie because other users of the machine may.
    """

    def __init__(self, app: App, *, entrance: Entrance, port: int) -> None:
        self._app, self._entrance = app, entrance
        self._hosts = {f"{host}:{port}" for host in HOSTS}

    async def __call__(self, scope: Scope, receive: Any, send: Any) -> None:
        if scope["type"] != "http":
            return await self._app(scope, receive, send)

        async def with_headers(message: Any) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in HEADERS.items():
                    headers.setdefault(name, value)
            await send(message)

        request, path = Request(scope), scope["path"]
        answer: App = PlainTextResponse(REFUSAL, 403)
        if self._is_meant(request):
            home = self._entrance.home
            if path.startswith(home) and self._entrance.knows(request.headers.get("cookie", "")):
                answer = self._app
            elif request.method == "GET" and self._entrance.enter(path):
                # A page, because browsers keep the cookie from requests to which another site, or a file, redirects.
                cookie = f"{COOKIE}={self._entrance.secret}; Path={home}; HttpOnly; SameSite=Strict"
                more = {"set-cookie": cookie, "content-security-policy": "default-src 'none'"}
                answer = HTMLResponse(GO_ON.format(home), headers=more)
        await answer(scope, receive, with_headers)

    def _is_meant(self, request: Request) -> bool:
        """Whether a request comes from this window, or from somebody who opens an address of it."""
        given, method = request.headers, request.method
        host, origin, site = given.get("host", ""), given.get("origin"), given.get("sec-fetch-site")
        # Somebody follows a link to the page, as from a terminal within a browser; frames are refused by a header.
        fetched = given.get("sec-fetch-mode"), given.get("sec-fetch-dest")
        followed = method == "GET" and fetched == ("navigate", "document")
        return (
            host in self._hosts
            and (origin is None or origin == f"http://{host}")
            and (site is None or site in ("same-origin", "none") or followed)
            and (method in ("GET", "HEAD") or origin is not None)
        )
