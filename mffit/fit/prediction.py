"""What all other sweeps say of each sweep: prediction with the sweep left out, from the one fit to all of them.

To first order no second fit is needed. With J the derivatives of a group's residuals r in units of their weight, and C the
covariance of the fit, the others leave the covariance A^-1 with A = C^-1 - J^T J, and the numbers move by A^-1 J^T r when the
group is taken out (Belsley, Kuh and Welsch, Regression Diagnostics, 1980, section 2.1, there with the hat matrix J C J^T).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from mffit.fit.problem import FitProblem
from mffit.least_squares import Number, inverse, root
from mffit.points import Points, levels
from mffit.quantities import CHANNELS
from mffit.rig_errors import RIG_ERRORS

FEWEST = 4
"""Points that make a sweep."""
MOST = 0.5
"""Share of all points from which on the others say too little of a sweep."""
UNKNOWN = 1e-3
"""Share of a direction's information that comes from the others below which they say nothing of it."""
SHOWN = 300
"""Points of a group at which it is judged; of more, evenly spaced ones say the same."""
COMMON = tuple(
    error.name
    for error in RIG_ERRORS
    if error.kind != "tyre" and error.name not in ("backlash_deg", "path_radius_m")
)
"""Errors of a rig that all sweeps share; they are no contradiction of one sweep, and are let free, to first order."""


@dataclass(frozen=True, slots=True, eq=False)
class Group:
    """Points that share a mistake, if there is one."""

    name: str  #: for sentences
    file: str
    index: np.ndarray  #: (m,) rows of the points
    whole: bool  #: all points of a sweep, not those of one condition

    @property
    def shown(self) -> np.ndarray:
        """Rows at which the group is judged."""
        return self.index[:: -(-len(self.index) // SHOWN)]


@dataclass(frozen=True, slots=True)
class Leverage:
    """A fit at its solution, for every point; arrays of Fy and then Mz, 0 or inf where a channel is not used."""

    residual: np.ndarray  #: (2n,) model less measured [N], [Nm]
    slope: np.ndarray  #: (2n, k) derivative by the free numbers
    weight: np.ndarray  #: (2n,) uncertainty that the fit used [N], [Nm]; inf: not used
    noise: (
        np.ndarray
    )  #: (2n,) uncertainty of a sound point, the model's own misfit included; inf: not measured
    root: np.ndarray  #: (k, k) of the covariance, which is root @ root.T


@dataclass(frozen=True, slots=True)
class Prediction:
    """One channel of a group as the others predict it."""

    error: np.ndarray  #: (m,) prediction less measured [N] or [Nm]
    covariance: np.ndarray  #: (m, m) of a sound sweep's error: its noise and the prediction's


def groups(points: Points) -> list[Group]:
    """Every sweep, and where one holds several loads, pressures, directions or cambers each of these by itself."""
    found = [*_sweeps(points), *_conditions(points)]
    unique = {tuple(group.index): group for group in reversed(found)}
    return [g for g in reversed(unique.values()) if FEWEST <= len(g.index) <= MOST * len(points)]


def _sweeps(points: Points) -> Iterator[Group]:
    for k in np.unique(points.sweep):
        index = np.flatnonzero(points.sweep == k)
        yield Group(points.sweep_names[k], points.files[points.file[index[0]]], index, True)


def _conditions(points: Points) -> Iterator[Group]:
    load = levels.nearest_labels(points.Fz, levels.LOAD)
    pressure = levels.nearest_labels(points.p, levels.PRESSURE)
    camber = levels.nearest_labels(points.gamma, levels.CAMBER)
    for sweep in _sweeps(points):
        i = sweep.index
        own = levels.count(points.gamma[i], levels.CAMBER)
        keys = np.column_stack([load[i], pressure[i], points.direction[i], points.mount[i]])
        # A sweep of camber is not a condition per angle.
        if own * FEWEST <= len(i) and not levels.spread(points.gamma[i], levels.CAMBER):
            keys = np.column_stack([keys, camber[i]])
        for key in np.unique(keys, axis=0):
            rows = i[np.all(keys == key, axis=1)]
            if len(rows) < len(i):
                part = points.select(rows)
                said = f"{np.mean(part.Fz):.0f} N, {np.mean(part.p) / 1e3:.0f} kPa"
                if keys.shape[1] > 4:
                    said += f", camber {np.degrees(np.mean(part.gamma)):z.0f} deg"
                yield Group(f"{sweep.name} at {said}", sweep.file, rows, False)


def leverage(problem: FitProblem, numbers: Sequence[Number], noise: np.ndarray) -> Leverage:
    """Residuals and derivatives of a fit at its solution.

    Parameters
    ----------
    problem : at the solution, with the weights that the fit used
    numbers : that were free, (k,), with their priors
    noise : uncertainty of a sound point [N], [Nm], (2n,) of Fy and then Mz; inf where not measured
    """
    points = problem.points
    free = [n.name for n in numbers]
    common = [name for name in COMMON if name not in free]
    out, slope = problem.simulation.sensitivities(points, [*free, *common])
    slopes = np.concatenate(slope)
    measured = np.concatenate([points.Fy, points.Mz])
    used = np.isfinite(measured) & np.isfinite(noise)
    weight = np.where(used, np.concatenate(list(problem.sigma.values())), np.inf)
    residual = np.where(used, np.concatenate(out) - np.nan_to_num(measured), 0.0)
    J = slopes / weight[:, None]
    covariance = inverse(J.T @ J + np.diag([n.spread**-2.0 for n in numbers] + [0.0] * len(common)))
    push = J.T @ (residual / weight)
    push[: len(free)] = 0.0  # the fit has ended: it is balanced in its own numbers
    return Leverage(
        residual=np.where(used, residual - slopes @ (covariance @ push), 0.0),
        slope=slopes,
        weight=weight,
        noise=np.where(used, noise, np.inf),
        root=root(covariance),
    )


def predictions(fit: Leverage, group: Group) -> dict[str, Prediction]:
    """The channels of a group, where it is shown (m,), as all other points predict them; one not measured is left out."""
    n = len(fit.residual) // 2
    rows = _measured(fit, group.index, n)
    J = fit.slope[rows] / fit.weight[rows][:, None]
    share, axes = np.linalg.eigh(
        (J @ fit.root).T @ (J @ fit.root)
    )  # of the information that comes from the group
    turned = fit.root @ axes
    others = (turned / np.maximum(1.0 - share, UNKNOWN)) @ turned.T
    moved = others @ (J.T @ (fit.residual[rows] / fit.weight[rows]))
    rows = _measured(fit, group.shown, n)
    slope = fit.slope[rows]
    error = fit.residual[rows] + slope @ moved
    spread = slope @ others @ slope.T + np.diag(fit.noise[rows] ** 2)
    out = {}
    for k, name in enumerate(CHANNELS):
        own = rows >= n if k else rows < n
        if np.any(own):
            out[name] = Prediction(error[own], spread[np.ix_(own, own)])
    return out


def _measured(fit: Leverage, index: np.ndarray, n: int) -> np.ndarray:
    """Rows of the fit's arrays for both channels of some points, where they were measured."""
    rows = np.concatenate([index, n + index])
    return rows[np.isfinite(fit.noise[rows])]
