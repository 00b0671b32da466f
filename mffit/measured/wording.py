"""Sentences about finished measurements, for page and terminal; remarks of single steps are in ``notes``."""

from __future__ import annotations

import math

from mffit.measured import constants
from mffit.measured.alignment import Alignment
from mffit.measured.ply_steer import usual_ply_steer
from mffit.measured.result import Measured
from mffit.rounding import as_good_as


def epsilon_values(measured: Measured) -> str:
    """How the estimates of eps_gamma differ, and why; empty with one estimate."""
    direct, debiased, model = (
        measured.epsilon_gamma,
        measured.epsilon_gamma_debiased,
        measured.epsilon_gamma_model,
    )
    if direct is None or debiased is None:
        return ""
    joint = f"; the fitted model's turn-slip force corresponds to {model:.3f}" if model is not None else ""
    return (
        f"measured {direct.value:.3f}, to which the finite spin of the disc contributes {direct.value - debiased.value:+.3f}"
        f"{joint}; estimates that differ by less than {2.0 * direct.u:.3f} agree within their uncertainty"
    )


def by_draws(measured: Measured) -> str:
    """u(eps_gamma) and its 95 % interval by random draws; empty without draws."""
    row = measured.nominal
    if row is None or row.u_monte_carlo is None or row.interval is None:
        return ""
    low, high = (as_good_as(end, row.u_monte_carlo) for end in row.interval)
    return f"{row.u_monte_carlo:.4f} by random draws, 95 % interval {low} to {high}"


def expanded(measured: Measured) -> str:
    """The expanded uncertainty with its coverage factor; empty without a budget."""
    found = measured.nominal.expanded if measured.nominal else None
    if found is None:
        return ""
    dof = "infinite" if found.dof > constants.MANY_DEGREES_OF_FREEDOM else f"{found.dof:.0f}"
    return f"U = {found.U:.3f} with k = {found.k:.2f} for {100 * found.probability:.0f} % (effective degrees of freedom: {dof})"


def advice(found: Alignment) -> list[str]:
    """The next adjustment of the axis, and why these zeros differ from the report's."""
    correction, u = found.correction_deg, found.u_deg
    step = f"{correction:+.3f} +- {u:.3f} deg of the rig's own scale (k = 1)"
    if found.aligned:
        finer = (
            "its uncertainty"
            if abs(correction) <= u
            else f"the smallest step of the axis, {found.resolution_deg:g} deg"
        )
        out = [f"Aligned, stop: the correction {step} is within {finer}."]
    else:
        out = [f"Turn the sideslip axis by {step}, then measure both directions again."]
    out.append(
        "The correction is for the sum of misalignment and ply-steer, which look alike on one rig. With a usual ply-steer of "
        f"{math.degrees(usual_ply_steer()):.2f} deg the axis itself is known to +- {found.u_axis_deg:.2f} deg (k = 1)."
    )
    if any(row.source == "guess" for row in found.last):
        out.append(
            "C_alpha is guessed from the load, so the correction is uncertain; a sideslip sweep in tyre.toml or a second "
            "iteration measures it."
        )
    rows = [row for row in found.last if row.reported is not None]
    if rows:
        said = "; ".join(
            f"at {row.load:.0f} N "
            + " and ".join(
                f"{there:.1f} N {way} where it is {here:.1f} N here"
                for way, there, here in zip(
                    ("forwards", "backwards"),
                    row.reported or (),
                    (row.F_forward, row.F_backward),
                    strict=True,
                )
                if math.isfinite(there)
            )
            for row in rows
        )
        out.append(
            "The zeros above are plain means of the readings at zero, as the rig shows them. The report corrects them for the "
            f"play of the axis and, where five angles were run near zero, takes zero from a parabola through them: {said}."
        )
    return out
