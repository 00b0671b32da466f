"""Misalignment of the sideslip axis and ply-steer from the difference of forward and backward zeros."""

from __future__ import annotations

import math
from typing import NamedTuple

from uncertainties import UFloat

from mffit.config import Config
from mffit.measured import constants, notes
from mffit.measured.ply_steer import usual_ply_steer
from mffit.measured.result import LoadResult
from mffit.measured.sources import named


class ZeroSplit(NamedTuple):
    """alpha_M split into its two parts [rad], each with the uncertainty that the other one leaves."""

    misalignment: UFloat
    ply_steer: UFloat

    @property
    def axis_is_clear(self) -> bool:
        """Whether the misalignment differs clearly from zero."""
        return _is_clear(self.misalignment.nominal_value, self.misalignment.std_dev)


def split_of_zero(alpha_M: UFloat | None, C_alpha: float, u_force: float) -> ZeroSplit | None:
    """The parts by their priors; None without both directions in the set-up.

    Parameters
    ----------
    alpha_M : their sum [rad]
    C_alpha : cornering stiffness [N/rad]
    u_force : declared standard uncertainty of the alignment, as the side force that it causes [N]

    Notes
    -----
    The sum is divided in the ratio of the prior variances. If it is far beyond both priors, the declared alignment is
    contradicted, as ply-steer is a property of tyres and no tyre has so much: the axis then gets the variance that is missing.
    """
    if alpha_M is None:
        return None
    axis, tyre = u_force / abs(C_alpha), usual_ply_steer()
    size = abs(alpha_M.nominal_value)
    if size > constants.CONTRADICTED * math.hypot(axis, tyre):
        axis = math.sqrt(size**2 - tyre**2)
    both = math.hypot(axis, tyre)
    share = (axis / both) ** 2
    exchanged = named(0.0, axis * tyre / both, "split of misalignment and ply-steer", "rad")
    return ZeroSplit(share * alpha_M + exchanged, (1.0 - share) * alpha_M - exchanged)


def at_true_zero(
    C_alpha: UFloat | None, bend: UFloat | None, split: ZeroSplit | None, u_force: float
) -> UFloat | None:
    """Cornering stiffness at zero sideslip [N/rad] from that at the reading of zero.

    Parameters
    ----------
    C_alpha : slope at the reading of zero [N/rad]
    bend : change of the slope with sideslip [N/rad^2]
    split : the misalignment, if both directions were run
    u_force : else the declared standard uncertainty of the alignment, as the side force that it causes [N]

    Notes
    -----
    On a disc the curve is shifted by about a degree, so its slope changes even at zero.
    """
    if C_alpha is None or bend is None:
        return C_alpha
    if split is None:
        off = named(0.0, u_force / abs(C_alpha.nominal_value), "sideslip alignment of the slope", "rad")
    else:
        off = split.misalignment
    return C_alpha - bend * off


def camber_at_true_zero(C_alpha: float, bend: UFloat, split: ZeroSplit) -> UFloat:
    """Camber stiffness at true zero of sideslip over that at the reading of zero.

    Camber that acts as sideslip loses its force with the bend of the sideslip curve, camber with a force of its own does not.
    Every share between them is as likely: a rectangular distribution from 0 to 1 (JCGM 100, 4.3.7).
    """
    share = named(0.5, 1.0 / math.sqrt(12.0), "camber stiffness off true zero", "-")
    return 1.0 - share * (bend / C_alpha) * split.misalignment


class AlignmentVerdict(NamedTuple):
    """Whether the slip force at zero exceeds what the rig's own alignment leaves."""

    beyond: bool  #: the force exceeds it, and the fit corrects the readings
    misaligned: bool  #: the split supports that the axis, and not the tyre, causes it
    sentence: str  #: empty where both sides of the disc make the misalignment cancel


def alignment_verdict(config: Config, row: LoadResult) -> AlignmentVerdict:
    """The verdict at one load with a turn-slip force."""
    assert row.F_phit is not None
    force, left = row.F_phit.value, config.rig.u("alpha_0_deg")
    if row.alpha_M is None and min(row.paths) < 0.0 < max(row.paths):
        return AlignmentVerdict(False, False, "")
    if row.alpha_M is None:
        angle = math.degrees(abs(force / row.C_alpha.value)) if row.C_alpha is not None else None
        return AlignmentVerdict(False, False, notes.not_separable(force, angle, left))
    slip = row.slip_force(row.alpha_M.value)
    beyond = abs(slip) > left
    axis, tyre = row.misalignment, row.ply_steer
    assert axis is not None
    assert tyre is not None
    clear = beyond and _is_clear(axis.value, axis.u)
    sentence = notes.misaligned if clear else notes.slip_beyond if beyond else notes.aligned
    return AlignmentVerdict(beyond, clear, sentence(row.alpha_M, axis, tyre, slip, row.shift_by(slip)))


def _is_clear(misalignment: float, u: float) -> bool:
    return bool(abs(misalignment) > constants.CLEAR_MISALIGNMENT * u)
