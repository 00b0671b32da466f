"""Progress messages of long runs."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[str], None]
"""Called with a short sentence at the beginning of every step."""


def silent(sentence: str) -> None:
    """Progress that is not shown."""
