"""What single programs compute otherwise than the formula, as numbers of a tyre; found in their public source."""

from __future__ import annotations

import math

from tir import calls
from tir.codegen.program import Switches
from tir.constants import NEGLIGIBLE_SHARE, SIDESLIP_BEYOND_PEAK, SLIP_BEYOND_PEAK, SMALL_TURN_SLIP
from tir.equations.forces import Forces, State
from tir.record import TyreRecord

CHRONO_HOLDS = 0.5 * math.pi - 0.01
"""Largest B x of a curve in Chrono's PAC2002: beyond this slip its pure forces stay constant."""


def beyond_the_peak_in_chrono(tyre: TyreRecord) -> dict[str, float]:
    """Share by which Chrono's pure Fx and Fy exceed those of the formula beyond the peak; upright, at nominal load and pressure.

    At SLIP_BEYOND_PEAK of longitudinal slip, and at SIDESLIP_BEYOND_PEAK. A force that the tyre does not have is left out.
    """
    Fz = float(tyre["FNOMIN"])
    state = _state(tyre, 0.0)
    shares = {}
    for channel, shape, friction, stiffness, shift, slip in (
        ("Fx", "PCX1", state.mu_x, state.K_xk, 0.0, float(SLIP_BEYOND_PEAK)),
        ("Fy", "PCY1", state.mu_y, state.K_ya, float(state.S_Hy), SIDESLIP_BEYOND_PEAK.rad),
    ):
        scale = tyre["LCX" if channel == "Fx" else "LCY"]
        per_slip = abs(float(stiffness)) / abs(float(tyre[shape] * scale * friction) * Fz or math.inf)
        held = min(slip, CHRONO_HOLDS / per_slip - shift) if per_slip else slip
        by_formula, by_program = (_pure(tyre, channel, x) for x in (slip, held))
        if by_formula:
            shares[channel] = by_program / by_formula - 1.0
    return shares


def chrono_in_words(tyre: TyreRecord) -> str:
    """The forces of :func:`beyond_the_peak_in_chrono` that differ, for a sentence; empty if none does."""
    places = {"Fx": f"slip {SLIP_BEYOND_PEAK:g}", "Fy": f"{SIDESLIP_BEYOND_PEAK:g} deg of sideslip"}
    shares = beyond_the_peak_in_chrono(tyre)
    return " and ".join(
        f"{channel} by {100.0 * share:+.0f} % at {places[channel]}"
        for channel, share in shares.items()
        if abs(share) > float(NEGLIGIBLE_SHARE)
    )


def spin_without_moment_in_mbsim(tyre: TyreRecord) -> float:
    """Total spin over turn slip below which MBSim's Mz is NaN, about, at nominal load; 1 if it is NaN upright on gentle curves.

    Its moment takes the arc cosine of the moment at 90 deg over that of spin (4.E102), which exceeds 1 where the spin of camber
    cancels most of the path's. The latter moment grows with the spin, the former with the turn slip.
    """
    return math.cos(0.5 * math.pi * float(_state(tyre, float(SMALL_TURN_SLIP)).zeta7))


def mbsim_in_words(tyre: TyreRecord) -> str:
    """Where MBSim's Mz is NaN, for a sentence."""
    share = spin_without_moment_in_mbsim(tyre)
    if share >= 1.0:
        return "on every gentle curve"
    return (
        f"wherever the total spin is within about {share:.2g} of the turn slip, as where a leaning wheel runs nearly straight: "
        f"within {share / 5.0:.2g} 1/m on a circle of 5 m"
    )


def _pure(tyre: TyreRecord, channel: str, slip: float) -> float:
    alpha, kappa = (0.0, slip) if channel == "Fx" else (slip, 0.0)
    inputs = (float(tyre["FNOMIN"]), alpha, 0.0, kappa, 0.0, tyre["LONGVL"], tyre["NOMPRES"])
    found: Forces = calls.forces(tyre, inputs, Switches(False))
    return float(getattr(found, channel))


def _state(tyre: TyreRecord, phi_t: float) -> State:
    inputs = (float(tyre["FNOMIN"]), 0.0, 0.0, 0.0, phi_t, tyre["LONGVL"], tyre["NOMPRES"])
    return calls.state(tyre, inputs, Switches(phi_t != 0.0))
