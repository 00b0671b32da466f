"""The published procedure (Mottola and Massaro 2022) as it is printed, and what this program corrects beyond it.

The turn-slip force is the reading at zero sideslip and camber (5), or the mean of both directions of rolling (6), less the force
of the play; the camber stiffness is the secant (20) of the camber sweep as read; the uncertainty is that of (22) and (24).
"""

import math

import numpy as np

from mffit.measured.camber_reduction import camber_reduction, turn_slip_force
from mffit.measured.evidence import DirectEvidence
from mffit.measured.radii import effective_radius_at
from mffit.measured.result import LoadResult, PublishedResult, StepFromPaper
from mffit.measured.stiffnesses import (
    OddCurve,
    assumed_stiffness,
    camber_estimates,
    cornering_stiffness,
    sweep,
)
from mffit.measured.uncertain import quantity
from mffit.measured.zeros import WAYS, LoadGroup, load_groups, u_of, zeros
from mffit.points import Points
from mffit.rig_errors import AtZero

BUDGET = ("F0_N", "gamma_0_deg", "alpha_0_deg", "backlash_deg")
"""Rig errors in the budget of the paper (24)."""


FORCE = "parabola through the zeros, all paths and set-ups, conicity"
"""What this program corrects of the turn-slip force."""


def published(evidence: DirectEvidence, points: Points, row: LoadResult) -> PublishedResult | None:
    """The published procedure at the load of ``row``, from ``points`` with the angles as read.

    None where eps_gamma was not measured there, or the camber sweep does not reach the angle of the secant.
    """
    group = next((one for one in load_groups(evidence.points) if one.load == row.load), None)
    if group is None or evidence.rig is None or row.epsilon_gamma is None or not row.paths:
        return None
    config, odd, phi_t = evidence.config, evidence.parts.Fy_odd, row.paths[0]
    r_e = effective_radius_at(group.load, evidence.radii, evidence.base)
    camber = sweep(points, odd, group, "gamma", config)
    angle = math.radians(config.camber_stiffness.angle_deg)
    secant = OddCurve(points.gamma[camber], odd[camber], u_of(points, "Fy")[camber]).secant(angle)
    raw = _at_zero(points, group.of(points.phi_t[group.index] == phi_t))
    if secant is None or raw is None or r_e is None:
        return None
    C_alpha = row.slip_force(1.0)
    at = AtZero(C_alpha, secant.value, -math.copysign(1.0, phi_t))
    # Rolling forwards or backwards, the turn-slip moment takes up the play towards the same change of the force.
    of_play = C_alpha * at.side_of_play * 0.5 * math.radians(config.rig.backlash_deg)
    errors = {name: evidence.rig.errors[name] for name in BUDGET}
    force = turn_slip_force(raw - of_play, errors, at, both_directions=False)
    C_phit = math.copysign(1.0, phi_t) * force * evidence.rig.R
    return PublishedResult(
        epsilon_gamma=quantity(camber_reduction(C_phit, secant.value, r_e), "-"),
        F_phit=quantity(force, "N"),
        C_gamma=secant.value,
        corrections=_corrections(evidence, group, row, float(force.nominal_value), secant.value),
    )


def _at_zero(points: Points, group: LoadGroup) -> float | None:
    """Side force as read at zero [N], (5), or the mean of both directions of rolling (6)."""
    forces = [points.Fy[zeros(points, group, way)] for way in WAYS]
    known = [float(np.mean(force[np.isfinite(force)])) for force in forces if np.any(np.isfinite(force))]
    return float(np.mean(known)) if known else None


def _corrections(
    evidence: DirectEvidence, group: LoadGroup, row: LoadResult, force: float, secant: float
) -> tuple[StepFromPaper, ...]:
    """The steps from the force [N] and the secant [N/rad] of the published procedure to the result ``row``."""
    assert row.F_phit is not None
    assert row.C_phit is not None
    assert row.r_e is not None
    assert row.epsilon_gamma is not None
    per_C_gamma = row.r_e.value / row.C_phit.value
    C_alpha = assumed_stiffness(evidence, group, cornering_stiffness(evidence, group))
    corrected = camber_estimates(evidence, group, C_alpha, 1)
    leaning = {
        "play of the sideslip axis in the camber sweep": corrected.secant,
        "slope at zero in place of the secant": None if evidence.published else corrected.slope,
    }
    steps = {what: one.value for what, one in leaning.items() if one is not None}
    # eps_gamma holds the camber stiffness with all corrections, that for a drift included.
    steps["skew of the camber axis, true zero sideslip, drift"] = (
        row.epsilon_gamma.value - 1.0
    ) / per_C_gamma
    angle, here = math.radians(evidence.config.camber_stiffness.angle_deg), secant
    out = [StepFromPaper(FORCE, row.F_phit.value - force, 1.0 + per_C_gamma * secant)]
    for what, C_gamma in steps.items():
        out.append(StepFromPaper(what, angle * (C_gamma - here), 1.0 + per_C_gamma * C_gamma))
        here = C_gamma
    return tuple(out)
