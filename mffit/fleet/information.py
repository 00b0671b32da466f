"""What the readings of a build tell of tyre and rig, as a joint estimate of many builds takes it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from mffit.fit.priors import scatter
from mffit.numbers import Numbers
from mffit.rig_errors import BESIDE, error_of

MEASURED = ("PECP1",)
"""Coefficients without a prior, because the uncertainty with which a build holds them comes from the same points."""
HELD = "PECP2"
"""A coefficient that most builds hold exactly at 0."""


def freed(numbers: Numbers) -> Numbers | None:
    """The numbers of a build, also the coefficients that it held; None if its readings tell nothing.

    A held number of the rig, or one of which they tell nothing, is left out. Effects of the tyre that are not coefficients
    are left to readings and priors, as they are estimated anew in every build.
    """
    silent = {
        name
        for i, name in enumerate(numbers.names)
        if name in numbers.held and (error_of(name) or not numbers.information[i, i] > 0.0)
    }
    known = numbers.given(silent)
    if not known.names:
        return None
    spread = known.spread.copy()
    for i, name in enumerate(known.names):
        if name in MEASURED:
            spread[i] = math.inf
        elif name == HELD and spread[i] == 0.0:
            spread[i] = scatter(HELD, 0.0, from_base=False, curved=False)
    known = replace(known, spread=np.asarray(spread), held=frozenset())
    return known.without({error.name for error in BESIDE})
