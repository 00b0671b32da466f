"""Date and versions of a page."""

from __future__ import annotations

import platform
from importlib.metadata import version

from mffit.made import made as made_now

LIBRARIES = ("numpy", "scipy", "matplotlib")


def made() -> dict[str, str]:
    """Date and versions for the foot of a page."""
    known = made_now()
    libraries = ", ".join(f"{name} {version(name)}" for name in LIBRARIES)
    return {
        "date": known.day,
        "version": known.version,
        "method": str(known.method),
        "with": f"Python {platform.python_version()}, {libraries}",
    }
