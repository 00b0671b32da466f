"""What the readings really scatter like: scale, growth with the reading, memory along sweeps, wild readings.

Every part is accepted only if the data ask for it. What effects, inexact coefficients and smooth structure could bring is
allowed for with its own prior, so that the scatter is what none of them explains.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_solve, cholesky, solve_triangular
from scipy.optimize import minimize
from scipy.stats import norm, t

from mffit.diagnosis.noise import Noise, Scatter
from mffit.quantities import CHANNELS
from mffit.scatter import rms, robust

STATED_WITHIN = math.log(2.0)
"""Standard deviation of the logarithm of what uncertainties are over what they are stated to be."""
NEEDED = 4.0
"""Gain in log likelihood at which a part of the scatter is accepted."""
SCALES = (-7.0, 12.0)
"""Logarithm of the smallest and the largest scale; its prior keeps it near 0 where the data do not insist."""
LARGEST_GROWTH, LARGEST_MEMORY, LARGEST_SMOOTH = 0.2, 0.97, 0.3
NEUTRAL = (0.0, 0.005, 0.3, 0.1)
"""Logarithm of the scale, growth, memory and smooth amplitude from which the scatter is searched for a second time: a long
memory and a large scale stand in for each other, and the search ends where it began."""
TAILS = (2.0, 2.5, 3.0, 4.0, 6.0, 10.0, 20.0)
ROUNDS = 4
ENOUGH = 700
"""Readings of a channel from which its scatter is learned; weights are found for all."""
FEWEST_CHAINS = 8
WILD = 4.5
"""Standard errors from everything that could explain it at which a reading is listed as an outlier."""


@dataclass(frozen=True, slots=True)
class Explained:
    """What could explain a residual, one prior standard deviation of each as a column (2n, k)."""

    named: np.ndarray  #: effects, coefficients, bumps
    runs: np.ndarray  #: effects that are the same along a run, the rivals of errors that are alike along it
    smooth: np.ndarray  #: low-order structure; its amplitude is found with the scatter


def learned(noise: Noise, residual: np.ndarray, explained: Explained, size: np.ndarray) -> Noise:
    """The noise with the scatter that the residual shows.

    Parameters
    ----------
    noise : as stated, or as found before; where the search starts
    residual : (2n,) measured minus simulated
    explained : what other causes could bring
    size : (2n,) readings that a growing part is in proportion to
    """
    n = len(residual) // 2
    weight, scatter = np.ones(2 * n), dict(noise.scatter)
    for name, first in (("Fy", 0), ("Mz", n)):
        rows = np.arange(first, first + n)
        rows = rows[np.isfinite(noise.stated[rows])]
        if len(rows):
            channel = _Channel(
                noise.stated[rows], np.nan_to_num(residual[rows]), explained.named[rows],
                explained.runs[rows], explained.smooth[rows], np.abs(np.nan_to_num(size[rows])), noise.chain[rows],
            )  # fmt: skip
            scatter[name], weight[rows] = channel.learned(noise.scatter[name])
    return noise.scattering(scatter, size, weight)


class _Channel:
    """The used readings (m,) of one channel."""

    def __init__(self, stated, residual, named, runs, smooth, size, chain) -> None:
        self.stated, self.residual, self.size = stated, residual, size
        self.named = named[:, np.any(named != 0.0, axis=0)]
        self.runs = runs[:, np.any(runs != 0.0, axis=0)]
        self.smooth = smooth[:, np.any(smooth != 0.0, axis=0)]
        order = np.argsort(chain, kind="stable")
        follows = chain[order][1:] == chain[order][:-1]
        self.later, self.earlier = order[1:][follows], order[:-1][follows]
        self.weight = np.ones(len(stated))
        self.part = _some_chains(chain)

    def learned(self, start: Scatter) -> tuple[Scatter, np.ndarray]:
        """The scatter, and the weight of every reading (m,)."""
        first = np.array([math.log(start.scale), start.growth, start.memory, 0.03])
        x, tails = self._weighed(first)
        if x[2] and self.runs.shape[1]:
            memory, named = self.likelihood(x), self.named
            self.named = np.hstack([named, self.runs])
            if self.likelihood(self._parts(x)) - memory > NEEDED:
                x, tails = self._weighed(x)
            else:
                self.named = named
        return Scatter(math.exp(x[0]), float(x[1]), float(x[2]), tails), self.weight

    def _weighed(self, x: np.ndarray) -> tuple[np.ndarray, float]:
        """Scale, growth, memory and smooth amplitude (4,) and the tails, the weights found with them."""
        tails = math.inf
        for _ in range(ROUNDS):
            x = self._parts(x)
            z = self.alone(x)
            before, (tails, width) = tails, heavy_tails(z)
            weight = np.ones(len(z)) if math.isinf(tails) else (tails + 1.0) / (tails + (z / width) ** 2)
            settled = np.max(np.abs(np.sqrt(weight) - np.sqrt(self.weight))) < 0.05
            self.weight = weight
            if settled or (math.isinf(tails) and math.isinf(before)):
                break
        return x, tails

    def _parts(self, start: np.ndarray) -> np.ndarray:
        """Scale, growth, memory and smooth amplitude (4,), without the parts that the data do not ask for."""
        climbs = [self._climb(x, (0, 1, 2, 3)) for x in (start, np.array(NEUTRAL))]
        best, whole = max(climbs, key=lambda climb: climb[1])
        for part in (1, 2):
            reduced = best.copy()
            reduced[part] = 0.0
            free = tuple(k for k in (0, 1, 2, 3) if k != part and (k in (0, 3) or best[k]))
            other, less = self._climb(reduced, free)
            if whole - less < NEEDED:
                best, whole = other, less
        return best

    def _climb(self, start: np.ndarray, free: tuple[int, ...]) -> tuple[np.ndarray, float]:
        bounds = np.array([SCALES, (0.0, LARGEST_GROWTH), (-0.2, LARGEST_MEMORY), (1e-4, LARGEST_SMOOTH)])
        unit = np.array([1.0, 0.02, 1.0, 0.05])
        chosen = list(free)

        def full(y: np.ndarray) -> np.ndarray:
            x = start.copy()
            x[chosen] = y * unit[chosen]
            return x

        first = start.copy()
        if 1 in free and not first[1]:
            first[1] = 0.004
        found = minimize(
            lambda y: -self.likelihood(full(y)),
            first[chosen] / unit[chosen],
            bounds=bounds[chosen] / unit[chosen][:, None],
            method="L-BFGS-B",
            options={"maxiter": 20, "ftol": 1e-6},
        )
        return full(found.x), -float(found.fun)

    def _white(self, x: np.ndarray, part: np.ndarray | None) -> tuple[np.ndarray, np.ndarray, float]:
        """Residual (m,) and columns (m, k) in units of the scatter, and the logarithm of what was divided by.

        Of some whole sweeps (mask (m,)), or of all readings.
        """
        scale, growth, memory, amplitude = math.exp(x[0]), x[1], x[2], x[3]
        u = np.hypot(scale * self.stated, growth * self.size) / np.sqrt(self.weight)
        rows = np.arange(len(u)) if part is None else np.flatnonzero(part)
        u = u[rows]
        A = np.column_stack([self.residual[rows], self.named[rows], amplitude * self.smooth[rows]])
        A /= u[:, None]
        log = float(np.sum(np.log(u)))
        if memory:
            own = math.sqrt(1.0 - memory**2)
            place = np.full(len(self.stated), -1)
            place[rows] = np.arange(len(rows))
            inside = place[self.later] >= 0
            later, earlier = place[self.later[inside]], place[self.earlier[inside]]
            A[later] = (A[later] - memory * A[earlier]) / own
            log += len(later) * math.log(own)
        return A[:, 0], A[:, 1:], log

    def likelihood(self, x: np.ndarray) -> float:
        """Log likelihood of the residual, everything else integrated out, with the prior of the scale."""
        r, A, log = self._white(x, self.part)
        root = cholesky(A.T @ A + np.eye(A.shape[1]), lower=True, check_finite=False)
        b = solve_triangular(root, A.T @ r, lower=True, check_finite=False)
        log += float(np.sum(np.log(np.diag(root))))
        return -0.5 * float(r @ r - b @ b) - log - 0.5 * (x[0] / STATED_WITHIN) ** 2

    def alone(self, x: np.ndarray) -> np.ndarray:
        """Every reading (m,) against what all others say of it, in units of the joint uncertainty at weight 1."""
        r, A, _ = self._white(x, None)
        root = cholesky(A.T @ A + np.eye(A.shape[1]), lower=True, check_finite=False)
        left = r - A @ cho_solve((root, True), A.T @ r, check_finite=False)
        B = solve_triangular(root, A.T, lower=True, check_finite=False)
        variance = np.maximum(1.0 - np.sum(B * B, axis=0), 1e-3)
        if x[2]:
            return left / np.sqrt(variance)
        # with the weight taken off again: own scatter at weight 1, and what the others leave open
        own = 1.0 / np.sqrt(self.weight)
        free = (
            left / variance * own
        )  # the reading less the prediction by all others, in units of u at weight 1
        open_ = (1.0 / variance - 1.0) * own**2
        return free / np.sqrt(1.0 + open_)


def _some_chains(chain: np.ndarray) -> np.ndarray | None:
    """Mask (m,) of every k-th sweep where there are more readings than scale, growth and memory need; None for all."""
    names = np.unique(chain)
    step = min(math.ceil(len(chain) / ENOUGH), max(len(names) // FEWEST_CHAINS, 1))
    return np.isin(chain, names[::step]) if step > 1 else None


def heavy_tails(z: np.ndarray) -> tuple[float, float]:
    """Degrees of freedom and width of Student's t that standardised residuals (m,) follow; infinite if they are normal."""
    width = rms(z)
    best, found = float(np.sum(norm.logpdf(z, scale=width))) + NEEDED, (math.inf, width)
    core = robust(z) or 1.0
    for dof in TAILS:
        width = core
        for _ in range(30):
            width = math.sqrt(float(np.mean((dof + 1.0) * z**2 / (dof + (z / width) ** 2))))
        value = float(np.sum(t.logpdf(z, dof, scale=width)))
        if value > best:
            best, found = value, (dof, width)
    return found


def wild(noise: Noise) -> np.ndarray:
    """Indices of readings that lost nearly all their weight."""
    if noise.weight is None:
        return np.empty(0, dtype=int)
    half = len(noise.weight) // 2
    tails = np.repeat([noise.scatter[name].tails for name in CHANNELS], half)
    heavy = np.isfinite(tails) & np.isfinite(noise.stated)
    known = np.where(heavy, tails, 1.0)
    return np.flatnonzero(heavy & (noise.weight < (known + 1.0) / (known + WILD**2)))
