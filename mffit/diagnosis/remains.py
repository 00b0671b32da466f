"""What a fit leaves of the readings: its structure, and the effect or the sweep that would explain it best."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from mffit.diagnosis.one_step import BestEffect, best_effect, held_numbers
from mffit.diagnosis.remainder import Remainder, left_out_sweeps, remainder
from mffit.diagnosis.structure import Structure, structure
from mffit.fit.fitted import Fitted
from mffit.linearised import LinearisedFit
from mffit.suspicion import HeldNumber, LeftOutSweeps


@dataclass(frozen=True, slots=True)
class OddSweep:
    """The sweep that contradicts all others most, and what it looks like."""

    name: str
    looks: str  #: the known mistake or the one number that explains it; empty if no known cause does


@dataclass(frozen=True, slots=True)
class Remains:
    """The residuals of a fit, examined."""

    structure: Structure
    effect: BestEffect | None = None  #: the best of all effects, significant or not; None if none can be seen
    sweep: OddSweep | None = None  #: the sweep that contradicts the others most
    held: tuple[HeldNumber, ...] = ()  #: numbers at a bound or a physical limit
    left_out: Mapping[str, LeftOutSweeps] = field(
        default_factory=dict
    )  #: by channel, prediction of left-out sweeps
    change: Mapping[str, np.ndarray] = field(default_factory=dict, repr=False)
    """By channel, what the best effect explains at every reading (n,) [N], [Nm]"""

    def gain_over_the_formula(self, linear: LinearisedFit) -> float:
        """Gain of log evidence if the best effect takes the place of a smooth miss of the formula."""
        return sum(
            linear.channels[name].gain(change[linear.channels[name].rows])
            for name, change in self.change.items()
        )


NOTHING_REMAINS = Remains(Structure(()))


def remains(fitted: Fitted) -> Remains:
    """The residuals of a fit at its solution, examined by all tests."""
    left = remainder(fitted)
    effect = best_effect(left)
    return Remains(
        structure=structure(left),
        effect=effect,
        held=held_numbers(left, fitted),
        left_out=left_out_sweeps(left),
        change={} if effect is None else _change(left, effect.best.change, len(fitted.problem.points)),
    )


def _change(left: Remainder, change: np.ndarray, n: int) -> dict[str, np.ndarray]:
    """Rows of a remainder in units of their uncertainty as changes of the readings at all n points."""
    examined = np.arange(n) // -(-n // len(left.points))
    own = change[: len(left.sigma)] * np.where(left.used, left.sigma, 0.0)
    return {
        name: part[examined]
        for name, part in zip(left.channels, np.split(own, len(left.channels)), strict=True)
    }
