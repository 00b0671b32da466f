"""Rows and totals of the uncertainty budget, in the terms of JCGM 100 and 101."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from scipy.special import stdtrit

from mffit.measured import constants


class Contribution(NamedTuple):
    """One line of the budget, in the terms of JCGM 100."""

    source: str
    u: float  #: standard uncertainty of the input quantity, in its own unit
    unit: str
    contribution: float  #: to u(eps_gamma)
    type: str = "B"  #: "A": evaluated from the scatter of readings; "B": by other means
    distribution: str = "normal"
    value: float = 0.0  #: estimate of the input quantity
    sensitivity: float = math.nan  #: change of eps_gamma with the input quantity, per unit
    dof: float = math.inf  #: degrees of freedom


class Expanded(NamedTuple):
    """The expanded uncertainty U = k u of eps_gamma."""

    U: float
    k: float  #: coverage factor, from the t distribution
    dof: float  #: effective degrees of freedom by Welch and Satterthwaite
    probability: float  #: that the interval +-U covers the true value


class Draws(NamedTuple):
    """u(eps_gamma) and its 95 % interval by random draws (JCGM 101)."""

    u: float
    interval: tuple[float, float]  #: 2.5 % and 97.5 % quantiles
    number: int  #: of draws


def welch_satterthwaite(parts: Sequence[tuple[float, float]]) -> float:
    """Effective degrees of freedom of a sum (JCGM 100, G.2b) from the contribution and degrees of freedom of each part."""
    total = math.hypot(*(u for u, _ in parts))
    weight = sum(u**4 / dof for u, dof in parts)
    return total**4 / weight if weight > 0.0 else math.inf


def expanded(rows: Sequence[Contribution]) -> Expanded:
    """The expanded uncertainty for a coverage probability of 95 % from the rows of a budget."""
    u = math.hypot(*(row.contribution for row in rows))
    dof = welch_satterthwaite([(row.contribution, row.dof) for row in rows])
    # JCGM 100, G.4.1: the t distribution of the next lower whole number of degrees of freedom.
    whole = max(1.0, math.floor(min(dof, constants.MANY_DEGREES_OF_FREEDOM) + 1e-6))
    k = float(stdtrit(whole, 0.5 + constants.COVERAGE_PROBABILITY / 2.0))
    return Expanded(U=k * u, k=k, dof=dof, probability=float(constants.COVERAGE_PROBABILITY))
