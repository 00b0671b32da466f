"""The uncertainty budget of eps_gamma: its rows from a propagated number, and random draws."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from uncertainties import UFloat

from mffit.measured import constants
from mffit.measured.budget_rows import Contribution, Draws, welch_satterthwaite
from mffit.measured.sources import Source, source_of


def budget(epsilon: UFloat) -> tuple[Contribution, ...]:
    """What each source contributes to u(eps_gamma), largest first; variables of one source share a row."""
    rows: dict[str, list[_BudgetPart]] = {}
    for variable, slope in epsilon.derivatives.items():
        part = _BudgetPart(source_of(variable), variable.nominal_value, variable.std_dev, slope)
        rows.setdefault(part.source.name, []).append(part)
    found = (_row(parts) for parts in rows.values())
    return tuple(sorted((row for row in found if row.contribution > 1e-9), key=lambda row: -row.contribution))


class _BudgetPart(NamedTuple):
    """One independent variable of a source."""

    source: Source
    value: float
    u: float
    slope: float  #: derivative of eps_gamma by the variable

    @property
    def contribution(self) -> float:
        return abs(self.slope) * self.u


def _row(parts: Sequence[_BudgetPart]) -> Contribution:
    """The row of one source; of several variables the largest is shown, and the contribution is that of all."""
    largest = max(parts, key=lambda part: part.contribution)
    source, to_degrees = largest.source, math.degrees(1.0) if largest.source.unit == "rad" else 1.0
    contribution = math.hypot(*(part.contribution for part in parts))
    return Contribution(
        source=source.name,
        u=largest.u * to_degrees,
        unit="deg" if source.unit == "rad" else source.unit,
        contribution=contribution,
        type=source.kind,
        distribution=source.distribution,
        value=largest.value * to_degrees,
        sensitivity=math.copysign(contribution / largest.u, largest.slope) / to_degrees,
        dof=welch_satterthwaite([(part.contribution, part.source.dof) for part in parts]),
    )


def by_draws(r_e_C_gamma: UFloat, C_phit: UFloat, epsilon: UFloat, seed: int = 1) -> Draws:
    """u and 95 % interval of eps_gamma = 1 + r_e C_gamma / C_phit by random draws of all independent sources.

    Parameters
    ----------
    r_e_C_gamma : numerator, over the path radius [N]
    C_phit : denominator, over the path radius [N]
    epsilon : the factor; sources that it has beside the ratio add to it
    seed : of the draws

    Notes
    -----
    Numerator and denominator are linear in their sources, but for products of two small numbers; their ratio is not, and
    is taken draw by draw. The radius is taken out of both, as it cancels where r_e comes from a revolution of the disc.
    u is half the distance between the 15.87 % and 84.13 % quantiles, because a ratio has heavy tails.
    """
    rng = np.random.default_rng(seed)
    ratio = 1.0 + r_e_C_gamma / C_phit
    beside = epsilon - ratio
    drawn = {
        variable: _drawn(source_of(variable), variable.std_dev, rng)
        for variable in dict.fromkeys([*r_e_C_gamma.derivatives, *C_phit.derivatives, *beside.derivatives])
    }

    def sample(number: UFloat) -> np.ndarray:
        parts = (slope * drawn[variable] for variable, slope in number.derivatives.items())
        return number.nominal_value + sum(parts, np.zeros(int(constants.MONTE_CARLO_DRAWS)))

    values = 1.0 + sample(r_e_C_gamma) / sample(C_phit) + sample(beside)
    tail = (1.0 - constants.COVERAGE_PROBABILITY) / 2.0
    low, under, above, high = np.quantile(values, [tail, 0.158655, 0.841345, 1.0 - tail])
    return Draws(u=float(above - under) / 2.0, interval=(float(low), float(high)), number=len(values))


def _drawn(source: Source, u: float, rng: np.random.Generator) -> np.ndarray:
    """Random deviations of one variable from its value, in its unit."""
    count = int(constants.MONTE_CARLO_DRAWS)
    if source.kind == "A" and math.isfinite(source.dof):
        return u * rng.standard_t(max(source.dof, constants.LEAST_DOF_DRAWN), count)  # JCGM 101, 6.4.9
    return u * rng.standard_normal(count)
