"""What a fit leaves of the readings: its structure, and the effect or the sweep that would explain it best."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from mffit.diagnosis import constants
from mffit.diagnosis.one_step import BestEffect, best_effect, held_numbers
from mffit.diagnosis.remainder import Remainder, contradiction, left_out_sweeps, predicted_sweep, remainder
from mffit.diagnosis.structure import Structure, structure
from mffit.fit.fitted import Fitted
from mffit.suspicion import HeldNumber, LeftOutSweeps
from mffit.suspicion.constants import MOST_POINTS_SHOWN
from mffit.suspicion.explanation import explanation


@dataclass(frozen=True, slots=True)
class OddSweep:
    """The sweep that contradicts all others most, and what it looks like."""

    name: str
    looks: str  #: the known mistake or the one number that explains it


@dataclass(frozen=True, slots=True)
class Remains:
    """The residuals of a fit, examined."""

    structure: Structure
    effect: BestEffect | None = None  #: the best of all effects, significant or not; None if none can be seen
    sweep: OddSweep | None = None  #: far above the noise, a sweep with a mistake of its own
    held: tuple[HeldNumber, ...] = ()  #: numbers at a bound or a physical limit
    left_out: Mapping[str, LeftOutSweeps] = field(
        default_factory=dict
    )  #: by channel, prediction of left-out sweeps


NOTHING_REMAINS = Remains(Structure(()))


def remains(fitted: Fitted, signs: Mapping[str, float]) -> Remains:
    """The residuals of a fit at its solution, examined by all tests; ``signs`` lead from ISO-W to the rig's axes."""
    left = remainder(fitted)
    return Remains(
        structure=structure(left),
        effect=best_effect(left),
        sweep=None if left.at_noise else odd_sweep(left, signs),
        held=held_numbers(left, fitted),
        left_out=left_out_sweeps(left),
    )


def odd_sweep(left: Remainder, signs: Mapping[str, float]) -> OddSweep | None:
    """The sweep that contradicts all others; None if it does not stand out, or if no known mistake explains it."""
    points = left.points
    found = {k: contradiction(left, k) for k in np.unique(points.sweep).tolist()}
    worst, *others = sorted(found, key=lambda k: -found[k])
    if any(found[worst] < constants.ODD_SWEEP_OVER_NEXT * found[k] for k in others):
        return None
    shown = np.zeros(len(points), dtype=bool)
    sweep = np.flatnonzero(points.sweep == worst)
    shown[sweep[:: -(-len(sweep) // MOST_POINTS_SHOWN)]] = True
    readings = {
        name: np.where(used, points.channel(name), np.nan)
        for name, used in zip(left.channels, np.split(left.used, len(left.channels)), strict=True)
    }
    part = points.replace(**readings).select(shown)
    looks = explanation(part, predicted_sweep(left, worst, shown), left.simulation, signs)
    return OddSweep(points.sweep_names[worst], looks) if looks else None
