"""The zero of a set-up's sideslip axis: alpha_M, the sum of misalignment and ply-steer, and its split into the two.

alpha_M is determined from forward and backward zeros at all loads of a set-up. The misalignment is one angle per set-up;
ply-steer is a property of the tyre and may change with load.
"""

import math
from collections.abc import Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np
from uncertainties import UFloat

from mffit.constants import COVERAGE_FACTOR_95, USUAL_CORNERING_STIFFNESS
from mffit.measured import constants
from mffit.measured.result import SideslipReading, SideslipZeros, usual_ply_steer
from mffit.measured.uncertain import combined, covariance, named, quantity


class SlipStiffness(NamedTuple):
    """Slope and bend of the side force over sideslip at zero reading; without a measurement the slope is the usual one."""

    C_alpha: UFloat  #: [N/rad]
    bend: UFloat | None  #: change of the slope with sideslip, on the usual side of the disc [N/rad^2]

    def at(self, angle: UFloat) -> UFloat:
        """Slope at true zero [N/rad] if the axis is misaligned by ``angle`` [rad]."""
        return self.C_alpha if self.bend is None else self.C_alpha - self.bend * angle

    def force(self, angle: UFloat, side: float) -> UFloat:
        """Side force [N] that an angle [rad] adds to a forward zero; ``side`` is 1 on the usual side of the disc, else -1."""
        linear = self.at(angle) * angle
        return linear if self.bend is None else linear + 0.5 * side * self.bend * angle**2


def slip_stiffness(C_alpha: UFloat | None, bend: UFloat | None, load: float) -> SlipStiffness:
    """The measured slope and bend, else the usual slope at a load [N] without a bend."""
    if C_alpha is not None:
        return SlipStiffness(C_alpha, bend)
    return SlipStiffness(usual_stiffness(load), None)


def slope_at(C_alpha: UFloat | None, load: float) -> float:
    """The measured cornering stiffness [N/rad], else the usual one at a load [N]."""
    return float((usual_stiffness(load) if C_alpha is None else C_alpha).nominal_value)


def usual_stiffness(load: float) -> UFloat:
    """The usual cornering stiffness [N/rad] at a load [N], for one that was not measured."""
    size = USUAL_CORNERING_STIFFNESS * load
    return named(-size, constants.GUESSED_STIFFNESS_U * size, "usual cornering stiffness", "N/rad")


class ZeroAngle(NamedTuple):
    """alpha_M from the forward and backward zeros of one set-up, load and path."""

    setup: str
    load: float  #: [N]
    phi_t: float  #: turn slip of the path [1/m]
    angle: UFloat  #: [rad]


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
    """alpha_M of every set-up that was run both ways, and the consistency of its readings.

    Generalised least squares over the loads of a set-up. The prior of ply-steer's change per nominal load enters as one more
    reading: zero, as uncertain as ply-steer itself.
    """
    # All set-ups test one tyre, so its change over load is common to them.
    expected = named(0.0, usual_ply_steer(), "ply-steer over load", "rad")
    found, agreements = {}, []
    for setup in dict.fromkeys(reading.setup for reading in readings):
        own = [reading for reading in readings if reading.setup == setup]
        off = np.array([reading.load / nominal_load - 1.0 for reading in own])
        y = [*(reading.angle for reading in own), expected]
        law = combined(y, np.vstack([np.column_stack([np.ones(len(own)), off]), [0.0, 1.0]]))
        found[setup] = SetupAngle(nominal_load, *law.numbers)
        if len(own) > 1:
            agreements.append(SideslipZeros(setup, law.chance, *_farthest_apart(own, off, covariance(y))))
    return found, tuple(agreements)


def _farthest_apart(
    own: Sequence[ZeroAngle], off: np.ndarray, errors: np.ndarray
) -> tuple[SideslipReading, SideslipReading]:
    """The two readings with the largest difference over its uncertainty, ply-steer over load included."""
    n = len(own)
    whole = errors[:n, :n] + errors[n, n] * np.outer(off, off)

    def apart(pair: tuple[int, int]) -> float:
        i, j = pair
        square = whole[i, i] + whole[j, j] - 2.0 * whole[i, j]
        return float((own[i].angle.nominal_value - own[j].angle.nominal_value) ** 2 / square)

    i, j = max(combinations(range(n), 2), key=apart)
    one, other = (SideslipReading(own[k].load, own[k].phi_t, quantity(own[k].angle, "rad")) for k in (i, j))
    return one, other


class ZeroSplit(NamedTuple):
    """alpha_M split into its two parts [rad], with the uncertainty of the split."""

    misalignment: UFloat
    ply_steer: UFloat


def split_of_zero(alpha_M: UFloat | None, C_alpha: float, u_force: float) -> ZeroSplit | None:
    """Misalignment and ply-steer [rad], from their sum alpha_M and their priors; None without both directions in the set-up.

    ``C_alpha`` is the cornering stiffness [N/rad], ``u_force`` the uncertainty of the alignment as the side force that it
    causes [N]. The sum is divided in proportion to the prior variances. If it is far beyond both priors, it contradicts the
    declared alignment, because no tyre has so much ply-steer: the prior variance of the misalignment is then enlarged to
    explain it.
    """
    if alpha_M is None:
        return None
    axis, tyre = u_force / abs(C_alpha), usual_ply_steer()
    size = abs(alpha_M.nominal_value)
    if size > COVERAGE_FACTOR_95 * math.hypot(axis, tyre):
        axis = math.sqrt(size**2 - tyre**2)
    both = math.hypot(axis, tyre)
    share = (axis / both) ** 2
    exchanged = named(0.0, axis * tyre / both, "split of misalignment and ply-steer", "rad")
    return ZeroSplit(share * alpha_M + exchanged, (1.0 - share) * alpha_M - exchanged)


def at_true_zero(
    C_alpha: UFloat | None, bend: UFloat | None, split: ZeroSplit | None, u_force: float
) -> UFloat | None:
    """Cornering stiffness at true zero sideslip [N/rad], from the slope at zero reading and its change with sideslip [N/rad^2].

    On a disc the curve is shifted by about a degree, so its slope changes even at zero. ``split`` is the misalignment if both
    directions were run; without it, ``u_force`` counts, the alignment's uncertainty as the side force that it causes [N].
    """
    if C_alpha is None or bend is None:
        return C_alpha
    if split is None:
        off = named(0.0, u_force / abs(C_alpha.nominal_value), "sideslip alignment of the slope", "rad")
    else:
        off = split.misalignment
    return C_alpha - bend * off


def camber_at_true_zero(C_alpha: float, bend: UFloat, split: ZeroSplit) -> UFloat:
    """Ratio of the camber stiffness at true zero sideslip to that at zero reading.

    If camber acts like sideslip, its force changes with the bend of the sideslip curve; if it acts independently, it does not.
    The true share is between these, with a rectangular distribution from 0 to 1 (JCGM 100, 4.3.7).
    """
    share = named(0.5, 1.0 / math.sqrt(12.0), "camber stiffness off true zero", "-")
    return 1.0 - share * (bend / C_alpha) * split.misalignment
