"""The coefficients of a build for a page: value, uncertainty, and reach of the slider."""

from __future__ import annotations

import math
from collections.abc import Iterable

from mffit.config.by_hand import may_be_free, unsettable
from mffit.fit import Coefficient, FitResult
from mffit.results import BuildResult
from mffit.viewer import constants
from tir.parameters import TABLE, Parameter

FOUND = frozenset({"fitted", "regularised", "measured"})
"""Status of coefficients that the data determine."""


def coefficient_rows(result: BuildResult, used: Iterable[str]) -> list[dict[str, object]]:
    """The coefficients on which the page's curves depend (``used`` by its model), in the order of a property file."""
    names = set(used)
    rows = [row for row in TABLE if row.name in names and not unsettable(row.name)]
    return [_row(row, result.fit) for row in rows]


def _row(row: Parameter, fitted: FitResult) -> dict[str, object]:
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
