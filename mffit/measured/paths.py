"""The turn-slip stiffness of a load from the zeros of every path that was run: one, both sides of the disc, two radii."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc
from uncertainties import UFloat

from mffit.measured import constants
from mffit.measured.groups import LoadGroup
from mffit.measured.loads import covariance
from mffit.points import Points
from mffit.rig_errors import AtZero


class PathForce(NamedTuple):
    """The turn-slip force of one path in one set-up."""

    sign: float  #: of phi_t
    R: UFloat  #: path radius [m]
    at: AtZero  #: stiffnesses of the tyre and side of the play there
    readings: tuple[UFloat, ...]  #: raw force forwards [N], and backwards if that was run
    force: UFloat  #: corrected (23) [N]
    setup: str = ""  #: name of the set-up of the rig in which it was measured
    scatter: UFloat | None = (
        None  #: force of the set-up that repeated set-ups show beyond what is declared [N]
    )


class TurnSlipStiffness(NamedTuple):
    """The turn-slip stiffness and the weight of each path in it."""

    C_phit: UFloat  #: [Nm]
    weights: np.ndarray  #: (k,), sum 1
    of_paths: tuple[UFloat, ...]  #: by each path alone [Nm]
    chance: float  #: probability that paths of one stiffness differ by so much; 1 for one path

    @property
    def contradictory(self) -> bool:
        """Whether the paths differ beyond all known uncertainty."""
        return self.chance < constants.CONTRADICTION_CHANCE


class PathPoints(NamedTuple):
    """The points of one load on one path in one set-up."""

    phi_t: float  #: turn slip of the path [1/m]
    setup: str  #: name of the set-up
    group: LoadGroup


def by_path(points: Points, group: LoadGroup, usual: float) -> list[PathPoints]:
    """The points of a load by path and set-up, those on the path with the ``usual`` turn slip [1/m] first."""
    phi_t, setup = points.phi_t[group.index], points.setup[group.index]
    found = sorted({*zip(phi_t.tolist(), setup.tolist(), strict=True)}, key=lambda x: (abs(x[0] - usual), x))
    return [
        PathPoints(path, points.setups[k], LoadGroup(group.load, group.index[(phi_t == path) & (setup == k)]))
        for path, k in found
    ]


def on_radius(points: Points, index: np.ndarray, radius: float) -> np.ndarray:
    """Indices of the points at the usual path radius [m], on either side of the disc; all if there are none."""
    usual = index[np.isclose(np.abs(points.phi_t[index]), 1.0 / radius, rtol=1e-6)]
    return usual if len(usual) else index


def turn_slip_stiffness(paths: Sequence[PathForce]) -> TurnSlipStiffness:
    """C_phit = F/phi_t (21), the paths weighted for the least uncertainty.

    The zeros are common to the paths of one set-up: a force of the same sign on both sides of the disc, or on two radii,
    cancels there. Between set-ups they are independent.
    """
    single = [path.sign * path.force * path.R for path in paths]
    if len(single) == 1:
        return TurnSlipStiffness(single[0], np.ones(1), tuple(single), 1.0)
    errors = covariance(single)
    weights = _weights(errors)
    together = sum(w * C for w, C in zip(weights.tolist(), single, strict=True))
    return TurnSlipStiffness(together, weights, tuple(single), _chance(paths, single, errors))


def least_uncertain_mean(numbers: Sequence[UFloat]) -> UFloat:
    """The mean of several estimates of one number, weighted by their covariance for the least uncertainty."""
    weights = _weights(covariance(numbers))
    return sum(w * x for w, x in zip(weights.tolist(), numbers, strict=True))


def _weights(errors: np.ndarray) -> np.ndarray:
    """Weights (k,) of the mean with the least uncertainty, from the covariance (k, k) of its terms."""
    # The ridge keeps the weights defined if all errors are shared.
    weights = np.linalg.solve(errors + 1e-9 * np.diag(np.diag(errors)), np.ones(len(errors)))
    return weights / weights.sum()


def _chance(paths: Sequence[PathForce], single: Sequence[UFloat], errors: np.ndarray) -> float:
    said = np.array([C.nominal_value for C in single])
    spin = np.array([1.0 / path.R.nominal_value**2 for path in paths])
    of_spin = constants.FINITE_SPIN_SHARE * np.mean(said) * (spin - spin[0])
    errors = errors + np.outer(of_spin, of_spin)
    off = said - _weights(errors) @ said
    return float(chdtrc(len(single) - 1, off @ np.linalg.solve(errors, off)))
