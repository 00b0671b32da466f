"""Access to the window: only from this machine, by its own address, with the cookie of a browser that was let in."""

from __future__ import annotations

import secrets
from collections.abc import Awaitable, Callable, Mapping, MutableMapping
from typing import Any

HOSTS = ("127.0.0.1", "localhost")
HEADERS = {
    b"cache-control": b"no-store",
    b"cross-origin-opener-policy": b"same-origin",
    b"cross-origin-resource-policy": b"same-origin",
    b"referrer-policy": b"no-referrer",
    b"x-content-type-options": b"nosniff",
    b"x-frame-options": b"DENY",
}
Scope = MutableMapping[str, Any]
App = Callable[[Scope, Callable[[], Awaitable[Any]], Callable[[Any], Awaitable[None]]], Awaitable[None]]


COOKIE = "mffit"


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
                given = {name for name, _ in message.get("headers", [])}
                added = [(name, value) for name, value in HEADERS.items() if name not in given]
                message = {**message, "headers": [*message.get("headers", []), *added]}
            await send(message)

        headers = {name.decode("latin-1").lower(): one.decode("latin-1") for name, one in scope["headers"]}
        if self._is_meant(scope["method"], headers):
            here = scope["path"].startswith(self._entrance.home)
            if here and self._entrance.knows(headers.get("cookie", "")):
                return await self._app(scope, receive, with_headers)
            if scope["method"] == "GET" and self._entrance.enter(scope["path"]):
                return await self._let_in(with_headers)
        return await _send(with_headers, 403, "text/plain", REFUSAL)

    def _is_meant(self, method: str, headers: Mapping[str, str]) -> bool:
        """Whether a request comes from this window, or from somebody who opens an address of it."""
        host, origin, site = headers.get("host", ""), headers.get("origin"), headers.get("sec-fetch-site")
        return (
            host in self._hosts
            and (origin is None or origin == f"http://{host}")
            and (site is None or site in ("same-origin", "none") or _followed(method, headers))
            and (method in ("GET", "HEAD") or origin is not None)
        )

    async def _let_in(self, send: Any) -> None:
        """Give the cookie; a page, because browsers keep it from requests to which another site, or a file, redirects."""
        home = self._entrance.home
        cookie = f"{COOKIE}={self._entrance.secret}; Path={home}; HttpOnly; SameSite=Strict"
        more = ((b"set-cookie", cookie.encode()), (b"content-security-policy", b"default-src 'none'"))
        await _send(send, 200, "text/html", GO_ON.format(home), *more)


GO_ON = '<!doctype html><meta http-equiv="refresh" content="0; url={0}"><a href="{0}">Open the window</a>'
REFUSAL = "Refused: open an address that `mffit open` shows in its terminal; each opens one browser."


def _followed(method: str, headers: Mapping[str, str]) -> bool:
    """Whether somebody follows a link to the page, as from a terminal within a browser; frames are refused by a header."""
    wanted = {"sec-fetch-mode": "navigate", "sec-fetch-dest": "document"}
    return method == "GET" and all(headers.get(name) == value for name, value in wanted.items())


async def _send(send: Any, status: int, kind: str, text: str, *more: tuple[bytes, bytes]) -> None:
    body = text.encode()
    headers = [(b"content-type", f"{kind}; charset=utf-8".encode()), (b"content-length", b"%d" % len(body))]
    await send({"type": "http.response.start", "status": status, "headers": [*headers, *more]})
    await send({"type": "http.response.body", "body": body})
