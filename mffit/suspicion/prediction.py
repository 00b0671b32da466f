"""Prediction of each sweep from all others, computed from the one fit to all of them (see :mod:`mffit.left_out`)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from mffit.least_squares import FreeNumber, condensed, inverse, root
from mffit.left_out import covariance_without
from mffit.points import Points, levels
from mffit.rig import Simulation, blocks
from mffit.rig_errors import BY_NAME, RIG_ERRORS, ZEROS, number_of
from mffit.suspicion import constants

COMMON = tuple(
    error.name
    for error in RIG_ERRORS
    if error.kind != "tyre" and error.name not in ("backlash_deg", "path_radius_m")
)
"""Rig errors that all sweeps share: they contradict no single sweep and are free, to first order."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FittedModel:
    """A fit at its solution."""

    points: Points  #: (n,)
    simulation: Simulation
    weights: Mapping[str, np.ndarray]  #: by channel, uncertainty that the fit used (n,) [N], [Nm]
    numbers: Sequence[FreeNumber]  #: that were free, (k,), with their priors
    names: tuple[str, ...]  #: of all uncertain numbers, (j,)
    covariance: np.ndarray  #: (j, j)
    scale: Mapping[str, float]  #: by channel, robust misfit over stated uncertainty


@dataclass(frozen=True, slots=True, eq=False)
class Group:
    """Points that share a mistake, if there is one."""

    name: str  #: for sentences
    file: str
    index: np.ndarray  #: (m,) rows of the points
    whole: bool  #: all points of a sweep rather than those of one condition

    @property
    def every(self) -> slice:
        """Those of the group's points at which it is predicted."""
        return slice(None, None, -(-len(self.index) // constants.MOST_POINTS_SHOWN))

    @property
    def shown(self) -> np.ndarray:
        """Rows at which the group is predicted."""
        return self.index[self.every]


@dataclass(frozen=True, slots=True)
class Leverage:
    """A fit at its solution; arrays of c channels one after the other."""

    channels: tuple[str, ...]  #: (c,)
    at: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
    """Rows (m,) of a sweep -> model less measured (c m,) [N], [Nm], 0 where not used, and its derivatives (c m, k) by
    combinations of the free numbers whose covariance is 1."""
    weight: np.ndarray  #: (c n,) uncertainty that the fit used [N], [Nm]; inf: not used
    noise: np.ndarray  #: (c n,) uncertainty of a sound point, model misfit included; inf: not measured


@dataclass(frozen=True, slots=True)
class PredictedChannel:
    """One channel of a group as the other sweeps predict it."""

    error: np.ndarray  #: (m,) prediction less measured [N] or [Nm]
    covariance: np.ndarray  #: (m, m) of a sound sweep's error: its noise and the prediction's


def groups(points: Points) -> list[Group]:
    """Every sweep, and every load, pressure, direction and camber of a sweep that holds several."""
    found = [*_sweeps(points), *_conditions(points)]
    unique = {group.index.tobytes(): group for group in reversed(found)}
    fewest, most = constants.FEWEST_POINTS_OF_A_SWEEP, constants.LARGEST_SWEEP * len(points)
    return [g for g in reversed(unique.values()) if fewest <= len(g.index) <= most]


def _sweeps(points: Points) -> Iterator[Group]:
    for k in np.unique(points.sweep):
        index = np.flatnonzero(points.sweep == k)
        file = points.files[points.file[index[0]]]
        yield Group(name=points.sweep_names[k], file=file, index=index, whole=True)


def parts_of_sweeps(points: Points) -> np.ndarray:
    """Number (n,) of each point's part, from 0: a sweep, or each load, pressure, direction and camber of one with several."""
    out = np.empty(len(points), dtype=int)
    for k, (_, rows, _) in enumerate(_parts(points)):
        out[rows] = k
    return out


def _conditions(points: Points) -> Iterator[Group]:
    for sweep, rows, by_camber in _parts(points):
        if len(rows) < len(sweep.index):
            part = points.select(rows)
            said = f"{np.mean(part.Fz):.0f} N, {np.mean(part.p) / 1e3:.0f} kPa"
            if by_camber:
                said += f", camber {np.degrees(np.mean(part.gamma)):z.0f} deg"
            yield Group(name=f"{sweep.name} at {said}", file=sweep.file, index=rows, whole=False)


def _parts(points: Points) -> Iterator[tuple[Group, np.ndarray, bool]]:
    """Each sweep with the rows (m,) of one of its conditions, and whether camber is one of the conditions."""
    load = levels.labels_of_sweeps(points.Fz, points.sweep, levels.LOAD)
    pressure = levels.nearest_labels(points.p, levels.PRESSURE)
    camber = levels.nearest_labels(points.gamma, levels.CAMBER)
    for sweep in _sweeps(points):
        i = sweep.index
        own = levels.count(points.gamma[i], levels.CAMBER)
        keys = np.column_stack([load[i], pressure[i], points.direction[i], points.mount[i]])
        # In a sweep of camber the angles are not conditions.
        few = own * constants.FEWEST_POINTS_OF_A_SWEEP <= len(i)
        by_camber = few and not levels.spread(points.gamma[i], levels.CAMBER)
        if by_camber:
            keys = np.column_stack([keys, camber[i]])
        for rows in levels.rows_of_equal(keys):
            yield sweep, i[rows], by_camber


def leverage(fit: FittedModel, noise: np.ndarray) -> Leverage:
    """Residuals and derivatives of a fit.

    ``noise`` is that of a sound point [N], [Nm], (c n,), channel after channel; inf where not measured.
    """
    points = fit.points
    free = [n.name for n in fit.numbers]
    channels = tuple(fit.weights)
    common = [name for name in _common(points, channels) if name not in free]
    measured = np.concatenate([points.channel(name) for name in channels])
    used = np.isfinite(measured) & np.isfinite(noise)
    weight = np.where(used, np.concatenate(list(fit.weights.values())), np.inf)
    at_rows = fit.simulation.at_rows(points, [*free, *common], channels)

    divided = list(blocks(points, by_sweep=True))

    @lru_cache(maxsize=1)
    def read(k: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Residuals (c m,), derivatives (c m, k) and rows of the stacked arrays (c m,) of a block."""
        out, slope = at_rows(divided[k])
        i = _stacked(divided[k], len(channels), len(points))
        return np.where(used[i], out.stacked - np.nan_to_num(measured[i]), 0.0), slope.stacked, i

    every = map(read, range(len(divided)))
    weighted = ((residual / weight[i], slope / weight[i][:, None]) for residual, slope, i in every)
    r, J = condensed(weighted)
    covariance = inverse(J.T @ J + np.diag([n.spread**-2.0 for n in fit.numbers] + [0.0] * len(common)))
    gradient = J.T @ r
    gradient[: len(free)] = 0.0  # the fit has converged in its own numbers
    step, combined = covariance @ gradient, root(covariance)
    block, place = np.empty(len(points), dtype=int), np.empty(len(points), dtype=int)
    for k, rows in enumerate(divided):
        block[rows], place[rows] = k, np.arange(len(rows))

    def at(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        k = int(block[rows[0]])
        own = _stacked(place[rows], len(channels), len(divided[k]))
        residual, slope, i = (x[own] for x in read(k))
        return np.where(used[i], residual - slope @ step, 0.0), slope @ combined

    return Leverage(
        channels=channels,
        at=at,
        weight=weight,
        noise=np.where(used, noise, np.inf),
    )


def _stacked(rows: np.ndarray, channels: int, n: int) -> np.ndarray:
    """Rows (c m,) of arrays of channels (c n,) that belong to some points (m,)."""
    return (np.arange(channels)[:, None] * n + rows).ravel()


def _common(points: Points, channels: Iterable[str]) -> list[str]:
    """Names of the rig errors that many sweeps share: those of the rig, and the zeros of every set-up."""
    setups = points.used_setups
    common = [name for name in COMMON if BY_NAME[name].shows_in(channels)]
    if len(setups) < 2:
        return common
    zeros = [error.name for error in ZEROS if error.shows_in(channels)]
    rig = [name for name in common if name not in zeros]
    return [*rig, *(number_of(name, setup) for name in zeros for setup in setups)]


def predictions(fit: Leverage, group: Group) -> dict[str, PredictedChannel]:
    """The measured channels of a group at the rows that it shows (m,), as all other points predict them."""
    count, m = len(fit.channels), len(group.index)
    rows = _stacked(group.index, count, len(fit.noise) // count)
    residual, slope = fit.at(group.index)
    measured = np.isfinite(fit.noise[rows])
    weight = fit.weight[rows]
    axes = (slope / weight[:, None])[measured]
    others = covariance_without(axes, constants.INFORMATION_OF_OTHERS)
    moved = others @ (axes.T @ (residual / weight)[measured])
    shown = _stacked(np.arange(m)[group.every], count, m)
    shown = shown[measured[shown]]
    slope = slope[shown]
    error = residual[shown] + slope @ moved
    spread = slope @ others @ slope.T + np.diag(fit.noise[rows[shown]] ** 2)
    out = {}
    for k, name in enumerate(fit.channels):
        own = shown // m == k
        if np.any(own):
            out[name] = PredictedChannel(error=error[own], covariance=spread[np.ix_(own, own)])
    return out
