"""Cornering and camber stiffness of one load, as read off its sweeps in both directions."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from uncertainties import UFloat

from mffit.constants import USUAL_U_FORCE, ZERO_CAMBER
from mffit.measured import constants
from mffit.measured.backlash import rest_of_play
from mffit.measured.evidence import DirectEvidence
from mffit.measured.groups import LoadGroup
from mffit.measured.slopes import SlopeAtZero
from mffit.measured.sources import named
from mffit.measured.stiffnesses import (
    Estimates,
    chosen_camber_stiffness,
    cornering,
    estimates,
    number,
    on_usual_radius,
    shape_error,
    sweep,
    u_odd,
)
from mffit.points import main_path

CAMBER, BACKWARD_CAMBER = "camber stiffness", "camber stiffness backwards"


@dataclass(frozen=True, slots=True)
class LoadSlopes:
    """The stiffnesses of one load; the rig errors are still in them."""

    C_alpha: UFloat | None  #: at the reading of zero [N/rad]
    bend: UFloat | None  #: change of the slope with sideslip there [N/rad^2]
    C_gamma: UFloat | None  #: of the forward sweep by the configured method [N/rad]
    C_gamma_backward: UFloat | None  #: the same of a backward sweep
    slope: UFloat | None  #: of the forward sweep at zero [N/rad]
    secant: UFloat | None  #: of the forward sweep [N/rad]
    exists: bool  #: whether anything could be estimated


def load_slopes(evidence: DirectEvidence, group: LoadGroup) -> tuple[LoadSlopes, list[str]]:
    """The stiffnesses, from the odd curves on a disc and from the curves themselves on a straight path; and warnings."""
    C_alpha = cornering_stiffness(evidence, group)
    (camber, largest), (backward, largest_backward) = (
        _camber_estimates(evidence, group, C_alpha, direction) for direction in (1, -1)
    )
    chosen, trouble = chosen_camber_stiffness(evidence.config, camber, largest, group.load)
    chosen_backward, _ = chosen_camber_stiffness(evidence.config, backward, largest_backward, group.load)
    if evidence.rig is None:
        chosen_backward = None
    # Both directions have one shape of curve, so its error drops out of their difference.
    curved = [x for x in (camber.slope, chosen, chosen_backward) if isinstance(x, SlopeAtZero)]
    shape = shape_error(curved, CAMBER)
    slope, secant = number(camber.slope, CAMBER, shape), number(camber.secant, CAMBER)
    found = LoadSlopes(
        C_alpha=C_alpha,
        bend=_bend(evidence, group),
        C_gamma=slope if chosen is camber.slope else secant,
        C_gamma_backward=number(chosen_backward, BACKWARD_CAMBER, shape),
        slope=slope,
        secant=secant,
        exists=not (C_alpha is None and slope is None and secant is None),
    )
    return found, [trouble] if trouble else []


def cornering_stiffness(evidence: DirectEvidence, group: LoadGroup) -> UFloat | None:
    """Slope of the side force over sideslip at zero [N/rad]; the secant where there are too few angles."""
    found = cornering(evidence.points, evidence.parts, evidence.odd_slip, group, evidence.config)
    C_alpha = number(found.slope or found.secant, "cornering stiffness")
    play = rest_of_play(evidence.config)
    if C_alpha is None or not evidence.config.rig.backlash_deg:
        return C_alpha
    return C_alpha * (1.0 + play / constants.CUBIC_SIDESLIP.rad)


def _bend(evidence: DirectEvidence, group: LoadGroup) -> UFloat | None:
    """Second derivative of the side force over sideslip at zero, upright and forwards; None with too few angles."""
    points, reach = evidence.points, constants.CUBIC_SIDESLIP.rad
    i = on_usual_radius(points, group, evidence.config)
    i = i[
        (points.direction[i] == 1)
        & (np.abs(points.gamma[i]) < ZERO_CAMBER.rad)
        & (np.abs(points.alpha[i]) <= 1.1 * reach)
        & np.isfinite(points.Fy[i])
        & (points.phi_t[i] == main_path(points))
    ]
    x = points.alpha[i]
    if len(np.unique(np.round(x, 3))) < constants.POINTS_FOR_PARABOLA or not x.min() < 0.0 < x.max():
        return None
    u = np.where(np.isfinite(points.u_Fy[i]), points.u_Fy[i], USUAL_U_FORCE)
    A = np.vander(x / reach, 4) / u[:, None]
    covariance = np.linalg.inv(A.T @ A)
    quadratic = (covariance @ A.T @ (points.Fy[i] / u))[1]
    scale = 2.0 / reach**2
    return named(
        scale * quadratic,
        scale * math.sqrt(covariance[1, 1]),
        "bend of the sideslip curve",
        "N/rad^2",
        kind="A",
    )


def _camber_estimates(
    evidence: DirectEvidence, group: LoadGroup, C_alpha: UFloat | None, direction: int
) -> tuple[Estimates, float]:
    """Slope and secant of the camber sweep in one direction, and the largest camber in it [rad]."""
    config, points = evidence.config, evidence.points
    odd_Fy = evidence.parts.Fy_odd if evidence.rig else points.Fy
    index = sweep(points, odd_Fy, group, "gamma", config, direction)
    if C_alpha is not None:  # less the force of the sideslip that backlash leaves in a camber sweep
        in_sweep = np.isin(np.arange(len(points)), index)
        slip_force = direction * C_alpha.nominal_value * evidence.odd_slip
        odd_Fy = np.where(in_sweep, odd_Fy - slip_force, odd_Fy)
    local, angle = constants.CUBIC_CAMBER.rad, math.radians(config.camber_stiffness.angle_deg)
    found = estimates(points.gamma, odd_Fy, u_odd(evidence.parts), index, local, angle)
    return found, float(points.gamma[index].max(initial=0.0))
