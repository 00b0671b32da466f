"""How a long run tells what it is doing."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[str], None]
"""Called with a short sentence whenever a step begins."""


class Silent:
    """Progress that is not shown."""

    def __call__(self, sentence: str) -> None:
        pass

    def __repr__(self) -> str:
        return "silent"  # what a help text has for a default


silent = Silent()
