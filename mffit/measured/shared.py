"""Errors of eps_gamma that come from the tyre and are common to all loads: conicity, finite spin, temperature."""

from __future__ import annotations

import math
from typing import NamedTuple

from uncertainties import UFloat

from mffit.config import Config
from mffit.measured import constants
from mffit.measured.result import CONICITY, FINITE_SPIN
from mffit.measured.sources import named
from mffit.rig_errors import BY_NAME


class SharedErrors(NamedTuple):
    """Numbers with uncertainty that enter at every load."""

    conicity: UFloat  #: force over load
    spin_left: UFloat  #: bias of finite spin in a value that is not corrected for it, as :data:`constants.SPIN_LOSS` [m^2]
    spin_known: UFloat  #: the same with the usual value and its uncertainty, to correct with [m^2]
    warming: UFloat  #: relative change of stiffness with temperature [1/K]


def shared_errors(config: Config) -> SharedErrors:
    """The errors as declared or usual."""
    loss, u = float(constants.SPIN_LOSS), float(constants.SPIN_LOSS_U)
    return SharedErrors(
        conicity=named(0.0, config.rig.u_conicity, CONICITY, "-"),
        # JCGM 100, F.2.4.5: a known effect that is left uncorrected counts with its size.
        spin_left=named(0.0, math.hypot(loss, u), FINITE_SPIN, "m^2"),
        spin_known=named(loss, u, FINITE_SPIN, "m^2"),
        warming=named(0.0, BY_NAME["k_T_stiffness_per_K"].spread, "temperature", "1/K"),
    )
