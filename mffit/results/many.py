"""The outcome of one of many builds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

from tir import Quantity

State = Literal["built", "unchanged", "refused", "failed"]


@dataclass(frozen=True, slots=True)
class Outcome:
    """How the build of one ``tyre.toml`` ended."""

    source: Path  #: the tyre.toml
    name: str  #: of the tyre; path of the file if it cannot be read
    out: Path | None  #: output folder
    state: State  #: refused: bad input; failed: a bug, or a worker that died
    sentence: str = ""  #: the reason, without output
    seconds: float = 0.0
    epsilon_gamma: Quantity | None = None
    misfit: Mapping[str, float] = field(default_factory=dict)  #: rms by channel, [N] and [Nm]
    warnings: int = 0
    file: str = ""  #: the property file with the plain name, in ``out``

    @property
    def whole(self) -> bool:
        """Whether its output is complete."""
        return self.state in ("built", "unchanged")

    def having(self, **changes: Any) -> Outcome:
        """A copy with some fields replaced."""
        return replace(self, **changes)
