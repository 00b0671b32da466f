"""The server of a window, on this machine only."""

from __future__ import annotations

import contextlib
import socket
from collections.abc import Callable
from pathlib import Path

from mffit.errors import InputError

ADDRESS = "127.0.0.1"


PROJECT = "tyre.toml"


def open_path(path: Path, *, port: int = 0, opened: Callable[[str], None]) -> None:
    """Open a project, or the folder that it is in, until the window is interrupted; see :func:`serve`."""
    if path.is_dir():
        path = path / PROJECT
        if not path.is_file():
            raise InputError(
                f"has no {PROJECT}; `mffit init --from FILE... {path.parent}` writes one for recordings",
                file=path.parent,
            )
    serve(path, port=port, opened=opened)


def serve(path: str | Path, *, port: int = 0, opened: Callable[[str], None]) -> None:
    """Serve the window of a project until it is interrupted.

    Parameters
    ----------
    path : the ``tyre.toml``
    port : on the loopback address; 0 for any that is free
    opened : called with the address, once requests are answered

    Raises
    ------
    InputError
        The extra ``window`` is not installed, the port is in use, or the file cannot be read.
    """
    try:
        import uvicorn

        from mffit.window.app import window_app
    except ImportError as error:
        raise InputError(
            f'the window needs {error.name}, which is not installed; run pip install "mffit[window]", or use '
            "`mffit show tyre.toml`, which needs no server"
        ) from None
    from mffit.window.guard import new_token
    from mffit.window.session import Session

    session, token = Session(Path(path)), new_token()
    session.file.config()
    with _listening(port) as listening:
        port = listening.getsockname()[1]
        app = window_app(session, token=token, port=port, closing=lambda: server.should_exit)
        settings = uvicorn.Config(app, log_level="warning", timeout_graceful_shutdown=2, lifespan="off")
        server = uvicorn.Server(settings)
        session.run("fit")
        opened(f"http://{ADDRESS}:{port}/{token}/")
        with contextlib.suppress(KeyboardInterrupt):  # the usual end
            server.run(sockets=[listening])
        session.stop()


def _listening(port: int) -> socket.socket:
    """A socket on the loopback address."""
    found = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        found.bind((ADDRESS, port))
    except OSError as error:
        found.close()
        raise InputError(f"port {port} cannot be used ({error.strerror}); give another --port") from None
    found.listen()
    return found
