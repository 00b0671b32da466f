"""What stands at the axes and above the panels of the pictures."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from mffit.quantities import CONDITIONS, DIRECT

if TYPE_CHECKING:
    from markupsafe import Markup

ANGLES = {"alpha": CONDITIONS["alpha_deg"], "gamma": CONDITIONS["gamma_deg"]}
"""The angles that are varied, by the attribute of the points."""
LOAD, PRESSURE = CONDITIONS["Fz_N"], CONDITIONS["p_kPa"]
EPSILON = DIRECT["epsilon_gamma"]


def condition(load: float, pressure: float) -> str:
    """Load [N] and pressure [kPa] of a panel."""
    return f"{LOAD.of(load)}, {PRESSURE.of(pressure)}"


def typeset(sentence: str) -> Markup:
    """A sentence for a page: the symbols of quantities, which a terminal shows in ASCII, as they are written."""
    from markupsafe import Markup, escape

    symbols = {q.ascii: q.html for q in DIRECT.values() if "_" in q.ascii}
    words = "|".join(sorted(symbols, key=len, reverse=True))
    return Markup(re.sub(rf"\b({words})\b", lambda found: symbols[found[0]], str(escape(sentence))))
