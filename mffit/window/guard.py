"""Access to the window: only from this machine, by its own address, with the token."""

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


def new_token() -> str:
    """A random word for an address."""
    return secrets.token_urlsafe()


class Guard:
    """Passes requests on whose host, origin and token are those of this window.

    The host is checked because a page of another site may let its own name point to this machine; the origin and
    ``Sec-Fetch-Site`` because it may send requests here; the token because other users of the machine may.
    """

    def __init__(self, app: App, *, token: str, port: int) -> None:
        self._app, self._token = app, token
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

        if not self._admits(scope):
            return await _refuse(with_headers)
        return await self._app(scope, receive, with_headers)

    def _admits(self, scope: Scope) -> bool:
        headers = {
            name.decode("latin-1").lower(): value.decode("latin-1") for name, value in scope["headers"]
        }
        host, origin, site = headers.get("host", ""), headers.get("origin"), headers.get("sec-fetch-site")
        token = scope["path"].split("/")[1]
        return (
            host in self._hosts
            and (origin is None or origin == f"http://{host}")
            and (site is None or site in ("same-origin", "none") or _followed(scope["method"], headers))
            and secrets.compare_digest(token.encode(), self._token.encode())
            and (scope["method"] in ("GET", "HEAD") or origin is not None)
        )


def _followed(method: str, headers: Mapping[str, str]) -> bool:
    """Whether somebody follows a link to the page, as from a terminal within a browser; frames are refused by a header."""
    wanted = {"sec-fetch-mode": "navigate", "sec-fetch-dest": "document"}
    return method == "GET" and all(headers.get(name) == value for name, value in wanted.items())


async def _refuse(send: Any) -> None:
    body = b"Refused: open the address that `mffit open` showed."
    headers = [(b"content-type", b"text/plain; charset=utf-8"), (b"content-length", str(len(body)).encode())]
    await send({"type": "http.response.start", "status": 403, "headers": headers})
    await send({"type": "http.response.body", "body": body})
