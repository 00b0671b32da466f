"""Fit of a file for one use (such as turn slip off) to the forces of the fitted model: least squares over the file's ranges."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from mffit.fit import constants
from mffit.fit.constraints import Envelope, limits
from mffit.fit.written.road import Road
from mffit.least_squares import FreeNumber, LeastSquaresProblem, Linear, Minimum, minimum
from mffit.quantities import SIDEWAYS
from mffit.rig import Readings
from tir.derivatives import gradient, plain, traced
from tir.outputs import outputs_of

MISFIT_UNIT = {"Fy": constants.MISFIT_UNIT_FY, "Mz": constants.MISFIT_UNIT_MZ}
"""By channel, unit of the residual over nominal load [N/N, m]."""


class ForcesToReproduce(NamedTuple):
    """Forces that the file is to reproduce in one use."""

    road: Road
    turn_slip: bool  #: whether the simulation computes turn slip
    phi_t: float  #: path curvature, ISO, of every condition [1/m]
    forces: Readings
    weight: np.ndarray  #: (n,)


class Lines(NamedTuple):
    """Lines of camber along which the side force may fall only where the model's falls."""

    road: Road
    points: int  #: conditions of each line
    falls: np.ndarray  #: (lines, points - 1) bool: where the force of the model falls


def forces(values: Mapping[str, Any], road: Road, *, turn_slip: bool, phi_t: float = 0.0) -> Readings:
    """Fy [N] and Mz [Nm] of a file on the road."""
    found = _outputs(tuple(SIDEWAYS), values, road, turn_slip, phi_t)
    return Readings(**dict(zip(SIDEWAYS, found, strict=True)))


def force(channel: str, values: Mapping[str, Any], road: Road, *, turn_slip: bool, phi_t: float = 0.0) -> Any:
    """One channel of a file on the road, plain or traced."""
    return _outputs((channel,), values, road, turn_slip, phi_t)[0]


def _outputs(
    names: tuple[str, ...], values: Mapping[str, Any], road: Road, turn_slip: bool, phi_t: float
) -> list[Any]:
    path = {"phi_t": phi_t} if phi_t else {}
    return outputs_of(names, SimpleNamespace(**values), {**road._asdict(), **path}, turn_slip=turn_slip)


def goal(
    model: Mapping[str, Any], road: Road, weight: np.ndarray, *, turn_slip: bool, phi_t: float = 0.0
) -> ForcesToReproduce:
    """The forces of the fitted model, which is meant for turn slip on, as the goal of a file for ``turn_slip``."""
    return ForcesToReproduce(road, turn_slip, phi_t, forces(model, road, turn_slip=True, phi_t=phi_t), weight)


class Imitation(NamedTuple):
    """One channel of a file and its goals."""

    channel: str  #: "Fy" or "Mz"
    fixed: Mapping[str, Any]  #: every value of the file
    goals: tuple[ForcesToReproduce, ...]
    envelope: Envelope  #: over which the physical limits hold
    lines: Lines | None = None

    def solve(self, numbers: Sequence[FreeNumber]) -> Minimum:
        """The coefficients that come nearest to the goals."""
        names = [n.name for n in numbers]

        def residual(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            here = self._residuals(dict(zip(names, x.tolist(), strict=True)), derive=False)
            return here.data, here.limits

        def linear(x: np.ndarray) -> Linear:
            return self._residuals(dict(zip(names, x.tolist(), strict=True)), derive=True)

        problem = LeastSquaresProblem(residual, linear)
        return minimum(problem, numbers, tolerance=constants.REFIT_TOLERANCE)

    @property
    def _unit(self) -> float:
        """Unit of the residual [N] or [Nm]."""
        return MISFIT_UNIT[self.channel] * float(self.fixed["FNOMIN"])

    def _residuals(self, free: Mapping[str, float], *, derive: bool) -> Linear:
        """Weighted misfits and limits, with derivatives by the free values if wanted."""
        numbers: Mapping[str, Any] = traced(free) if derive else free
        values = {**self.fixed, **numbers}
        by = list(numbers.values()) if derive else []
        data, slopes = [], []
        for goal in self.goals:
            out = force(self.channel, values, goal.road, turn_slip=goal.turn_slip, phi_t=goal.phi_t)
            factor = np.sqrt(goal.weight / goal.weight.sum()) / self._unit
            data.append((plain(out) - getattr(goal.forces, self.channel)) * factor)
            slopes.append(gradient(out, by) * factor[:, None])
        return Linear(np.concatenate(data), np.concatenate(slopes), *self._limits(values, by))

    def _limits(self, values: Mapping[str, Any], by: list[Any]) -> tuple[np.ndarray, np.ndarray]:
        """Residuals of the physical limits and of the lines of camber, above 0 where broken, with derivatives."""
        value, slope = limits(SimpleNamespace(**values), self.envelope, by)
        weight = constants.LIMIT_WEIGHT_OF_DERIVED_FILE
        over, by_number = weight * value, weight * slope
        if self.lines is not None:
            reversal, reversal_slope = self._reversal(values, by, self.lines)
            over = np.concatenate([over, reversal])
            by_number = np.concatenate([by_number, reversal_slope])
        return over, by_number

    def _reversal(
        self, values: Mapping[str, Any], by: list[Any], lines: Lines
    ) -> tuple[np.ndarray, np.ndarray]:
        """Steps of the side force along the lines of camber, above 0 where it rises and the model's falls."""
        Fy = force("Fy", values, lines.road, turn_slip=False)
        shape = (len(lines.falls), lines.points)
        steps = np.diff(plain(Fy).reshape(shape))
        slope = np.diff(gradient(Fy, by).reshape(*shape, len(by)), axis=1) / self._unit
        return (np.where(lines.falls, steps, 0.0) / self._unit).ravel(), slope.reshape(steps.size, len(by))
