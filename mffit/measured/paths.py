"""The turn-slip stiffness of a load from the zeros of every path that was run: one, both sides of the disc, two radii."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc
from uncertainties import UFloat

from mffit.measured.camber_reduction import RigErrors, monte_carlo, named
from mffit.measured.groups import LoadGroup
from mffit.measured.loads import covariance
from mffit.points import Points

RIDGE = 1e-9
"""Share of the variances that keeps the weights defined where paths have nothing but shared errors."""


class PathForce(NamedTuple):
    """What the zeros of one path say."""

    sign: float  #: of phi_t
    R: UFloat  #: path radius [m]
    force: UFloat  #: turn-slip force, corrected (23) [N]
    readings: tuple[UFloat, ...]  #: raw force forwards [N], and backwards where that was run
    alpha_M: UFloat | None  #: sideslip misalignment [rad]; None without backward runs


FINITE_SPIN = 0.05
"""Standard uncertainty of the share by which C_phit falls per square of the turn slip [m^2]; sample tyres have 0.03."""
UNLIKELY = 1e-3
"""Chance below which paths are said to contradict each other."""


class Stiffness(NamedTuple):
    """The turn-slip stiffness and how much each path counts in it."""

    C_phit: UFloat  #: [Nm]
    weights: np.ndarray  #: (k,), sum 1
    of_paths: tuple[UFloat, ...]  #: what each path says alone [Nm]
    chance: float  #: that paths that measure the same differ by so much; 1 for one path

    @property
    def contradictory(self) -> bool:
        """Whether the paths say different things, beyond what is known to be uncertain."""
        return self.chance < UNLIKELY


def by_path(points: Points, group: LoadGroup, usual: float) -> list[tuple[float, LoadGroup]]:
    """The points of a load by turn slip phi_t [1/m] of their path, those of the ``usual`` path first."""
    phi_t = points.phi_t[group.index]
    found = sorted(np.unique(phi_t), key=lambda path: abs(path - usual))
    return [(float(path), LoadGroup(group.load, group.index[phi_t == path])) for path in found]


def on_radius(points: Points, index: np.ndarray, radius: float) -> np.ndarray:
    """Those of the points (m,) that ran at the usual path radius [m], on either side of the disc; all if none did."""
    usual = index[np.isclose(np.abs(points.phi_t[index]), 1.0 / radius, rtol=1e-6)]
    return usual if len(usual) else index


def stiffness(paths: Sequence[PathForce]) -> Stiffness:
    """C_phit = F/phi_t (21) of every path, in the combination that has the least uncertainty.

    The rig's errors are shared: what pushes the same way on both sides of the disc, or on two radii, drops out.
    """
    single = [path.sign * path.force * path.R for path in paths]
    if len(single) == 1:
        return Stiffness(single[0], np.ones(1), tuple(single), 1.0)
    errors = covariance(single)
    errors += RIDGE * np.diag(np.diag(errors))
    weights = _weights(errors)
    together = sum(w * C for w, C in zip(weights.tolist(), single, strict=True))
    return Stiffness(together, weights, tuple(single), _chance(paths, single, errors))


def _weights(errors: np.ndarray) -> np.ndarray:
    """Shares (k,) of numbers in their mean of least uncertainty, by their covariance (k, k)."""
    weights = np.linalg.solve(errors, np.ones(len(errors)))
    return weights / weights.sum()


def _chance(paths: Sequence[PathForce], single: Sequence[UFloat], errors: np.ndarray) -> float:
    said = np.array([C.nominal_value for C in single])
    spin = np.array([1.0 / path.R.nominal_value**2 for path in paths])
    of_spin = FINITE_SPIN * np.mean(said) * (spin - spin[0])
    errors = errors + np.outer(of_spin, of_spin)
    off = said - _weights(errors) @ said
    return float(chdtrc(len(single) - 1, off @ np.linalg.solve(errors, off)))


def u_by_draws(
    paths: Sequence[PathForce], weights: np.ndarray, C_gamma: UFloat, r_e: UFloat, rig: RigErrors
) -> float:
    """u(eps_gamma) by random draws of all independent sources."""
    # R cancels where r_e comes from a revolution on the same path
    ratio = r_e / rig.R
    of_first = named(ratio.nominal_value, ratio.std_dev, "r_e/R", "-")
    relative = [rig.R.nominal_value / path.R.nominal_value for path in paths]
    readings = [reading for path in paths for reading in path.readings]

    def formula(*x):
        forces = list(x[: len(readings)])
        C, offset, gamma_0, slip, r = x[len(readings) :]
        total = 0.0
        for path, weight, R in zip(paths, weights, relative, strict=True):
            known = len(path.readings) > 1
            force = sum(forces.pop(0) for _ in path.readings) / len(path.readings)
            force = force - offset - C * gamma_0 - (0.0 if known else slip)
            total = total + weight * path.sign * force / R
        return 1.0 + r * C / total

    return monte_carlo(formula, [*readings, C_gamma, rig.offset, rig.gamma_0, rig.slip_force, of_first])
