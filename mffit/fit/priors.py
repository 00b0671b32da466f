"""What is known of a coefficient before its own tyre is measured."""

from __future__ import annotations

from collections.abc import Mapping

from mffit.fit.stages import SMALL_ON_A_DISC
from tir.parameters import BY_NAME

RELATIVE = 0.3
"""How far coefficients of similar tyres scatter around each other, relative, 1 sigma."""
SIMILAR, ANY = 0.05, 0.1
"""Share of the width between a coefficient's bounds by which it scatters at least: around the value of another tyre, and
around the table's default."""


def scatter(name: str, expected: float, *, from_base: bool, curved: bool) -> float:
    """How far the coefficient of this tyre may be from the expected value, 1 sigma.

    Parameters
    ----------
    name : coefficient
    expected : value of the base file, else the default
    from_base : whether a base file states it; 0 in a base file states nothing
    curved : whether the path is curved
    """
    if curved and name in SMALL_ON_A_DISC:
        return SMALL_ON_A_DISC[name]
    share = SIMILAR if from_base and expected else ANY
    return max(RELATIVE * abs(expected), share * BY_NAME[name].width)


def scatters(names: Mapping[str, float], origin: Mapping[str, str], *, curved: bool) -> dict[str, float]:
    """The same of every named coefficient with its expected value."""
    return {n: scatter(n, value, from_base=origin[n] == "base", curved=curved) for n, value in names.items()}
