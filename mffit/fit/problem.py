"""The least-squares problem: what the model says at the raw points, against what was measured."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from mffit.fit.constraints import Envelope, violations
from mffit.points import Points
from mffit.rig import readings

CONSTRAINT_WEIGHT = 3000.0
"""Residual in units of noise per unit of violation; large enough to hold, small enough to keep the problem smooth."""


@dataclass(frozen=True, slots=True)
class Problem:
    """Residuals of a set of points; built once, evaluated for many parameter values."""

    points: Points
    fixed: Mapping[str, Any]  #: every value of the file, before the free ones replace theirs
    sigma_Fy: np.ndarray  #: (n,) standard uncertainty used as weight [N]; inf where not used
    sigma_Mz: np.ndarray  #: (n,) [Nm]
    prior: Mapping[
        str, tuple[float, float]
    ]  #: name -> (expected value, spread) of coefficients that are tied
    envelope: Envelope | None = None
    turn_slip: bool = True
    tie: tuple[Points, float, float] | None = (
        None  #: (points, side force, weight) whose mean the model must give
    )
    play: float = 0.0  #: backlash of the sideslip axis [rad]
    alpha_read: np.ndarray | None = None  #: (n,) sideslip as read, before the play was taken up [rad]

    def parameters(self, free: Mapping[str, float]) -> SimpleNamespace:
        """All parameters with the free values in place."""
        return SimpleNamespace(**{**self.fixed, **free})

    def model(self, free: Mapping[str, float]):
        """Readings (Fy [N], Mz [Nm]) of the model at the points."""
        return readings(self.parameters(free), self.points, turn_slip=self.turn_slip)

    def settled(self, free: Mapping[str, float]) -> Problem:
        """The same with the play taken up as the model's moment says, which has no noise."""
        if not self.play or self.alpha_read is None:
            return self
        at_reading = readings(
            self.parameters(free), self.points.replace(alpha=self.alpha_read), turn_slip=self.turn_slip
        )
        return replace(
            self, points=self.points.replace(alpha=self.alpha_read - 0.5 * self.play * np.sign(at_reading.Mz))
        )

    def data_residual(self, free: Mapping[str, float]) -> np.ndarray:
        """(model - measured) / sigma for Fy and then Mz, shape (2n,); 0 where a channel is not used."""
        Fy, Mz = self.model(free)
        return np.concatenate(
            [_weighted(Fy - self.points.Fy, self.sigma_Fy), _weighted(Mz - self.points.Mz, self.sigma_Mz)]
        )

    def residual(self, free: Mapping[str, float]) -> np.ndarray:
        """The data's residual, followed by the tied coefficients and the broken limits."""
        rows = [self.data_residual(free)]
        rows.append(np.array([(free[n] - v) / s for n, (v, s) in self.prior.items() if n in free]))
        if self.envelope is not None:
            rows.append(CONSTRAINT_WEIGHT * violations(self.parameters(free), self.envelope))
        if self.tie is not None:
            zero_points, force, weight = self.tie
            Fy = readings(self.parameters(free), zero_points, turn_slip=self.turn_slip).Fy
            rows.append(np.array([(Fy.mean() - force) * weight]))
        return np.concatenate(rows)


def _weighted(difference: np.ndarray, sigma: np.ndarray) -> np.ndarray:
    used = np.isfinite(sigma) & np.isfinite(difference)
    return np.where(used, np.where(used, difference, 0.0) / np.where(used, sigma, 1.0), 0.0)
