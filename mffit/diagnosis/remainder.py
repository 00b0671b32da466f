"""What a fit leaves of the readings, everything that its numbers and their priors can follow projected out."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.linalg import solve_triangular

from mffit.diagnosis import constants
from mffit.fit.fitted import Fitted
from mffit.fit.problem import FitProblem
from mffit.left_out import left_out_errors
from mffit.points import Points
from mffit.points.noise import over_noise, stating
from mffit.rig import Simulation
from mffit.scatter import rms
from mffit.suspicion import LeftOutSweeps


@dataclass(frozen=True, eq=False)
class Remainder:
    """Residuals (m,) of a fit in units of their uncertainty, and the directions along which the fit explains everything.

    The m rows are all n points in each of c channels, and measured radii; rows that do not count are zero. For sound data
    the residuals have the covariance 1 - A A', in which the priors of all uncertain numbers count as readings.
    """

    points: Points
    simulation: Simulation
    channels: tuple[str, ...]  #: (c,)
    residual: np.ndarray = field(repr=False)  #: (m,) measured minus model
    axes: np.ndarray = field(repr=False)  #: (m, k) the matrix A
    sigma: np.ndarray = field(repr=False)  #: (c n,) uncertainty [N], [Nm]; inf: not used
    free: frozenset[str]  #: names of the coefficients that the fit freed
    expected: Mapping[str, tuple[float, float]]  #: prior of every other uncertain number: value and spread
    noise: Mapping[str, float]  #: by channel, misfit over stated noise; NaN where none is stated

    @property
    def used(self) -> np.ndarray:
        """Mask (c n,) of the readings that count."""
        return np.isfinite(self.sigma)

    @property
    def sweep(self) -> np.ndarray:
        """Number (m,) of the sweep of every row; -1 for the radii."""
        radii = np.full(len(self.residual) - len(self.sigma), -1)
        return np.concatenate([*(self.points.sweep for _ in self.channels), radii])

    @property
    def at_noise(self) -> bool:
        """Whether the readings state a noise and the fit reaches it, so that residuals are independent."""
        known = [x for x in self.noise.values() if np.isfinite(x)]
        return bool(known) and max(known) <= constants.MISFIT_AT_NOISE

    def outside(self, x: np.ndarray) -> np.ndarray:
        """Changes (m,) or (m, j) without what the fitted numbers follow."""
        return x - self.axes @ (self.axes.T @ x)

    def whitened(self, change: np.ndarray) -> np.ndarray:
        """Changes of the readings (c n, j) as rows (m, j) in units of the uncertainty."""
        rows = np.zeros((len(self.residual), change.shape[1]))
        rows[: len(self.sigma)] = np.nan_to_num(change) / self.sigma[:, None]
        return rows

    def left_out(self, group: np.ndarray) -> np.ndarray:
        """Residuals (m,) of each group (m,), counted from 0, as all other rows predict it, to first order."""
        k = self.axes.shape[1]
        information = (1.0 + constants.INFORMATION_LEFT) * np.eye(k)
        return left_out_errors(self.axes, self.residual, information, np.zeros(k), group)


def remainder(fitted: Fitted) -> Remainder:
    """The remainder of a fit at its solution.

    Readings count with their stated uncertainty, or more if the misfit is larger; without one, with the misfit of their channel.
    Outliers do not count. Coefficients that the fit held with a known spread are as uncertain as that. Of very many points,
    evenly spaced ones are examined as if they were all.
    """
    problem, noise = _weighted(fitted)
    numbers = [n for n in fitted.numbers if n.name not in fitted.at_bound]
    held = [name for name in fitted.held if name in problem.simulation.values]
    names = [*(n.name for n in numbers), *held]
    at = np.array([problem.value(name) for name in names])
    spread = np.array([*(n.spread for n in numbers), *(fitted.held[name] for name in held)])
    expected = np.array([*(n.expected for n in numbers), *at[len(numbers) :]])
    every = -(-len(problem.points) // constants.MOST_POINTS_EXAMINED)
    data, slope = problem.rows(names, every)
    problem = problem.select(np.arange(0, len(problem.points), every))
    before = -data + slope @ np.where(np.isfinite(spread), at - expected, 0.0)
    axes = _axes(slope, np.maximum(spread, 1e-300) ** -2.0)
    free = frozenset(n.name for n in fitted.numbers if n.name in problem.simulation.values)
    priors = zip(names, zip(expected.tolist(), spread.tolist(), strict=True), strict=True)
    return Remainder(
        points=problem.points,
        simulation=problem.simulation,
        channels=problem.channels,
        residual=before - axes @ (axes.T @ before),
        axes=axes,
        sigma=np.concatenate(list(problem.sigma.values())),
        free=free,
        expected={name: prior for name, prior in priors if name not in free},
        noise=noise,
    )


def log_of(chance: float) -> float:
    """Natural logarithm of a probability; minus infinity where it is too small to be a number."""
    return math.log(chance) if chance > 0.0 else -math.inf


def _axes(J: np.ndarray, precision: np.ndarray) -> np.ndarray:
    """The matrix A (m, k) with A A' = J (J'J + P)^-1 J'."""
    information = J.T @ J + np.diag(precision)
    scale = 1.0 / np.sqrt(np.maximum(np.diag(information), 1e-30))
    ridge = constants.INFORMATION_LEFT * np.eye(len(scale))
    factor = np.linalg.cholesky(information * scale * scale[:, None] + ridge)
    axes = solve_triangular(factor, (J * scale).T, lower=True).T
    return np.asfortranarray(axes)  # by columns, as derivatives are in memory


def _weighted(fitted: Fitted) -> tuple[FitProblem, dict[str, float]]:
    """The problem with the uncertainties that the residuals are judged by, and the misfit over the stated noise."""
    problem, points = fitted.problem, fitted.problem.points
    sigma, noise = {}, {}
    for name, read in problem.readings().items():
        stated, measured = points.u(name), points.channel(name)
        used = np.isfinite(problem.sigma[name]) & np.isfinite(measured)
        noise[name] = over_noise(read, measured, stated, used).ratio
        silent = used & ~stating(stated)
        u = np.where(
            silent, rms((read - measured)[silent]), stated * max(1.0, np.nan_to_num(noise[name], nan=1.0))
        )
        sigma[name] = np.where(used, u, np.inf)
    return replace(problem, sigma=sigma), noise


def left_out_sweeps(left: Remainder) -> dict[str, LeftOutSweeps]:
    """By channel, how well sweeps are predicted from all others."""
    n = len(left.points)
    predicted = left.left_out(np.unique(left.sweep, return_inverse=True)[1])
    out = {}
    for k, name in enumerate(left.channels):
        part = slice(k * n, (k + 1) * n)
        u = np.where(left.used[part], left.sigma[part], np.nan)
        fits, predictions = left.residual[part] * u, predicted[part] * u  # NaN where not used
        sweeps = np.unique(left.points.sweep[left.used[part]])
        if not len(sweeps):
            continue
        out[name] = LeftOutSweeps(
            sweeps=len(sweeps),
            fitted=rms(fits),
            predicted=rms(predictions),
            typical=float(np.median([rms(predictions[left.points.sweep == j]) for j in sweeps])),
        )
    return out
