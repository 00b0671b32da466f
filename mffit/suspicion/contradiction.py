"""Sweeps that contradict the others, with what the formula misses and what runs differ by taken into account."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtrc, ndtr

from mffit.linearised import LinearisedFit
from mffit.points import Points
from mffit.rig import Simulation
from mffit.suspicion import constants
from mffit.suspicion.explanation import SHIFTS, explanation, gain_of_one_number
from mffit.suspicion.prediction import PredictedChannel


@dataclass(frozen=True, slots=True)
class SweepAgainstOthers:
    """A sweep that the others do not predict."""

    sweep: int  #: its number
    name: str
    channels: tuple[str, ...]  #: in which it misses their prediction, the worst first
    ratio: float  #: of the worst one: error over what the prediction leaves open
    looks: str  #: what would explain it; empty if no known cause does


def contradictions_of(
    left: LinearisedFit,
    points: Points,
    simulation: Simulation,
    suspects: Sequence[int],
    signs: Mapping[str, float],
) -> tuple[SweepAgainstOthers, ...]:
    """Those of the suspected sweeps that contradict all others, the worst first.

    Parameters
    ----------
    left : of the fit to the ``points``
    points : (n,)
    simulation : the fitted tyre on its rig
    suspects : numbers of sweeps, the worst first; of many, the first are examined
    signs : +1 or -1 per channel: from ISO-W to the rig's axes
    """
    examined = suspects[: constants.MOST_SUSPECTS]
    seen = (_seen(left, points, simulation, k, signs) for k in examined)
    return tuple(sorted((one for one in seen if one is not None), key=lambda one: -one.ratio))


def _seen(
    left: LinearisedFit,
    points: Points,
    simulation: Simulation,
    k: int,
    signs: Mapping[str, float],
) -> SweepAgainstOthers | None:
    rows = np.flatnonzero(points.sweep == k)
    errors, readings = {}, {}
    for name, channel in left.channels.items():
        for group in np.flatnonzero(channel.sweeps == k):
            one = channel.by_the_others(int(group))
            errors[name] = PredictedChannel(error=-one.error, covariance=one.covariance)
            looked_at = np.isin(rows, channel.rows[one.rows])
            readings[name] = np.where(looked_at, points.channel(name)[rows], np.nan)
    part = points.select(rows).replace(**readings)
    ratio = {name: _ratio(e.error, e.covariance) for name, e in errors.items()}
    certain = float(ndtr(-constants.CERTAIN_SIGMA))
    off = [
        name
        for name, e in errors.items()
        if ratio[name] > constants.DISTRUSTED_MISFIT
        and chdtrc(len(e.error), len(e.error) * ratio[name] ** 2) < certain
    ]
    one_number = (
        chdtrc(1, gain_of_one_number(part, errors, simulation)) * constants.MOST_SUSPECTS * len(SHIFTS)
        < certain
    )
    if not off and not one_number:
        return None
    worst_first = sorted(off or ratio, key=lambda name: -ratio[name])
    looks = explanation(part, errors, simulation, signs)
    return SweepAgainstOthers(
        k, points.sweep_names[k], tuple(worst_first if off else worst_first[:1]), ratio[worst_first[0]], looks
    )


def _ratio(error: np.ndarray, covariance: np.ndarray) -> float:
    return float(np.sqrt(error @ np.linalg.solve(covariance, error) / len(error)))
