"""Uncertain numbers with named sources: generalised least squares of them, and uncertainty budgets (JCGM 100)."""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.special import chdtrc, ndtr, stdtrit
from uncertainties import UFloat, ufloat

from mffit.as_json import keys
from mffit.config.uncertainty import shape_of
from mffit.constants import COVERAGE_FACTOR_95
from tir import Quantity

COVERAGE = float(2.0 * ndtr(COVERAGE_FACTOR_95) - 1.0)
"""Coverage probability of expanded uncertainties and intervals (JCGM 100, 6.2.2)."""


class Source(NamedTuple):
    """The origin of a standard uncertainty, in the terms of JCGM 100."""

    name: str
    unit: str  #: of the input quantity
    kind: str = "B"  #: "A": evaluated from the scatter of readings; "B": by other means
    dof: float = math.inf  #: degrees of freedom
    distribution: str = "normal"


def named(value: float, u: float, source: str, unit: str, **more: Any) -> UFloat:
    """An input quantity with its standard uncertainty; the configuration may state degrees of freedom and distribution.

    ``more`` are further fields of its :class:`Source`.
    """
    more = {**shape_of(u), **more}
    return ufloat(value, max(u, 1e-12), Source(source, unit, **more))  # the propagation does not accept u = 0


def quantity(x: UFloat, unit: str) -> Quantity:
    """An uncertain number as a plain record of value and standard uncertainty."""
    return Quantity(float(x.nominal_value), float(x.std_dev), unit)


def quantity_if(x: UFloat | None, unit: str) -> Quantity | None:
    """As :func:`quantity`; None for None."""
    return None if x is None else quantity(x, unit)


def covariance(numbers: Sequence[UFloat]) -> np.ndarray:
    """Covariance matrix (n, n) of uncertain numbers, reproducible to the last digit.

    ``uncertainties.covariance_matrix`` sums over the sources in the order of a set, which differs from run to run; here the order
    is that of first appearance.
    """
    sources = list(dict.fromkeys(source for number in numbers for source in number.derivatives))
    slopes = np.array(
        [[number.derivatives.get(source, 0.0) * source.std_dev for source in sources] for number in numbers]
    )
    return np.asarray(slopes @ slopes.T)


class Combined(NamedTuple):
    """Result of generalised least squares."""

    numbers: tuple[UFloat, ...]  #: (k,)
    weights: np.ndarray  #: (k, n) weights of the readings in the numbers
    chance: float  #: probability of residuals as large as these; 1 without degrees of freedom


def combined(
    readings: Sequence[UFloat], design: np.ndarray | None = None, beside: np.ndarray | float = 0.0
) -> Combined:
    """The generalised least-squares solution of readings = ``design`` (n, k) @ numbers; by default their weighted mean.

    ``beside`` is a further covariance (n, n) of the readings; it enters only the chi-square test behind ``chance``.
    """
    n = len(readings)
    A, errors = np.ones((n, 1)) if design is None else design, covariance(readings)
    said = np.array([reading.nominal_value for reading in readings])
    weights = _estimator(A, errors)
    numbers = tuple(sum(w * x for w, x in zip(row, readings, strict=True)) for row in weights.tolist())
    errors = errors + beside
    left, freedom = said - A @ (_estimator(A, errors) @ said), n - A.shape[1]
    chance = float(chdtrc(freedom, left @ np.linalg.solve(_defined(errors), left))) if freedom else 1.0
    return Combined(numbers, weights, chance)


def _defined(errors: np.ndarray) -> np.ndarray:
    """The covariance with a small ridge, which keeps it invertible if all errors are shared."""
    return np.asarray(errors + 1e-9 * np.diag(np.diag(errors)))


def _estimator(A: np.ndarray, errors: np.ndarray) -> np.ndarray:
    """Weights (k, n) of the generalised least-squares estimator."""
    weighted = np.linalg.solve(_defined(errors), A)
    return np.asarray(np.linalg.solve(A.T @ weighted, weighted.T))


def polynomial(
    x: np.ndarray, y: np.ndarray, u: np.ndarray, powers: Sequence[int]
) -> tuple[np.ndarray, np.ndarray]:
    """Coefficients (k,) of a polynomial with these powers fitted to readings (n,), and their standard uncertainties."""
    A = x[:, None] ** np.array(powers) / u[:, None]
    errors = np.linalg.inv(A.T @ A)
    return errors @ A.T @ (y / u), np.sqrt(np.diag(errors))


def agreed(declared: UFloat, measurements: Sequence[UFloat]) -> UFloat:
    """The weighted mean of a declared number and its measurements; without the declared one if the measurements contradict it."""
    (found,) = combined(measurements).numbers
    difference = found - declared
    if abs(difference.nominal_value) > COVERAGE_FACTOR_95 * difference.std_dev:
        return found
    return combined([declared, *measurements]).numbers[0]


class Contribution(NamedTuple):
    """One line of the budget, in the terms of JCGM 100."""

    source: str
    u: float  #: standard uncertainty of the input quantity, in its own unit
    unit: str
    contribution: float  #: to the uncertainty of the result, in its unit
    type: str = "B"  #: "A": evaluated from the scatter of readings; "B": by other means
    distribution: str = "normal"
    value: float = 0.0  #: estimate of the input quantity
    sensitivity: float = math.nan  #: change of the result with the input quantity, per unit
    dof: float = math.inf  #: degrees of freedom


class Expanded(NamedTuple):
    """The expanded uncertainty U = k u of eps_gamma."""

    U: float
    k: float  #: coverage factor, from the t distribution
    dof: float  #: effective degrees of freedom by Welch and Satterthwaite
    probability: float  #: that the interval +-U covers the true value


keys(Expanded, "U_epsilon_gamma=U coverage_factor=k coverage_probability=probability effective_dof=dof")


def budget(result: UFloat) -> tuple[Contribution, ...]:
    """The contribution of each source to the uncertainty of a result, largest first; variables of one source share a row."""
    sources: dict[str, list[Any]] = {}
    for variable in result.derivatives:
        sources.setdefault(variable.tag.name, []).append(variable)
    rows = (_row(result, variables) for variables in sources.values())
    least = 1e-6 * result.std_dev  # exact sources contribute less
    return tuple(sorted((row for row in rows if row.contribution > least), key=lambda row: -row.contribution))


def _row(result: UFloat, variables: Sequence[Any]) -> Contribution:
    """The row of one source; with several variables it shows the largest one and the contribution of all."""
    parts = result.error_components()
    largest = max(variables, key=lambda variable: parts[variable])
    source, size = largest.tag, math.degrees(1.0) if largest.tag.unit == "rad" else 1.0
    contribution = math.hypot(*(parts[variable] for variable in variables))
    return Contribution(
        source=source.name,
        u=largest.std_dev * size,
        unit="deg" if source.unit == "rad" else source.unit,
        contribution=contribution,
        type=source.kind,
        distribution=source.distribution,
        value=largest.nominal_value * size,
        sensitivity=math.copysign(contribution / largest.std_dev, result.derivatives[largest]) / size,
        dof=_effective_dof([(parts[variable], variable.tag.dof) for variable in variables]),
    )


def _effective_dof(parts: Sequence[tuple[float, float]]) -> float:
    """Degrees of freedom of a sum (JCGM 100, G.2b) from the contribution and degrees of freedom of each part."""
    weight = sum(u**4 / dof for u, dof in parts)
    return math.hypot(*(u for u, _ in parts)) ** 4 / weight if weight > 0.0 else math.inf


def expanded(rows: Sequence[Contribution]) -> Expanded:
    """The expanded uncertainty for a coverage probability of 95 % from the rows of a budget."""
    dof = _effective_dof([(row.contribution, row.dof) for row in rows])
    # JCGM 100, G.4.1: t distribution with the next lower integer of degrees of freedom.
    k = (
        float(stdtrit(max(1.0, math.floor(dof + 1e-6)), 0.5 + COVERAGE / 2.0))
        if math.isfinite(dof)
        else float(COVERAGE_FACTOR_95)
    )
    return Expanded(k * math.hypot(*(row.contribution for row in rows)), k, dof, round(COVERAGE, 6))
