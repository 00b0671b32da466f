"""The side force over sideslip near zero, as the correction of zeros needs it."""

from __future__ import annotations

from typing import NamedTuple

from uncertainties import UFloat

from mffit.constants import USUAL_CORNERING_STIFFNESS
from mffit.measured import constants
from mffit.measured.sources import named


class SlipStiffness(NamedTuple):
    """Slope and bend of the side force over sideslip at its reading of zero; the slope is the usual one if none was measured."""

    C_alpha: UFloat  #: [N/rad]
    bend: UFloat | None  #: change of the slope with sideslip, on the usual side of the disc [N/rad^2]

    def at(self, angle: UFloat) -> UFloat:
        """Slope at true zero [N/rad], where the axis is off by an angle [rad]."""
        return self.C_alpha if self.bend is None else self.C_alpha - self.bend * angle

    def force(self, angle: UFloat, side: float) -> UFloat:
        """Side force [N] that an angle [rad] adds to a forward reading of zero; ``side`` is 1, or -1 on the other side."""
        linear = self.at(angle) * angle
        return linear if self.bend is None else linear + 0.5 * side * self.bend * angle**2


def slip_stiffness(C_alpha: UFloat | None, bend: UFloat | None, load: float) -> SlipStiffness:
    """As measured, else the usual one at a load [N]."""
    if C_alpha is not None:
        return SlipStiffness(C_alpha, bend)
    usual = USUAL_CORNERING_STIFFNESS * load
    return SlipStiffness(
        named(-usual, constants.GUESSED_STIFFNESS_U * usual, "usual cornering stiffness", "N/rad"), None
    )
