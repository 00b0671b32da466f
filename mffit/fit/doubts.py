"""The record of a sweep that does not fit the others."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mffit.quantities import CHANNELS as WORDS


@dataclass(frozen=True, slots=True)
class Doubt:
    """A sweep that does not fit the others, without being impossible."""

    sweep: str  #: its name, with the conditions where only these are meant
    file: str
    index: np.ndarray  #: (m,) rows of the points
    channel: str
    rms: float  #: error of the prediction [N] or [Nm]
    ratio: float  #: in units of what a sound sweep would show
    share: float  #: of the channel's usual size at this load
    looks: str  #: what would explain it, empty if nothing known does

    @property
    def sentence(self) -> str:
        explained = f"; it looks like {self.looks}" if self.looks else ""
        return (
            f"{self.sweep} does not fit the other sweeps: predicted from them, {self.channel} is out by {self.rms:.3g} "
            f"{WORDS[self.channel].unit}, {100 * self.share:.0f} % of its usual size and {self.ratio:.1f} times what noise "
            f"and model explain{explained}; check this sweep or repeat it"
        )

    def to_json(self) -> dict:
        """One row of ``doubts`` in result.json."""
        return {
            "sweep": self.sweep,
            "file": self.file,
            "channel": self.channel,
            "rms": self.rms,
            "ratio": self.ratio,
            "share": self.share,
            "looks_like": self.looks or None,
        }
