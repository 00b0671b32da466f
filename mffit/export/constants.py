"""Numbers of judgement of the exporters."""

from __future__ import annotations

from tir.constant import Count

COMPILER_TIMEOUT = Count(
    300, "s", "A C compiler takes seconds for these sources; after this time it is stopped."
)
