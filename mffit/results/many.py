"""The record of one tyre among many that were built."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

from tir import Quantity

State = Literal["built", "unchanged", "refused", "failed"]


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of one ``tyre.toml``."""

    source: Path  #: the tyre.toml
    name: str  #: of the tyre, or of the file where that could not be read
    out: Path | None  #: folder of its output
    state: State  #: refused: by its input; failed: by a bug or a worker that died
    sentence: str = ""  #: why, if it has no output
    seconds: float = 0.0
    epsilon_gamma: Quantity | None = None
    misfit: Mapping[str, float] = field(default_factory=dict)  #: rms by channel, [N] and [Nm]
    warnings: int = 0
    file: str = ""  #: the property file with the plain name, in ``out``

    @property
    def whole(self) -> bool:
        """Whether its output is there."""
        return self.state in ("built", "unchanged")

    def having(self, **changes: Any) -> Outcome:
        """The same with some fields replaced."""
        return replace(self, **changes)
