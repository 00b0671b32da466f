"""What stands at the axes and above the panels of the pictures."""

from __future__ import annotations

import re

from mffit.quantities import CHANNELS, CONDITIONS, DIRECT

ANGLES = {"alpha": CONDITIONS["alpha_deg"], "gamma": CONDITIONS["gamma_deg"]}
"""The angles that are varied, by the attribute of the points."""
LOAD, PRESSURE = CONDITIONS["Fz_N"], CONDITIONS["p_kPa"]
EPSILON = DIRECT["epsilon_gamma"]


def condition(load: float, pressure: float) -> str:
    """Load [N] and pressure [kPa] of a panel."""
    return f"{LOAD.of(load)}, {PRESSURE.of(pressure)}"


def typeset(text: str) -> str:
    """The channels in a text as a picture shows them."""
    return re.sub(rf"\b({'|'.join(CHANNELS)})\b", lambda m: CHANNELS[m[0]].mathtext, text)
