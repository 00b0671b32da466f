"""The conditions over which the model error varies smoothly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mffit.linearised import constants
from mffit.points import Points, levels
from mffit.points.clock import goes_both_ways
from mffit.points.constants import CORE
from mffit.quantities import COLUMNS, CONDITIONS, REVERSED_BY_HALF_A_TURN
from tir.constants import SMALLEST_LOAD

LEVELS = {name: kind for name, kind in levels.KINDS.items() if name != "V"}
"""Settings of a test plan of which each combination counts, and the tolerance of their levels."""
OTHER_WORDS: Mapping[str, str] = {
    "phi_t": "path curvature",
    "mount": "mount of the tyre or direction of rolling",
    "sense": "sense of the sweeps of slip",
}
ALSO: tuple[str, ...] = ("phi_t", "T", "mount")
"""Further conditions, each used only if it varies."""
SLIPS: frozenset[str] = frozenset({"alpha", "kappa"})
REVERSED: frozenset[str] = frozenset({"alpha", "gamma", "phi_t"})
"""Conditions that a mirror reverses."""


@dataclass(frozen=True, slots=True)
class Input:
    """One condition, in SI units."""

    name: str  #: field of :class:`mffit.points.Points`, or ``sense``
    lower: float  #: lower end of the tested range
    upper: float  #: upper end of the tested range
    spacing: float  #: distance of neighbouring settings
    averaged: tuple[float, ...] = ()
    """Values over which a prediction averages if it does not state the condition; empty if predictions always state it."""
    mirrored: bool = False
    """Whether the mirror images of the readings, which have the other sign of it, count as tested."""

    @property
    def width(self) -> float:
        """Width of the tested range."""
        return self.upper - self.lower

    @property
    def usual_length(self) -> float:
        """Length of a model error along it, if nothing else is known: two spacings, of a :meth:`stretched` one between the ends
        and zero.
        """
        return self.spacing if self.is_stretched else 2.0 * self.spacing

    @property
    def longest(self) -> float:
        """Longest length, with which a model error hardly changes; two curvatures of paths do not show that."""
        return self.usual_length if self.name == "phi_t" else constants.LONGEST_LENGTH * self.width

    @property
    def shown(self) -> tuple[float, float]:
        """The tested range; on both sides of zero what was tested on one, because a tyre is nearly its own mirror image."""
        end = max(-self.lower, self.upper)
        return (-end, end) if self.name in REVERSED else (self.lower, self.upper)

    def settings(self) -> np.ndarray:
        """Settings over the tested range, about a spacing apart."""
        return np.linspace(self.lower, self.upper, round(self.width / self.spacing) + 1)

    def stretched(self, values: np.ndarray) -> np.ndarray:
        """Values of a swept slip on a scale with the same ends that is stretched around zero; others as they are."""
        if not self.is_stretched:
            return values
        low, high = (np.arcsinh(end / self.spacing) for end in (self.lower, self.upper))
        out: np.ndarray = self.lower + (np.arcsinh(values / self.spacing) - low) / (high - low) * self.width
        return out

    @property
    def shortest(self) -> float:
        """Shortest length of a model error along it: nowhere more than a spacing, also where it is not :meth:`stretched`."""
        ends = np.array(
            [[end, end - np.copysign(1e-3 * self.spacing, end)] for end in (self.lower, self.upper)]
        )
        return self.spacing * float(np.min(np.abs(np.diff(self.stretched(ends)) / np.diff(ends))))

    def strayed(self, values: np.ndarray, known: np.ndarray | None = None) -> np.ndarray:
        """Variance (n,) beyond the range, up to a factor, of a curve whose slope wanders at random; 0 inside and where it is NaN.

        The values at an end and in the middle of the range show the slope there. ``known`` (n,) are other last known values of
        the condition than those of the range.
        """
        end = np.clip(values, *self.shown) if known is None else known
        beyond = self._apart(values, end)
        return np.asarray(beyond**2 * (beyond + self._apart(end, 0.5 * sum(self.shown))))

    def _apart(self, values: np.ndarray, others: np.ndarray | float) -> np.ndarray:
        """Distances (n,), 0 where they are NaN; of loads, the logarithm of their ratio."""
        is_load = self.name == "Fz"
        apart = np.log(np.maximum(values, SMALLEST_LOAD) / others) if is_load else values - others
        return np.asarray(np.abs(np.nan_to_num(apart)))

    @property
    def is_stretched(self) -> bool:
        """Whether it is a slip that sweeps move."""
        return self.name in SLIPS and not self.is_held

    @property
    def is_held(self) -> bool:
        """Whether every sweep holds the condition constant, at one of few settings."""
        return self.spacing > 1.5 * self.width / constants.DIVISIONS_OF_A_SWEEP


def word_of(name: str) -> str:
    """A condition in words."""
    return CONDITIONS[COLUMNS[name]].word if name in COLUMNS else OTHER_WORDS[name]


def forwards(points: Points) -> Points:
    """The points in axes in which the wheel rolls forwards, and a tyre that rolled backwards is turned on its rim.

    In these axes the model error is one function of the conditions, as the forces of :func:`tir.evaluate.either_way` are.
    """
    way = points.direction
    return points.replace(
        gamma=way * points.gamma, phi_t=way * points.phi_t, mount=way * points.mount, direction=np.abs(way)
    )


def turned(points: Points, channel: str) -> np.ndarray:
    """Sign (n,) of a channel in the axes of :func:`forwards` over that of its reading."""
    return points.direction if channel in REVERSED_BY_HALF_A_TURN else np.ones(len(points))


def inputs_of(points: Points) -> tuple[Input, ...]:
    """The conditions that vary in these points.

    On a disc the mirror images of the readings count too: those of the other side, between which the straight road lies.
    """
    mirrored, points = points.curved, forwards(points)
    found = []
    for name, kind in levels.KINDS.items():
        values = getattr(points, name)
        steps = levels.count(values, kind) - 1
        if steps < 1:
            continue
        most = int(constants.DIVISIONS_OF_A_SWEEP)
        widest = max(_width(values[rows]) for rows in points.rows_of_sweeps.values())
        is_swept = widest > constants.STEPS_OF_A_SWEEP * np.ptp(values) / steps
        found.append(_input(name, values, most if is_swept else min(steps, most)))
    for name in ALSO:
        values = np.asarray(getattr(points, name), dtype=float)
        if not np.all(np.isfinite(values)) or np.allclose(values, values[0]):
            continue
        if name == "T":
            usual = tuple(np.percentile(values, constants.USUAL_TEMPERATURES).tolist())
            found.append(_input(name, values, int(constants.DIVISIONS_OF_WARMING), usual))
        else:
            found.append(_input(name, values, 1))
    if np.any(sense_of_slip(points, found)):
        found.append(Input("sense", -1.0, 1.0, 1.0, (-1.0, 1.0)))
    if mirrored:
        found = [_mirrored(one) if one.name in REVERSED else one for one in found if one.name != "phi_t"]
        end = float(np.max(np.abs(points.phi_t)))
        found.append(Input("phi_t", -end, end, end, mirrored=True))
    return tuple(found)


def _mirrored(one: Input) -> Input:
    """The condition with a range that its mirror images have in common with it."""
    lower, upper = one.shown
    return replace(one, lower=lower, upper=upper, mirrored=True)


def _input(name: str, values: np.ndarray, steps: int, averaged: tuple[float, ...] = ()) -> Input:
    low, high = float(values.min()), float(values.max())
    return Input(name, low, high, (high - low) / steps, averaged)


def _width(values: np.ndarray) -> float:
    """Width of the range through which a run moves a condition, without extreme values."""
    in_order = np.sort(values)  # np.percentile takes ten times as long for few values
    low, high = np.interp(CORE, np.linspace(0.0, 100.0, len(values)), in_order)
    return float(high - low)


def swept_of(points: Points, inputs: Sequence[Input]) -> dict[int, str]:
    """By index of a sweep, the condition that it moves most, relative to the tested range."""
    out = {}
    steered = [one for one in inputs if one.name in LEVELS and one.name != "p"]
    for k, rows in points.rows_of_sweeps.items():
        moved = {one.name: np.ptp(getattr(points, one.name)[rows]) / one.width for one in steered}
        out[k] = max(moved, key=lambda name: moved[name], default="alpha")
    return out


def sense_of_slip(points: Points, inputs: Sequence[Input]) -> np.ndarray:
    """Sense (n,) of sweeps of longitudinal slip that go there and back: 1 where the slip rises, -1 where it falls; else 0.

    Nothing else describes their hysteresis, which a model error over the temperature would imitate within each sweep. That of
    an angle is a term of the fit.
    """
    out = np.zeros(len(points))
    for k, name in swept_of(points, inputs).items():
        rows = np.flatnonzero(points.sweep == k)
        if name == "kappa" and len(rows) > 2:
            way = np.sign(np.gradient(points.kappa[rows]))
            if goes_both_ways(way):
                out[rows] = way
    return out


def steadied(points: Points, inputs: Sequence[Input]) -> Points:
    """The points with every condition that a run holds at the run's mean, which removes control errors."""
    spacing = dict.fromkeys(levels.KINDS, np.inf) | {one.name: one.spacing for one in inputs}
    held = {name: np.array(getattr(points, name), dtype=float) for name in spacing.keys() - {"T", "sense"}}
    for name, values in held.items():
        for rows in points.rows_of_sweeps.values():
            if _width(values[rows]) < spacing[name]:
                values[rows] = values[rows].mean()
    return points.replace(**held)


def settings_of(points: Points, inputs: tuple[Input, ...]) -> np.ndarray:
    """The conditions (n, d) of the :func:`steadied` points."""
    steady, out = forwards(steadied(points, inputs)), np.empty((len(points), len(inputs)))
    for i, one in enumerate(inputs):
        is_sense = one.name == "sense"
        out[:, i] = sense_of_slip(forwards(points), inputs) if is_sense else getattr(steady, one.name)
    return out


def along(points: Points, inputs: tuple[Input, ...]) -> np.ndarray:
    """Position (n,) of every point in the tested range of the condition that its sweep moves, 0 to 1."""
    points, by_name = forwards(points), {one.name: one for one in inputs}
    out = np.zeros(len(points))
    for k, name in swept_of(points, inputs).items():
        rows = points.sweep == k
        if name in by_name:
            out[rows] = (getattr(points, name)[rows] - by_name[name].lower) / by_name[name].width
    return out
