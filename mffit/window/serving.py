"""The server of a window, on this machine only."""

from __future__ import annotations

import contextlib
import os
import socket
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING

import click

from mffit import viewer
from mffit.errors import InputError

if TYPE_CHECKING:
    from mffit.window.app import Opened

ADDRESS = "127.0.0.1"


def open_path(
    paths: Sequence[Path],
    *,
    port: int = 0,
    opened: Callable[[str], None],
    launch: Callable[[Path], None] | None = None,
) -> None:
    """Serve a window of a ``tyre.toml``, its folder, a folder of recordings, or property files until it is interrupted.

    ``port`` is on the loopback address; 0 is any free one. ``opened`` is called with the address once requests are answered, and
    with another when that has let a browser in; ``launch`` with a file that takes a browser there, for none but this user to
    read. Raises InputError if the port is in use, or the files cannot be read.
    """
    import uvicorn

    from mffit.window.app import window_app
    from mffit.window.guard import Entrance

    shown = _opened(paths)
    with _listening(port) as listening:
        port = listening.getsockname()[1]
        said: list[str] = []

        def say_new(used: str) -> None:
            if used in said[-1:]:
                said.append(entrance.new_address())
                opened(f"http://{ADDRESS}:{port}{said[-1]}")

        entrance = Entrance(say_new)
        app = window_app(shown, entrance=entrance, port=port, closing=lambda: server.should_exit)
        settings = uvicorn.Config(app, log_level="warning", timeout_graceful_shutdown=2, lifespan="off")
        server = uvicorn.Server(settings)
        if shown.has_project:
            shown.session.run("fit")
        said.append(entrance.new_address())
        opened(f"http://{ADDRESS}:{port}{said[-1]}")
        # a browser in the terminal would wait
        with _leading_to(f"http://{ADDRESS}:{port}{entrance.new_address()}", port) as page:
            if launch is not None and page is not None:
                Thread(target=launch, args=(page,), daemon=True).start()
            with contextlib.suppress(KeyboardInterrupt):  # the usual end
                server.run(sockets=[listening])
        shown.stop()


def _opened(paths: Sequence[Path]) -> Opened:
    """What is at these paths; raises as :func:`open_path`."""
    from mffit.window.app import Opened
    from mffit.window.reading import ReadingProcess
    from mffit.window.recordings_folder import PROJECT, RecordingsFolder
    from mffit.window.session import Session

    first = paths[0]
    if all(path.suffix.lower() == ".tir" for path in paths):
        return Opened(html=viewer.files_page(paths).html)
    if len(paths) > 1:
        raise InputError(
            "opens one project at a time; give this file alone, or property files only", file=first
        )
    if not first.exists():
        raise InputError("does not exist; name a tyre.toml, property files or a folder", file=first)
    if first.is_dir() and not (first / PROJECT).exists():
        return Opened(folder=RecordingsFolder(first), reading=ReadingProcess())
    session = Session(first / PROJECT if first.is_dir() else first)
    session.file.config()
    return Opened(session, reading=ReadingProcess())


@contextlib.contextmanager
def _leading_to(address: str, port: int) -> Iterator[Path | None]:
    """A file that takes a browser to an address, in a folder of the user's own; None where there can be none.

    Other users of the machine see with what a browser is started, so that is this file, which they cannot read.
    """
    folder = Path(click.get_app_dir("mffit")) / "windows"
    page = folder / f"{port}.html"
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        page.unlink(missing_ok=True)
        with os.fdopen(os.open(page, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as stream:
            stream.write(f'<!doctype html><meta http-equiv="refresh" content="0; url={address}">')
    except OSError:
        yield None
        return
    try:
        yield page
    finally:
        page.unlink(missing_ok=True)


def _listening(port: int) -> socket.socket:
    """A socket on the loopback address; no other process can listen there too."""
    found = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    if os.name == "nt":
        found.setsockopt(socket.SOL_SOCKET, socket.SO_EXCLUSIVEADDRUSE, 1)  # type: ignore[attr-defined]
    else:  # ports of a server that has just ended; on Windows it would let others listen too
        found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        found.bind((ADDRESS, port))
    except OSError as error:
        found.close()
        raise InputError(f"port {port} cannot be used ({error.strerror}); give another --port") from None
    found.listen()
    return found
