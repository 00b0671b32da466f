"""Coefficients with which one file imitates a model that the formula in that use cannot be: least squares over a range."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from mffit import least_squares
from mffit.fit.constraints import Envelope, limits
from mffit.fit.road import Road
from mffit.least_squares import Linear, Number
from mffit.quantities import CHANNELS
from mffit.rig import Readings
from tir.derivatives import gradient, plain, traced
from tir.outputs import outputs_of

SCALE = {"Fy": 0.01, "Mz": 0.001}
"""Unit of the residual, per nominal load [N/N, m]: the size of the misfit that the formula cannot avoid."""
LIMIT_WEIGHT = 15.0
"""Residual per unit of a broken limit, the rms misfit being of the order of 1."""


class Goal(NamedTuple):
    """What the file is to reproduce in one use."""

    road: Road
    turn_slip: bool  #: whether the simulation computes turn slip
    phi_t: float  #: path curvature, ISO, of every condition [1/m]
    Fy: np.ndarray  #: (n,) [N]
    Mz: np.ndarray  #: (n,) [Nm]
    weight: np.ndarray  #: (n,)


class Lines(NamedTuple):
    """Lines over camber along which the side force may not turn back."""

    road: Road
    points: int  #: conditions of each line
    falls: np.ndarray  #: (lines, points - 1) bool: where the force of the model falls


def forces(values: Mapping[str, Any], road: Road, *, turn_slip: bool, phi_t: float = 0.0) -> Readings:
    """Fy [N] and Mz [Nm] of a file on the road."""
    return Readings(*_wanted(tuple(CHANNELS), values, road, turn_slip, phi_t))


def force(channel: str, values: Mapping[str, Any], road: Road, *, turn_slip: bool, phi_t: float = 0.0) -> Any:
    """One of the two, plain or traced."""
    return _wanted((channel,), values, road, turn_slip, phi_t)[0]


def _wanted(
    names: tuple[str, ...], values: Mapping[str, Any], road: Road, turn_slip: bool, phi_t: float
) -> list[Any]:
    path = {"phi_t": phi_t} if phi_t else {}
    return outputs_of(names, SimpleNamespace(**values), {**road._asdict(), **path}, turn_slip=turn_slip)


def goal(
    model: Mapping[str, Any], road: Road, weight: np.ndarray, *, turn_slip: bool, phi_t: float = 0.0
) -> Goal:
    """A goal that the model itself sets, which is right with turn slip on."""
    out = forces(model, road, turn_slip=True, phi_t=phi_t)
    return Goal(road, turn_slip, phi_t, out.Fy, out.Mz, weight)


class Imitation(NamedTuple):
    """One channel of a file against its goals."""

    channel: str  #: "Fy" or "Mz"
    fixed: Mapping[str, Any]  #: every value of the file
    goals: tuple[Goal, ...]
    envelope: Envelope  #: where the physical limits hold
    lines: Lines | None = None

    def solve(self, numbers: Sequence[Number], *, steps: int, tolerance: float) -> least_squares.Solution:
        """The nearest file, with the numbers free."""
        names = [n.name for n in numbers]

        def residual(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            here = self._rows(dict(zip(names, x.tolist(), strict=True)), derive=False)
            return here.data, here.limits

        def linear(x: np.ndarray) -> Linear:
            return self._rows(dict(zip(names, x.tolist(), strict=True)), derive=True)

        problem = least_squares.Problem(residual, linear)
        return least_squares.solve(problem, numbers, max_steps=steps, tolerance=tolerance)

    def _rows(self, free: Mapping[str, float], *, derive: bool) -> Linear:
        """Misfits, weighted; broken limits and camber thrust that turns back; with derivatives if wanted."""
        numbers: Mapping[str, Any] = traced(free) if derive else free
        values = {**self.fixed, **numbers}
        wrt = list(numbers.values()) if derive else []
        unit = SCALE[self.channel] * float(self.fixed["FNOMIN"])
        data, slopes = [], []
        for goal in self.goals:
            out = force(self.channel, values, goal.road, turn_slip=goal.turn_slip, phi_t=goal.phi_t)
            factor = np.sqrt(goal.weight / goal.weight.sum()) / unit
            data.append((plain(out) - getattr(goal, self.channel)) * factor)
            slopes.append(gradient(out, wrt) * factor[:, None])
        broken, broken_slopes = self._broken(values, wrt, unit)
        return Linear(np.concatenate(data), np.concatenate(slopes), broken, broken_slopes)

    def _broken(
        self, values: Mapping[str, Any], wrt: list[Any], unit: float
    ) -> tuple[np.ndarray, np.ndarray]:
        size = self.envelope.size
        rows = limits(SimpleNamespace(**values), self.envelope)
        value = [LIMIT_WEIGHT * np.broadcast_to(plain(row), size) for row in rows]
        slope = [LIMIT_WEIGHT * np.broadcast_to(gradient(row, wrt), (size, len(wrt))) for row in rows]
        if self.lines is not None:
            Fy = force("Fy", values, self.lines.road, turn_slip=False)
            shape = (len(self.lines.falls), self.lines.points)
            steps = np.diff(plain(Fy).reshape(shape))
            value.append((np.where(self.lines.falls, steps, 0.0) / unit).ravel())
            by = np.diff(gradient(Fy, wrt).reshape(*shape, len(wrt)), axis=1) / unit
            slope.append(by.reshape(steps.size, len(wrt)))
        over = np.concatenate(value)
        return np.maximum(over, 0.0), np.concatenate(slope) * (over > 0.0)[:, None]
