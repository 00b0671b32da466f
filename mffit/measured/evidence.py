"""Inputs of the direct method common to all loads: declared errors, and points corrected for the play of the sideslip axis.

The aligning moment pushes the wheel to one side of the play, so the true sideslip differs from the reading.
"""

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
from mffit.measured.result import FINITE_SPIN, Drift, SetupScatter, SideslipZeros
from mffit.measured.uncertain import named
from mffit.parts import Parts
from mffit.points import Points
from mffit.rig_errors import BY_NAME, DECLARED
from tir import Quantity, Tyre
from tir.frozen import ReadOnlyArrays


@dataclass(frozen=True, slots=True, kw_only=True)
class DirectEvidence(ReadOnlyArrays):
    """Points, declarations and errors common to all loads, from which the results at every load are computed."""

    config: Config
    points: Points  #: points with sideslip corrected for the play
    parts: Parts
    odd_slip: np.ndarray  #: (n,) sideslip of the odd part of every point [rad]
    rig: method.UncertainRig | None  #: None on a straight path
    radii: Mapping[float, UFloat]  #: measured effective radius [m] by load [N]
    base: Tyre | None
    conicity: UFloat  #: force over load
    spin_left: UFloat  #: bias of finite spin in an uncorrected value, as :data:`constants.SPIN_LOSS` [m^2]: 0 with uncertainty
    spin_known: UFloat  #: bias of finite spin for the correction, with its uncertainty [m^2]
    spin_of_model: bool  #: whether this bias is that of a fitted model, for the configured method
    warming: UFloat  #: relative change of stiffness with temperature [1/K]
    calibration: Mapping[str, UFloat]  #: multiplicative errors of the readings, by name
    excess: Mapping[str, UFloat] = field(default_factory=dict)
    """By set-up, the force of its scatter beyond the declaration [N]."""
    shares: SweepShares | None = None  #: relative deviations of the sweeps' forces, if they drift
    axes: Mapping[str, SetupAngle] = field(default_factory=dict)
    """alpha_M of every set-up that was run both ways."""
    skew: Quantity | None = None  #: measured rig error that adds to the camber stiffness, in its own unit
    scatter: SetupScatter | None = None  #: of repeated set-ups
    zeros: tuple[SideslipZeros, ...] = ()  #: consistency of the sideslip zeros of every set-up
    drift: Drift | None = None  #: between sweeps; None if the temperature varies, which may explain it

    @property
    def published(self) -> bool:
        """Whether C_gamma is the secant of the published procedure, which also determines the budget."""
        return self.config.camber_stiffness.method == "secant"

    @property
    def odd_Fy(self) -> np.ndarray:
        """Odd part of the side force (n,) [N]; on a straight path the side force itself."""
        return self.points.Fy if self.rig is None else self.parts.Fy_odd


def evidence_of(
    config: Config, points: Points, parts: Parts, base: Tyre | None, spin: Quantity | None = None
) -> DirectEvidence:
    """The inputs of the direct method from points with the angles as read, and from declared or usual errors.

    ``spin`` is the bias of finite spin by a fitted model, as :data:`constants.SPIN_LOSS` [m^2]; by default the usual one.
    """
    R = measured_path_radius(config)
    u = {error.name: config.rig.u(error.name) for error, _ in DECLARED}
    usual = float(constants.SPIN_LOSS)
    # The usual uncertainty covers no loss (a brush that does not slide) and twice the usual loss.
    loss, u_loss = (usual, 0.5 * usual) if spin is None else (spin.value, spin.u)
    return DirectEvidence(
        config=config,
        points=backlash_corrected(points, config),
        parts=parts,
        odd_slip=odd_alpha(points, parts, config),
        rig=None if R is None else method.uncertain_rig(u, R, points.used_setups),
        radii=measured_effective_radius(config, R),
        base=base,
        conicity=named(0.0, config.rig.u_conicity, "conicity", "-"),
        # JCGM 100, F.2.4.5: a known but uncorrected effect enlarges the uncertainty by its size.
        spin_left=named(0.0, math.hypot(loss, u_loss), FINITE_SPIN, "m^2"),
        spin_known=named(loss, u_loss, FINITE_SPIN, "m^2"),
        spin_of_model=spin is not None,
        calibration={
            error.name: named(0.0, u[error.name], declared.source, declared.unit)
            for error, declared in DECLARED
            if declared.calibrates
        },
        warming=named(0.0, BY_NAME["k_T_stiffness_per_K"].spread, "temperature", "1/K"),
    )


def backlash_shift(Mz: np.ndarray, u_Mz: np.ndarray, play: float) -> tuple[np.ndarray, np.ndarray]:
    """Sideslip that the play adds to the reading, ISO-W: -(play/2) sign(Mz), and its standard uncertainty [rad].

    If the moment is within its noise, its sign is uncertain, so the shift is the expectation over both signs.
    """
    noise = np.where(np.isfinite(u_Mz) & (u_Mz > 0), u_Mz, USUAL_U_MOMENT)
    positive = ndtr(Mz / noise)
    return -0.5 * play * (2.0 * positive - 1.0), play * np.sqrt(positive * (1.0 - positive))


def backlash_corrected(points: Points, config: Config) -> Points:
    """The points with true sideslip angles; u_Fy includes the uncertainty of the side of the play.

    Without Mz, the sign of the moment is that of the path curvature at zero slip.
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
    """Remaining error of sideslip zeros after the correction [rad]: the wheel floats where the moment changes sign."""
    half = 0.5 * math.radians(config.rig.backlash_deg)
    return named(0.0, constants.REST_OF_PLAY * half, "play near zero moment", "rad")


def odd_alpha(points: Points, parts: Parts, config: Config) -> np.ndarray:
    """Sideslip (n,) of the odd part of every point: half the difference of the true angles of a mirror pair [rad]."""
    play = np.radians(config.rig.backlash_deg)
    if play == 0.0:
        return points.alpha
    own, _ = backlash_shift(points.Mz, points.u_Mz, play)
    mirror, _ = backlash_shift(points.Mz - 2.0 * parts.Mz_odd, points.u_Mz, play)
    return np.asarray(points.alpha + np.nan_to_num(own - mirror) / 2.0)
