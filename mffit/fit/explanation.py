"""What a small error of one sweep looks like: one number that is off, or the tyre turned on its rim."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from mffit.fit.prediction import Prediction
from mffit.points import Points
from mffit.points.mistakes import MISTAKES
from mffit.rig import Simulation

EXPLAINS = 0.8
"""Share of the sum of squares that one number has to explain."""
STEP = 1e-4
"""For the derivative by a set-point [rad], or relative for the load."""


@dataclass(frozen=True, slots=True)
class Shift:
    """One number of a sweep that may be off."""

    looks: str  #: with {} for the number
    shape: Callable[
        [Points, Simulation], Mapping[str, np.ndarray]
    ]  #: change of prediction less measured, per unit
    unit: float = 1.0  #: what the sentence shows of one unit
    start: float = 0.0  #: added to it
    sign: str = ""  #: channel whose sign in the rig's axes it has


def _constant(channel: str) -> Callable[[Points, Simulation], Mapping[str, np.ndarray]]:
    return lambda points, simulation: {channel: -np.ones(len(points))}


def _gain(channel: str) -> Callable[[Points, Simulation], Mapping[str, np.ndarray]]:
    return lambda points, simulation: {channel: -getattr(simulation.readings(points), channel)}


def _set_point(name: str, relative: bool = False) -> Callable[[Points, Simulation], Mapping[str, np.ndarray]]:
    def shape(points: Points, simulation: Simulation) -> Mapping[str, np.ndarray]:
        value = getattr(points, name)
        moved = points.replace(**{name: value * (1.0 + STEP) if relative else value + STEP})
        here, there = simulation.readings(points), simulation.readings(moved)
        return {"Fy": (here.Fy - there.Fy) / STEP, "Mz": (here.Mz - there.Mz) / STEP}

    return shape


SHIFTS = (
    Shift("a zero offset of {:+.3g} N in Fy_N", _constant("Fy"), sign="Fy"),
    Shift("a zero offset of {:+.3g} Nm in Mz_Nm", _constant("Mz"), sign="Mz"),
    Shift("a gain of {:.3g} in Fy_N", _gain("Fy"), start=1.0),
    Shift("a gain of {:.3g} in Mz_Nm", _gain("Mz"), start=1.0),
    Shift(
        "a sideslip axis that is {:+.2g} deg out",
        _set_point("alpha"),
        unit=float(np.degrees(1.0)),
        sign="alpha",
    ),
    Shift(
        "a camber axis that is {:+.2g} deg out",
        _set_point("gamma"),
        unit=float(np.degrees(1.0)),
        sign="gamma",
    ),
    Shift("a load that was {:+.2g} % off", _set_point("Fz", relative=True), unit=100.0),
    Shift("a pressure that was {:+.2g} % off", _set_point("p", relative=True), unit=100.0),
)


def explanation(
    points: Points, errors: Mapping[str, Prediction], simulation: Simulation, signs: Mapping[str, float]
) -> str:
    """What explains most of the errors of a sweep, in words; empty if nothing does.

    Parameters
    ----------
    points : of the sweep (m,)
    errors : prediction of each channel less what was measured
    simulation : as fitted
    signs : +1 or -1 per channel, what turns ISO-W into the rig's axes
    """
    before = _sum(errors, {n: e.error for n, e in errors.items()})
    best, said = EXPLAINS * before, ""
    for mistake in MISTAKES:
        changed = mistake.undone(points, signs)
        here, there = simulation.readings(points), simulation.readings(changed)
        moved = {n: e.error for n, e in errors.items()}
        for n in errors:
            known = np.isfinite(getattr(points, n))
            change = getattr(there, n) - getattr(here, n) - getattr(changed, n) + getattr(points, n)
            moved[n] = errors[n].error + change[known]
        gained = before - _sum(errors, moved)
        if gained > best:
            best, said = gained, mistake.looks
    for shift in SHIFTS:
        shape = {
            n: x[np.isfinite(getattr(points, n))]
            for n, x in shift.shape(points, simulation).items()
            if n in errors
        }
        solved = {n: np.linalg.solve(errors[n].covariance, x) for n, x in shape.items()}
        stiffness = sum(float(x @ solved[n]) for n, x in shape.items())
        push = sum(float(errors[n].error @ solved[n]) for n in shape)
        if stiffness > 0.0 and push**2 / stiffness > best:
            best = push**2 / stiffness
            unit = shift.unit * signs.get(shift.sign, 1.0)
            said = shift.looks.format(shift.start + unit * push / stiffness)
    return said


def _sum(errors: Mapping[str, Prediction], moved: Mapping[str, np.ndarray]) -> float:
    return sum(float(moved[n] @ np.linalg.solve(e.covariance, moved[n])) for n, e in errors.items())
