"""The sideslip zero of a set-up: alpha_M, the sum of misalignment and ply-steer, from the zeros both ways at all its loads.

The axis is off by one angle at every load of a set-up. Ply-steer belongs to the tyre and may change with load.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc
from uncertainties import UFloat

from mffit.measured.camber_reduction import known_quantity
from mffit.measured.loads import covariance
from mffit.measured.ply_steer import usual_ply_steer
from mffit.measured.result import SideslipReading, SideslipZeros
from mffit.measured.sources import named


class ZeroAngle(NamedTuple):
    """alpha_M as the zeros both ways of one set-up, load and path give it."""

    setup: str
    load: float  #: [N]
    phi_t: float  #: turn slip of the path [1/m]
    angle: UFloat  #: [rad]

    @property
    def said(self) -> SideslipReading:
        """The same as the record that leaves this folder."""
        return SideslipReading(self.load, self.phi_t, known_quantity(self.angle, "rad"))


class SetupAngle(NamedTuple):
    """alpha_M of a set-up over load."""

    nominal_load: float  #: [N]
    angle: UFloat  #: at the nominal load [rad]
    over_load: UFloat  #: its change per nominal load, by ply-steer [rad]

    def at(self, load: float) -> UFloat:
        """alpha_M at a load [rad]."""
        return self.angle + (load / self.nominal_load - 1.0) * self.over_load


def angles_of_setups(
    readings: Sequence[ZeroAngle], nominal_load: float
) -> tuple[dict[str, SetupAngle], tuple[SideslipZeros, ...]]:
    """alpha_M of every set-up that was run both ways, and how well its readings agree.

    Least squares over the loads of a set-up. What ply-steer may change over one nominal load is one more reading: zero, as
    uncertain as ply-steer itself.
    """
    # One tyre: its change over load is common to the set-ups.
    expected = named(0.0, usual_ply_steer(), "ply-steer over load", "rad")
    found, agreements = {}, []
    for setup in dict.fromkeys(reading.setup for reading in readings):
        own = [reading for reading in readings if reading.setup == setup]
        off = np.array([reading.load / nominal_load - 1.0 for reading in own])
        y = [*(reading.angle for reading in own), expected]
        A = np.vstack([np.column_stack([np.ones(len(own)), off]), [0.0, 1.0]])
        errors = covariance(y)
        weight = np.linalg.inv(errors)
        estimator = np.linalg.solve(A.T @ weight @ A, A.T @ weight)
        angle, over_load = (sum(w * x for w, x in zip(row.tolist(), y, strict=True)) for row in estimator)
        found[setup] = SetupAngle(nominal_load, angle, over_load)
        if len(own) > 1:
            left = np.array([x.nominal_value for x in y])
            left = left - A @ (estimator @ left)
            chance = float(chdtrc(len(own) - 1, left @ weight @ left))
            agreements.append(SideslipZeros(setup, chance, *_farthest_apart(own, off, errors)))
    return found, tuple(agreements)


def _farthest_apart(
    own: Sequence[ZeroAngle], off: np.ndarray, errors: np.ndarray
) -> tuple[SideslipReading, SideslipReading]:
    """The two readings whose difference is largest over its uncertainty, that of ply-steer over load included."""
    n = len(own)
    whole = errors[:n, :n] + errors[n, n] * np.outer(off, off)

    def apart(pair: tuple[int, int]) -> float:
        i, j = pair
        square = whole[i, i] + whole[j, j] - 2.0 * whole[i, j]
        return float((own[i].angle.nominal_value - own[j].angle.nominal_value) ** 2 / square)

    i, j = max(combinations(range(n), 2), key=apart)
    return own[i].said, own[j].said
