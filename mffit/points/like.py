"""Points under like conditions: curves, and mean side forces, by which sweeps and files are compared."""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from mffit.constants import STRAIGHT
from mffit.points import levels
from mffit.points.noise import neighbour_noise, stating
from mffit.points.points import Points
from mffit.scatter import rms

HELD = ("Fz", "p")
"""Settings that no curve goes over."""
VARIED = ("alpha", "gamma", "kappa")
"""Quantities of which a curve goes over one."""


class MeanReading(NamedTuple):
    """Mean of some side forces of the freely rolling wheel at one condition and step of sideslip."""

    Fy: float  #: [N]
    Fz: float  #: [N]
    alpha: float  #: [rad]
    slope: float  #: dFy/dalpha [N/rad]; 0 if the readings do not show it
    u: float  #: standard error of Fy [N]; NaN if nothing shows the noise


MeanReadings = Mapping[tuple[int, ...], MeanReading]
"""By condition, whose last number is the step of sideslip."""


def rolling(points: Points) -> Points:
    """The loaded points that roll freely and have a side force."""
    return points.select(points.free_rolling & np.isfinite(points.Fy) & (points.Fz > 0.0), with_table=False)


def noise(points: Points) -> np.ndarray:
    """Standard uncertainty (n,) of Fy: as stated, else from neighbouring readings."""
    return np.where(stating(points.u_Fy), points.u_Fy, neighbour_noise(points, points.Fy))


def conditions(points: Points, settings: Sequence[str]) -> np.ndarray:
    """Condition (n, k) of each point: labels of settings, direction, mount and path, and the step of sideslip."""
    return np.column_stack([_held(points, settings), np.round(points.alpha / STRAIGHT.rad).astype(int)])


def _held(points: Points, settings: Sequence[str]) -> np.ndarray:
    """Labels (n, k) of settings, direction, mount and path."""
    labels = [levels.labels_of_setting(points, name) for name in settings]
    path = np.unique(points.phi_t, return_inverse=True)[1]
    return np.column_stack([*labels, points.direction, points.mount, path])


def series(points: Points, *, signed: bool) -> Iterator[tuple[str, np.ndarray]]:
    """What every curve goes over, and its rows (m,): points of one sweep, or of a whole file, that differ in one quantity only.

    It is that of sideslip, camber and longitudinal slip with the most levels at a load, pressure and path; the others are held.
    A curve and its mirror image are one, unless they are ``signed``.
    """
    for rows in levels.rows_of_equal(np.column_stack([points.sweep, _held(points, HELD)])):
        values = {name: getattr(points, name)[rows] for name in VARIED}
        found = {
            name: levels.nearest_labels(x if signed else np.abs(x), levels.KINDS[name])
            for name, x in values.items()
        }
        over = max(found, key=lambda name: len(np.unique(found[name])))
        held = np.column_stack([own for name, own in found.items() if name != over])
        yield from ((over, rows[own]) for own in levels.rows_of_equal(held))


def curves(points: Points) -> np.ndarray:
    """Index (n,) of the curve of each point, as in :func:`series`; a curve and its mirror image are one."""
    out = np.zeros(len(points), dtype=int)
    for k, (_, rows) in enumerate(series(points, signed=False)):
        out[rows] = k
    return out


def mean_readings(points: Points, rows: np.ndarray, keys: np.ndarray, u: np.ndarray) -> MeanReadings:
    """The mean readings of some ``rows`` (m,) by condition; ``keys`` (n, k) are conditions, ``u`` (n,) uncertainties of Fy."""
    out: dict[tuple[int, ...], MeanReading] = {}
    readings = np.stack([points.Fy, points.Fz, points.alpha])
    for group in levels.rows_of_equal(keys[rows]):
        own = rows[group]
        Fy, Fz, alpha = np.mean(readings[:, own], axis=1).tolist()
        error = float(rms(u[own])) / np.sqrt(len(own))
        out[tuple(keys[own[0]].tolist())] = MeanReading(Fy, Fz, alpha, 0.0, error)
    for key, one in out.items():
        beside = [out[near] for by in (-1, 1) if (near := (*key[:-1], key[-1] + by)) in out]
        if beside:
            low, high = min((one, *beside), key=lambda r: r.alpha), max((one, *beside), key=lambda r: r.alpha)
            out[key] = one._replace(slope=(high.Fy - low.Fy) / (high.alpha - low.alpha))
    return out
