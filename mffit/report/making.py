"""Date and versions of a page."""

from __future__ import annotations

import os
import platform
from datetime import UTC, datetime
from importlib.metadata import version

import mffit

LIBRARIES = ("numpy", "scipy", "matplotlib")


def made() -> dict[str, str]:
    """Date and versions for the foot of a page.

    If ``SOURCE_DATE_EPOCH`` [s since 1970] is set, it replaces the date, so that the same data give the same bytes.
    """
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "")
    when = datetime.fromtimestamp(int(epoch), UTC) if epoch.isdigit() else datetime.now(UTC)
    libraries = ", ".join(f"{name} {version(name)}" for name in LIBRARIES)
    return {
        "date": when.strftime("%Y-%m-%d %H:%M UTC"),
        "version": mffit.__version__,
        "with": f"Python {platform.python_version()}, {libraries}",
    }
