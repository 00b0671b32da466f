"""The steady-state equations of MF 5.2 and PAC2002, by those of MF 6.2 where they are the same.

Numbers in round brackets are those of the MF-Tyre 5.2 manual, which PAC2002's repeats. With PKY4 = 2 and without the terms that
6.2 added, 6.2 differs in two places: what camber does to the shifts of the side force (55, 56), and which side force acts on the
trail (57). The equivalent slip of the combined moment has the tangent of the sideslip, as in both manuals; some public readers
take the angle itself.
"""

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from tir.equations import aligning, lateral, longitudinal, normalise, overturning, stiffness, turn_slip
from tir.equations.elementary import away_from_zero

SCALED_BY_CAMBER: Mapping[str, tuple[str, int]] = {
    "PDX3": ("LGAX", 2),  # (34)
    **dict.fromkeys(("PKY3", "PHY3", "PVY3", "PVY4", "PEY4"), ("LGAY", 1)),  # (48)
    "PDY3": ("LGAY", 2),
    **dict.fromkeys(("QBZ4", "QBZ5", "QDZ3", "QDZ8", "QDZ9", "QEZ5", "QHZ3", "QHZ4"), ("LGAZ", 1)),  # (63)
    "QDZ4": ("LGAZ", 2),
}
"""Coefficients of camber, by the scaling factor of camber that acts on them, and its power."""
RENAMED = {"PPZ1": "QPZ1", "PPZ2": "QPZ2", "LKYC": "LKYG"}
"""Names of MF 6.2 for what PAC2002 calls otherwise."""


class OldForces(NamedTuple):
    """Forces [N] and moments [Nm] in ISO-W axes; (n,) each."""

    Fx: Any
    Fy: Any
    Mx: Any
    Mz: Any


def in_terms_of_62(values: Mapping[str, Any]) -> SimpleNamespace:
    """The old coefficients under the names of MF 6.2: the scaling factors of camber (34, 48, 63) are within the coefficients.

    PHY3 stays in addition, because 6.2 has nothing like it.
    """
    scaled = {
        name: values[name] * values[factor] ** power for name, (factor, power) in SCALED_BY_CAMBER.items()
    }
    renamed = {new: values[old] for new, old in RENAMED.items()}
    p = SimpleNamespace(**{**values, **scaled, **renamed, "LKZC": 1.0})
    p.PHY3 = p.PHY3 * p.LKYG
    if p.IP_NOM == p.IP_NOM:
        p.NOMPRES = p.IP_NOM
        p.INFLPRES = p.IP if p.IP == p.IP else p.IP_NOM
    return p


def forces(p: SimpleNamespace, Fz: Any, alpha: Any = 0.0, gamma: Any = 0.0, kappa: Any = 0.0) -> OldForces:
    """MF 5.2 in steady state at the pressure of the file (ISO-W, SI, radians), the curvature factors held to 1 as it demands.

    ``p`` is from :func:`in_terms_of_62`; loads are > 0, scalar or (n,) as the other inputs.
    """
    at = normalise.OperatingCondition(Fz, alpha, gamma, kappa)
    q = normalise.inputs(p, at, normalise.Switches(limits=True))
    K_xk, K_ya = (
        stiffness.longitudinal_slip_stiffness(p, q),
        stiffness.cornering_stiffness(p, q, q.gamma),
    )  # (53)
    mu_x, mu_y = stiffness.longitudinal_friction(p, q), stiffness.lateral_friction(p, q, q.gamma)  # (51)
    Fx = longitudinal.combined_weight(p, q) * longitudinal.pure(p, q, turn_slip.NO_SPIN, K_xk, mu_x)
    # Shifted by camber through PHY3 alone: 6.2's own term of camber is switched off and its rest is taken back.
    by_camber = p.PHY3 * q.gamma + lateral.camber_force(p, q, q.gamma) / away_from_zero(K_ya)
    shifts = turn_slip.NO_SPIN._replace(zeta0=0.0, shift=by_camber)
    side = lateral.pure(p, q, q.gamma, shifts, stiffness.SideGrip(K_ya, 0.0, mu_y))  # (46) to (56)
    weighted = lateral.combined_weight(p, q) * side.Fy
    Fy = weighted + lateral.longitudinal_shift(p, q, mu_y, 1.0)
    trail = aligning.trail(p, q, turn_slip.NO_SPIN, K_xk, K_ya)  # (58), (59), (64) to (68)
    torque = (turn_slip.NO_SPIN, turn_slip.NO_SPIN_TORQUE, side, K_xk)
    residual = aligning.residual_torque(p, q, *torque)  # (60) to (62), (69), (70)
    Mz = -trail * weighted + residual + aligning.longitudinal_arm(p, q, Fy) * Fx  # (57)
    return OldForces(Fx, Fy, overturning.moment(p, q, Fz, Fy), Mz)


def relaxation_lengths(p: SimpleNamespace, Fz: Any) -> tuple[np.ndarray, np.ndarray]:
    """Longitudinal and lateral relaxation length [m] of the upright wheel at loads [N]; 0 where the file has none."""
    Fz0, R0 = normalise.nominal_load(p), p.UNLOADED_RADIUS
    dfz = normalise.relative_load(p, Fz)
    sigma_x = Fz * (p.PTX1 + p.PTX2 * dfz) * np.exp(p.PTX3 * dfz) * R0 / Fz0 * p.LSGKP
    share = p.PTY1 * np.sin(2.0 * np.arctan(Fz / (p.PTY2 * Fz0))) if p.PTY2 else np.zeros_like(Fz)
    return np.abs(sigma_x), np.abs(share * R0 * p.LFZO * p.LSGAL)
