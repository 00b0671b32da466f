"""The coefficients of a build for a page: value, uncertainty, reach of the slider, and the sweeps that determine them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from mffit.config.by_hand import may_be_free, unsettable
from mffit.constants import NAMED_IN_SENTENCE
from mffit.fit import Coefficient, FitResult
from mffit.fit.fitted import Fitted
from mffit.fit.wheel.vertical import OF_WHEEL_SPEED
from mffit.quantities import CHANNELS
from mffit.results import BuildResult
from mffit.viewer import constants
from tir.parameters import BY_NAME, TABLE, Parameter

BY_THE_FIT = frozenset({"fitted", "regularised"})
"""Status of coefficients that the readings of the sweeps determine."""
FOUND = BY_THE_FIT | {"measured"}
"""Status of coefficients that the data determine."""


def coefficient_rows(result: BuildResult, used: Iterable[str]) -> list[dict[str, object]]:
    """The coefficients on which the page's curves depend, in the order of a property file.

    Parameters
    ----------
    result : of the build
    used : parameters of the page's model
    """
    moved = {**beside_the_search(result.fit), **movers(result.fit)}
    names = set(used)
    rows = [row for row in TABLE if row.name in names and not unsettable(row.name)]
    return [_row(row, result.fit, moved.get(row.name, [])) for row in rows]


def movers(fitted: FitResult) -> dict[str, list[str]]:
    """By coefficient, the sweeps that determine it most, each in words with its share of the information.

    The share is that of the squared derivatives of the weighted residuals, all other numbers held.
    """
    search = fitted.search
    if search is None:
        return {}
    names = [number.name for number in search.numbers if number.name in BY_NAME]
    if not names:
        return {}
    sweeps, sweep_names = search.problem.points.sweep, search.problem.points.sweep_names
    by_channel, by_sweep = {}, np.zeros((len(sweep_names), len(names)))
    for channel, rows in _weighted_slopes(search, names).items():
        by_channel[CHANNELS[channel].ascii] = (rows**2).sum(axis=0)
        np.add.at(by_sweep, sweeps, rows**2)
    total = by_sweep.sum(axis=0)
    return {
        name: [
            *_most({channel: found[k] / total[k] for channel, found in by_channel.items()}),
            *_most(dict(zip(sweep_names, by_sweep[:, k] / total[k], strict=True))),
        ]
        for k, name in enumerate(names)
        if total[k] > 0.0
    }


def _most(shares: Mapping[str, float]) -> list[str]:
    """The largest shares that are not small, in words."""
    ordered = sorted(shares, key=lambda name: -shares[name])[:NAMED_IN_SENTENCE]
    return [
        f"{name} {100.0 * shares[name]:.0f} %" for name in ordered if shares[name] >= constants.LEAST_MOVER
    ]


def beside_the_search(fitted: FitResult) -> dict[str, list[str]]:
    """By coefficient that is fitted by itself, after the search, the channel that determines it, in words."""
    found = {row.name: row.channel for row in TABLE if row.channel in CHANNELS}
    found |= {name: "omega" if name in OF_WHEEL_SPEED else "RL" for name in fitted.radii.found}
    return {
        name: [CHANNELS[channel].ascii]
        for name, channel in found.items()
        if name in fitted.coefficients and fitted.coefficients[name].status == "fitted"
    }


def _weighted_slopes(search: Fitted, names: Sequence[str]) -> dict[str, np.ndarray]:
    """By channel, derivatives (n, k) of the residuals in units of the uncertainty; 0 where a reading is not used."""
    problem = search.problem
    _, slopes = problem.simulation.sensitivities(problem.points, names, problem.channels)
    out = {}
    for channel, sigma in problem.sigma.items():
        used = np.isfinite(sigma) & np.isfinite(problem.points.channel(channel))
        out[channel] = slopes[channel] * np.where(used, 1.0 / sigma, 0.0)[:, None]
    return out


def _row(row: Parameter, fitted: FitResult, moved: Sequence[str]) -> dict[str, object]:
    record = fitted.coefficients[row.name]
    value = float(fitted.tyre[row.name])
    lower, upper = record.bounds or row.bounds
    low, high = _reach(value, record, lower, upper)
    return {
        "name": row.name,
        "group": _title(row.section),
        "about": row.description,
        "unit": "" if row.unit == "-" else row.unit,
        "value": value,
        "stderr": record.stderr,
        "status": record.status,
        "found": record.status in FOUND or bool(record.by_hand),
        "at_bound": record.at_bound,
        "may_be_free": may_be_free(row),
        "bounds": [x if math.isfinite(x) else None for x in (lower, upper)],
        "divisor": row.divisor,
        "slider": [low, high],
        "moved_by": list(moved) if record.status in BY_THE_FIT else [],
        "partner": [record.correlated_with, record.correlation] if record.correlated_with else None,
    }


def _reach(value: float, record: Coefficient, lower: float, upper: float) -> tuple[float, float]:
    """Ends of the slider, within the bounds."""
    least = constants.SLIDER_LEAST * (1.0 + abs(value))
    reach = max(constants.SLIDER_REACH * (record.stderr or 0.0), least)
    return min(max(value - reach, lower), value), max(min(value + reach, upper), value)


def _title(section: str) -> str:
    """The section of a property file in words: ``Lateral``."""
    return section.removesuffix("_COEFFICIENTS").replace("_", " ").capitalize()
