"""What the error of a doubtful sweep looks like: a known mistake, or one number that is off."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass

import numpy as np

from mffit.linearised.mixed import LeftOutReadings
from mffit.points import Points
from mffit.quantities import CHANNELS, column
from mffit.rig import Simulation
from mffit.rig_errors import BY_NAME
from mffit.rounding import to_uncertainty
from mffit.suspicion import constants
from mffit.suspicion.mistakes import MISTAKES

DEGREES = float(np.degrees(1.0))
STEP = 1e-4
"""Step of the difference quotient over a set-point [rad], or relative for load and pressure."""
Shape = Callable[[Points, Simulation, Collection[str]], Mapping[str, np.ndarray]]
"""Change of measured less predicted in some channels, per unit of a number, by channel."""


@dataclass(frozen=True, slots=True)
class Shift:
    """One number of a sweep that may be off."""

    looks: str  #: with {} for the number
    shape: Shape
    possible: tuple[float, float] = (-math.inf, math.inf)  #: least and largest number that a rig can have
    unit: float = 1.0  #: by which the number is multiplied in the sentence
    start: float = 0.0  #: added to it there
    sign: str = ""  #: channel whose sign in the rig's axes the number has


def _constant(channel: str) -> Shape:
    return lambda points, simulation, among: {channel: np.ones(len(points))}


def _gain(channel: str) -> Shape:
    def shape(points: Points, simulation: Simulation, among: Collection[str]) -> Mapping[str, np.ndarray]:
        return {channel: simulation.readings(points, (channel,))[channel]} if channel in among else {}

    return shape


def _set_point(name: str, relative: bool = False) -> Shape:
    def shape(points: Points, simulation: Simulation, among: Collection[str]) -> Mapping[str, np.ndarray]:
        value = getattr(points, name)
        moved = points.replace(**{name: value * (1.0 + STEP) if relative else value + STEP})
        here, there = simulation.readings(points, among), simulation.readings(moved, among)
        return {channel: (there[channel] - here[channel]) / STEP for channel in here}

    return shape


POSITIVE = (-1.0, math.inf)
"""Of a change relative to a number that is positive in any case."""
SIDESLIP, CAMBER = (
    (zero.lower / DEGREES, zero.upper / DEGREES) for zero in (BY_NAME["alpha_0_deg"], BY_NAME["gamma_0_deg"])
)
SHIFTS = (
    *(
        Shift(f"a zero offset of {{}} {known.unit} in {column(name)}", _constant(name), sign=name)
        for name, known in CHANNELS.items()
    ),
    *(Shift(f"a gain of {{}} in {column(name)}", _gain(name), POSITIVE, start=1.0) for name in CHANNELS),
    Shift("a sideslip axis that is {} deg out", _set_point("alpha"), SIDESLIP, unit=DEGREES, sign="alpha"),
    Shift("a camber axis that is {} deg out", _set_point("gamma"), CAMBER, unit=DEGREES, sign="gamma"),
    Shift("a load that was {} % off", _set_point("Fz", relative=True), POSITIVE, unit=100.0),
    Shift("a pressure that was {} % off", _set_point("p", relative=True), POSITIVE, unit=100.0),
)


def explanation(
    points: Points, errors: Mapping[str, LeftOutReadings], simulation: Simulation, signs: Mapping[str, float]
) -> str:
    """What explains most of the errors of a sweep, in words; empty if no known cause does.

    ``signs`` lead from ISO-W to the rig's axes.
    """
    before = _chi2(errors, {n: e.error for n, e in errors.items()})
    best, said = constants.EXPLAINED_BY_ONE_NUMBER * before, ""
    for mistake in MISTAKES:
        gained = before - _chi2(errors, _undone(points, errors, simulation, mistake.undone(points, signs)))
        if gained > best:
            best, said = gained, mistake.looks
    for shift in SHIFTS:
        gained, size, u = _fitted(points, errors, shift.shape(points, simulation, errors))
        if gained > best and shift.possible[0] < size < shift.possible[1]:
            best = gained
            value = shift.start + shift.unit * signs.get(shift.sign, 1.0) * size
            said = shift.looks.format(to_uncertainty(value, shift.unit * u, "" if shift.start else "+"))
    return said


def _undone(
    points: Points, errors: Mapping[str, LeftOutReadings], simulation: Simulation, changed: Points
) -> dict[str, np.ndarray]:
    """The errors with a mistake undone, to first order."""
    here, there = simulation.readings(points, errors), simulation.readings(changed, errors)
    moved = {}
    for n, e in errors.items():
        known = np.isfinite(points.channel(n))
        change = changed.channel(n) - points.channel(n) - (there[n] - here[n])
        moved[n] = e.error + change[known]
    return moved


def _fitted(
    points: Points, errors: Mapping[str, LeftOutReadings], shapes: Mapping[str, np.ndarray]
) -> tuple[float, float, float]:
    """Chi-square that a multiple of the shapes removes, the multiple and its standard uncertainty."""
    curvature = gradient = 0.0
    for n, e in errors.items():
        if n in shapes:
            shape = shapes[n][np.isfinite(points.channel(n))]
            solved = np.linalg.solve(e.covariance, shape)
            curvature += float(shape @ solved)
            gradient += float(e.error @ solved)
    if curvature <= 0.0:
        return 0.0, 0.0, 0.0
    return gradient**2 / curvature, gradient / curvature, curvature**-0.5


def _chi2(errors: Mapping[str, LeftOutReadings], moved: Mapping[str, np.ndarray]) -> float:
    return sum(float(moved[n] @ np.linalg.solve(e.covariance, moved[n])) for n, e in errors.items())
