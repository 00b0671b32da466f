"""The record of a sweep that does not fit the others."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


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
