"""Input of the direct method, common to all loads."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from uncertainties import UFloat

from mffit.config import Config
from mffit.measured import camber_reduction as method
from mffit.measured import constants
from mffit.measured.axis import SetupAngle
from mffit.measured.backlash import backlash_corrected, odd_alpha
from mffit.measured.radii import measured_effective_radius, measured_path_radius
from mffit.measured.result import CONICITY, FINITE_SPIN, SetupScatter
from mffit.measured.uncertain import named
from mffit.parts import Parts
from mffit.points import Points
from mffit.rig_errors import BY_NAME, DECLARED
from tir import Tyre


@dataclass(frozen=True, slots=True, kw_only=True)
class DirectEvidence:
    """Points and declarations from which every load is measured, and errors of the tyre that are common to all loads."""

    config: Config
    points: Points  #: with sideslip angles corrected for the play
    parts: Parts
    odd_slip: np.ndarray  #: (n,) sideslip to which the odd part of every point belongs [rad]
    rig: method.UncertainRig | None  #: None on a straight path
    radii: Mapping[float, UFloat]  #: measured effective radius [m] by load [N]
    base: Tyre | None
    conicity: UFloat  #: force over load
    spin_left: UFloat  #: bias of finite spin in a value that is not corrected for it, as :data:`constants.SPIN_LOSS` [m^2]
    spin_known: UFloat  #: the same with the usual value and its uncertainty, to correct with [m^2]
    warming: UFloat  #: relative change of stiffness with temperature [1/K]
    scatter: SetupScatter | None = None  #: of repeated set-ups
    excess: Mapping[str, UFloat] = field(default_factory=dict)
    """Force by which each set-up scatters beyond what is declared [N]."""
    axes: Mapping[str, SetupAngle] = field(default_factory=dict)
    """alpha_M of every set-up that was run both ways."""

    @property
    def published(self) -> bool:
        """Whether C_gamma is to be the secant: then the budget is that of the published procedure, too."""
        return self.config.camber_stiffness.method == "secant"

    @property
    def odd_Fy(self) -> np.ndarray:
        """Odd part of the side force (n,) [N]; on a straight path the side force itself."""
        return self.points.Fy if self.rig is None else self.parts.Fy_odd


def evidence_of(config: Config, points: Points, parts: Parts, base: Tyre | None) -> DirectEvidence:
    """The evidence in points with the angles as read, and the errors as declared or usual."""
    R = measured_path_radius(config)
    u = {error.name: config.rig.u(error.name) for error, _ in DECLARED}
    loss = float(constants.SPIN_LOSS)
    u_loss = 0.5 * loss  # a brush that does not slide has no loss, and other tyres may have twice as much
    return DirectEvidence(
        config=config,
        points=backlash_corrected(points, config),
        parts=parts,
        odd_slip=odd_alpha(points, parts, config),
        rig=None if R is None else method.uncertain_rig(u, R, points.used_setups),
        radii=measured_effective_radius(config, R),
        base=base,
        conicity=named(0.0, config.rig.u_conicity, CONICITY, "-"),
        # JCGM 100, F.2.4.5: a known effect that is left uncorrected counts with its size.
        spin_left=named(0.0, math.hypot(loss, u_loss), FINITE_SPIN, "m^2"),
        spin_known=named(loss, u_loss, FINITE_SPIN, "m^2"),
        warming=named(0.0, BY_NAME["k_T_stiffness_per_K"].spread, "temperature", "1/K"),
    )
