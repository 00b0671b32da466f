"""Texts at the axes and above the panels of the pictures."""

import re
from collections.abc import Sequence

from mffit.quantities import CHANNELS, CONDITIONS, DIRECT, MODEL
from mffit.report.curves import Curve
from mffit.report.drawing.records import ZERO, Axis, DataSeries, Panel
from mffit.rounding import number

ANGLES = ("alpha", "gamma")
"""The angles that are varied, by the attribute of the points."""
OTHER = {"alpha": "gamma", "gamma": "alpha", "kappa": "alpha"}
"""The angle that is held while another one, or longitudinal slip, is varied."""
LOAD = CONDITIONS["Fz_N"]
EPSILON = DIRECT["epsilon_gamma"]


def angle_axis(over: str) -> Axis:
    """The axis of a varied angle [deg], or of longitudinal slip [-]."""
    return Axis(label=MODEL[over].axis)


def over_angle(over: str, channel: str, title: str, series: Sequence[DataSeries]) -> Panel:
    """A panel of a channel over a varied angle or longitudinal slip."""
    y = Axis(label=CHANNELS[channel].short_axis)
    return Panel(title=title, x=angle_axis(over), y=y, series=series, guides=[ZERO])


def angle(name: str, degrees: float, digits: int = 0) -> str:
    """An angle and its value: ``γ = 20°``."""
    return f"{MODEL[name].symbol} = {number(degrees, digits)}°"


def held(curve: Curve) -> str:
    """The angle that a curve holds, and its value."""
    return angle(OTHER[curve.over], curve.held)


def typeset(text: str) -> str:
    """A sentence's channels with the subscripts that a picture shows."""
    return re.sub(rf"\b({'|'.join(CHANNELS)})\b", lambda m: CHANNELS[m[0]].mathtext, text)


def plain(text: str) -> str:
    """The text with subscripts as a table shows them: ``F_y``."""
    return re.sub(r"\$_\{(\w+)\}\$", r"_\1", text)
