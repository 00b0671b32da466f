"""Vertical deflection and loaded radius of an upright wheel."""

from __future__ import annotations

from tir.equations.elementary import sqrt


def load_at_deflection(p, deflection, dpi):
    """Vertical load [N] at a deflection [m] of an upright, freely rolling wheel; the growth with speed (Q_V2) left out.

    Q_FZ1 follows from VERTICAL_STIFFNESS, which is the slope of load over deflection at the nominal load and pressure.
    """
    x = deflection / p.UNLOADED_RADIUS
    return p.FNOMIN * (1.0 + p.PFZ1 * dpi) * (linear_term(p) * x + p.Q_FZ2 * x**2)


def linear_term(p):
    """Q_FZ1 [-]: load over nominal load per relative deflection, at zero load."""
    return sqrt((p.VERTICAL_STIFFNESS * p.UNLOADED_RADIUS / p.FNOMIN) ** 2 - 4.0 * p.Q_FZ2)


def deflection(p, Fz, dpi):
    """Deflection [m] at a load [N]: the inverse of :func:`load_at_deflection`."""
    share = Fz / (p.FNOMIN * (1.0 + p.PFZ1 * dpi))
    linear = linear_term(p)
    return p.UNLOADED_RADIUS * 2.0 * share / (linear + sqrt(linear**2 + 4.0 * p.Q_FZ2 * share))
