"""The coefficients of a build for a page: value, uncertainty, reach of the slider, and the sweeps that determine them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np

from mffit.config.by_hand import may_be_free, unsettable
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
    information = {channel: rows**2 for channel, rows in _weighted_slopes(search, names).items()}
    whole = sum(information.values())
    sweeps = search.problem.points.sweep
    by_sweep = np.zeros((sweeps.max(initial=0) + 1, len(names)))
    np.add.at(by_sweep, sweeps, whole)
    total = by_sweep.sum(axis=0)
    out = {}
    for k, name in enumerate(names):
        if not total[k] > 0.0:
            continue
        share = by_sweep[:, k] / total[k]
        most = [j for j in np.argsort(-share)[: constants.MOVERS_SHOWN] if share[j] >= constants.LEAST_MOVER]
        words = [f"{search.problem.points.sweep_names[j]} {100.0 * share[j]:.0f} %" for j in most]
        channels = {c: float(information[c][:, k].sum() / total[k]) for c in information}
        out[name] = [*_channels(channels), *words]
    return out


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


def _channels(shares: dict[str, float]) -> list[str]:
    """The channels in words, the largest first."""
    ordered = sorted(shares, key=lambda name: -shares[name])
    return [
        f"{CHANNELS[c].ascii} {100.0 * shares[c]:.0f} %"
        for c in ordered
        if shares[c] >= constants.LEAST_MOVER
    ]


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
