"""Date and versions of a page."""

from __future__ import annotations

from mffit.made import COMPUTING, libraries
from mffit.made import made as made_now

LIBRARIES = (*COMPUTING, "matplotlib")


def made() -> dict[str, str]:
    """Date and versions for the foot of a page."""
    known = made_now()
    return {
        "date": known.day,
        "version": known.version,
        "method": str(known.method),
        "with": ", ".join(f"{name} {number}" for name, number in libraries(LIBRARIES).items()),
    }
