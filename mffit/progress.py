"""How a long run tells what it is doing."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[str], None]
"""Called with a short sentence whenever a step begins."""


def silent(sentence: str) -> None:
    """Progress that is not shown."""
