"""Progress messages of long runs."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[str], None]
"""Called with a short sentence at the beginning of every step."""


class Silent:
    """Progress that is not shown."""

    def __call__(self, sentence: str) -> None:
        pass

    def __repr__(self) -> str:
        return "silent"  # the default as help() shows it


silent = Silent()
