"""Texts at the axes and above the panels of the pictures."""

from __future__ import annotations

import re
from collections.abc import Iterable

from mffit.constants import UPRIGHT
from mffit.quantities import CHANNELS, CONDITIONS, DIRECT, MODEL
from mffit.report.curves import Curve
from mffit.report.drawing.records import Axis
from mffit.rounding import number

ANGLES = {"alpha": CONDITIONS["alpha_deg"], "gamma": CONDITIONS["gamma_deg"]}
"""The angles that are varied, by the attribute of the points."""
SLIP = MODEL["kappa"]
OTHER = {"alpha": "gamma", "gamma": "alpha", "kappa": "alpha"}
"""The angle that is held while another one, or longitudinal slip, is varied."""
LOAD = CONDITIONS["Fz_N"]
EPSILON = DIRECT["epsilon_gamma"]


def angle_axis(over: str) -> Axis:
    """The axis of a varied angle [deg], or of longitudinal slip [-]."""
    return Axis(label=SLIP.axis if over == "kappa" else ANGLES[over].axis)


def held(curve: Curve) -> str:
    """The angle that a curve holds, and its value."""
    return f"{ANGLES[OTHER[curve.over]].symbol} = {number(curve.held, 0)}°"


def held_unless_zero(curve: Curve) -> str:
    """The same behind a comma; empty for a curve that holds zero."""
    return f", {held(curve)}" if abs(curve.held) >= UPRIGHT else ""


def typeset(text: str) -> str:
    """A sentence's channels with the subscripts that a picture shows."""
    return re.sub(rf"\b({'|'.join(CHANNELS)})\b", lambda m: CHANNELS[m[0]].mathtext, text)


def plain(text: str) -> str:
    """The text with subscripts as a table shows them: ``F_y``."""
    return re.sub(r"\$_\{(\w+)\}\$", r"_\1", text)


def places_of(angles: Iterable[float]) -> int:
    """Decimals with which angles [deg] are written: none if all are whole."""
    return 0 if all(round(x, 1) == round(x) for x in angles) else 1
