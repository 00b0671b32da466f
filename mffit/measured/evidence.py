"""Input of the direct method, common to all loads: declared errors, and points whose sideslip is corrected for the play.

The moment takes up the play of the sideslip axis, so that the reading is not the angle.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from scipy.special import ndtr
from uncertainties import UFloat

from mffit.config import Config
from mffit.constants import USUAL_CORNERING_STIFFNESS, USUAL_U_MOMENT
from mffit.measured import camber_reduction as method
from mffit.measured import constants
from mffit.measured.axis import SetupAngle
from mffit.measured.drift import SweepShares
from mffit.measured.radii import measured_effective_radius, measured_path_radius
from mffit.measured.result import FINITE_SPIN
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
    calibration: Mapping[str, UFloat]  #: errors that multiply what is read, by name
    excess: Mapping[str, UFloat] = field(default_factory=dict)
    """Force by which each set-up scatters beyond what is declared [N]."""
    shares: SweepShares | None = None  #: of sweeps, where they drift for an unknown cause
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
        conicity=named(0.0, config.rig.u_conicity, "conicity", "-"),
        # JCGM 100, F.2.4.5: a known effect that is left uncorrected counts with its size.
        spin_left=named(0.0, math.hypot(loss, u_loss), FINITE_SPIN, "m^2"),
        spin_known=named(loss, u_loss, FINITE_SPIN, "m^2"),
        calibration={
            error.name: named(0.0, u[error.name], declared.source, declared.unit)
            for error, declared in DECLARED
            if declared.calibrates
        },
        warming=named(0.0, BY_NAME["k_T_stiffness_per_K"].spread, "temperature", "1/K"),
    )


def backlash_shift(Mz: np.ndarray, u_Mz: np.ndarray, play: float) -> tuple[np.ndarray, np.ndarray]:
    """Sideslip that the play adds to the reading, ISO-W: -(play/2) sign(Mz), and its standard uncertainty [rad].

    If the moment is within its noise, its sign is uncertain: the shift is then the expectation over both signs.
    """
    noise = np.where(np.isfinite(u_Mz) & (u_Mz > 0), u_Mz, USUAL_U_MOMENT)
    positive = ndtr(Mz / noise)
    return -0.5 * play * (2.0 * positive - 1.0), play * np.sqrt(positive * (1.0 - positive))


def backlash_corrected(points: Points, config: Config) -> Points:
    """The points with true sideslip angles; u_Fy includes the uncertainty of the side of the play.

    Points without Mz take the sign of the moment that the path curvature causes at zero slip.
    """
    play = np.radians(config.rig.backlash_deg)
    if play == 0.0:
        return points
    assumed = 1e3 * np.sign(points.phi_t) * points.direction  # [Nm]; only its sign matters
    shift, u = backlash_shift(np.where(np.isfinite(points.Mz), points.Mz, assumed), points.u_Mz, play)
    return points.replace(
        alpha=points.alpha + shift, u_Fy=np.hypot(points.u_Fy, USUAL_CORNERING_STIFFNESS * points.Fz * u)
    )


def rest_of_play(config: Config) -> UFloat:
    """What the correction leaves of sideslip zeros, as the wheel floats where the moment changes sign [rad]."""
    half = 0.5 * math.radians(config.rig.backlash_deg)
    return named(0.0, constants.REST_OF_PLAY * half, "play near zero moment", "rad")


def odd_alpha(points: Points, parts: Parts, config: Config) -> np.ndarray:
    """Sideslip (n,) to which the odd part of every point belongs: half the difference of the true angles of the pair.

    Parameters
    ----------
    points : with the angles as read
    parts : their decomposition, by reading
    """
    play = np.radians(config.rig.backlash_deg)
    if play == 0.0:
        return points.alpha
    own, _ = backlash_shift(points.Mz, points.u_Mz, play)
    mirror, _ = backlash_shift(points.Mz - 2.0 * parts.Mz_odd, points.u_Mz, play)
    return np.asarray(points.alpha + np.nan_to_num(own - mirror) / 2.0)
