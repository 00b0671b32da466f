"""When and with what a page was made."""

from __future__ import annotations

import os
import platform
from datetime import UTC, datetime
from importlib.metadata import version

import mffit

LIBRARIES = ("numpy", "scipy", "pillow")


def made() -> dict[str, str]:
    """Date and versions for the foot of a page.

    ``SOURCE_DATE_EPOCH`` [s since 1970] stands for the date where it is set, for pages that are to be the same to the byte.
    """
    said = os.environ.get("SOURCE_DATE_EPOCH", "")
    when = datetime.fromtimestamp(int(said), UTC) if said.isdigit() else datetime.now(UTC)
    libraries = ", ".join(f"{name} {version(name)}" for name in LIBRARIES)
    return {
        "date": when.strftime("%Y-%m-%d %H:%M UTC"),
        "version": mffit.__version__,
        "with": f"Python {platform.python_version()}, {libraries}",
    }
