"""Clients and addresses of a window for its tests: a browser that was let in."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from mffit.window.recordings_folder import RecordingsFolder

DISC = Path(__file__).parents[3] / "samples" / "front-120-70"
PORT = 8123
HERE = f"http://127.0.0.1:{PORT}"


def client_of(shown: Any, *, has_cookie: bool = True, headers: Any = None, closing: Any = None) -> Any:
    """A client that was let into a window, or was not; ``home`` is the address of the page without host."""
    testclient = pytest.importorskip("starlette.testclient", reason="starlette's client needs httpx")
    from mffit.window.app import window_app
    from mffit.window.guard import COOKIE, Entrance

    entrance, more = Entrance(), {} if closing is None else {"closing": closing}
    app = window_app(shown, entrance=entrance, port=PORT, **more)
    cookies = {COOKIE: entrance.secret} if has_cookie else {}
    origin = {"origin": HERE} if headers is None else headers
    found = testclient.TestClient(app, base_url=HERE, headers=origin, cookies=cookies)
    found.home, found.entrance = entrance.home, entrance
    return found


def of_disc_beside_a_foreign_table(folder: Path) -> RecordingsFolder:
    """Recordings of a disc, and a table of something else."""
    for name in (
        "sideslip_1400N.csv",
        "camber_1400N.csv",
        "zero_1400N_forward.csv",
        "zero_1400N_backward.csv",
    ):
        (folder / name).write_bytes((DISC / name).read_bytes())
    (folder / "costs.csv").write_text("month,costs\n1,10\n2,20\n", encoding="utf-8")
    return RecordingsFolder(folder)
