"""Misfit over the stated noise, and noise estimated from neighbouring readings."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from mffit.points import constants
from mffit.points.points import Points
from mffit.scatter import bends, rms, robust


class OverNoise(NamedTuple):
    """A misfit in units of the noise."""

    ratio: float  #: root mean square of (model - reading) / u; NaN if no reading states u
    n: int  #: number of readings that state u
    of_noise: float = np.inf  #: effective number of readings behind the noise; infinite if it is stated


def over_noise(
    model: np.ndarray, measured: np.ndarray, u: np.ndarray, used: np.ndarray | None = None
) -> OverNoise:
    """The misfit over noise of the readings with an uncertainty (n,), restricted to the mask ``used`` (n,) if given."""
    known = stating(u) & np.isfinite(measured) & np.isfinite(model)
    known = known if used is None else known & used
    return OverNoise(rms((model - measured)[known] / u[known]), int(known.sum()))


def stating(u: np.ndarray) -> np.ndarray:
    """Mask (n,) of the readings that state their uncertainty."""
    return np.asarray(np.isfinite(u) & (u > 0.0))


def estimated_noise(points: Points, model: Mapping[str, np.ndarray]) -> dict[str, float]:
    """By channel, the noise of the readings without a stated one, from residuals of neighbours; NaN if sweeps are too short."""
    found = {}
    for name, values in model.items():
        silent = ~stating(points.u(name))
        found[name] = neighbour_noise(points, np.where(silent, points.channel(name) - values, np.nan))
    return found


def neighbour_noise(points: Points, values: np.ndarray) -> float:
    """Robust noise of values (n,) from third differences along each sweep, in which a smooth curve nearly vanishes.

    NaN if all sweeps are too short.
    """
    sweeps = [own[np.isfinite(own)] for own in (values[rows] for rows in points.rows_of_sweeps.values())]
    differences = [bends(x, 3) for x in sweeps if len(x) >= constants.FEWEST_POINTS]
    return robust(np.concatenate(differences)) if differences else float("nan")
