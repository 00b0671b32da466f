"""Correlation of the tyre's temperature with settings of the test plan, and how much it widens the uncertainties."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mffit.fit import constants
from mffit.fit.fitted import Fitted
from mffit.fit.influences.nuisances import NUISANCES, TEMPERATURE
from mffit.least_squares import inverse
from mffit.points import Points, levels
from tir.parameters import BY_NAME

SETTINGS: Mapping[str, tuple[str, frozenset[str]]] = {
    "load": ("Fz", frozenset({"loads"})),
    "camber": ("gamma", frozenset({"camber", "coupled"})),
    "pressure": ("p", frozenset({"pressures", "pressure_loads"})),
}
"""By setting in words, its channel of the points, and the needs of coefficients that it determines."""
LEVELS = {"Fz": levels.LOAD, "gamma": levels.CAMBER, "p": levels.PRESSURE}


@dataclass(frozen=True, slots=True)
class Confounding:
    """Temperature and a setting that run along with each other."""

    setting: str  #: load, camber or pressure
    correlation: float  #: correlation ratio of temperature and setting, 0 to 1
    coefficient: str  #: the one that suffers most
    growth: float  #: its standard uncertainty over that if the temperature terms were known


def confoundings(fitted: Fitted) -> tuple[Confounding, ...]:
    """Settings with which the temperature runs along so much that coefficients become uncertain.

    ``fitted`` may model the temperature or not; both cases are computed with its terms free.
    """
    points = fitted.problem.points
    nuisance = next(n for n in NUISANCES if n.id == TEMPERATURE)
    if nuisance.lacking(points):
        return ()
    along = {setting: correlation_ratio(points, channel) for setting, (channel, _) in SETTINGS.items()}
    along = {setting: r for setting, r in along.items() if r > constants.RUNS_ALONG}
    if not along:
        return ()
    growth = _growth(fitted, nuisance.numbers)
    out = []
    for setting, r in along.items():
        needs = SETTINGS[setting][1]
        own = [name for name in growth if needs & {need.word for need in BY_NAME[name].needs}]
        worst = max(own, key=lambda name: growth[name], default=None)
        if worst is not None and growth[worst] > constants.WIDER_BANDS:
            out.append(Confounding(setting, r, worst, growth[worst]))
    return tuple(out)


def correlation_ratio(points: Points, channel: str) -> float:
    """Share of the scatter of the temperature that differences between the levels of a setting make, as a correlation.

    It also shows a temperature that is highest at the middle one of three pressures.
    """
    label = levels.nearest_labels(np.abs(getattr(points, channel)), LEVELS[channel])
    T = points.T
    means = {k: float(np.mean(T[label == k])) for k in np.unique(label)}
    between = np.array([means[k] for k in label])
    total = float(np.var(T))
    return float(np.sqrt(np.var(between) / total)) if total > 0.0 else 0.0


def _growth(fitted: Fitted, terms: Sequence[str]) -> dict[str, float]:
    """By coefficient, its standard uncertainty with the temperature terms free over that with known ones."""
    problem = fitted.problem
    free = [n for n in fitted.numbers if n.name not in terms]
    names = [*(n.name for n in free), *terms]
    slope = problem.free(names).linear(np.array([problem.value(name) for name in names])).slope
    information = slope.T @ slope + np.diag([*(n.spread**-2.0 for n in free), *(0.0 for _ in terms)])
    count = len(free)
    known, unknown = inverse(information[:count, :count]), inverse(information)
    ratio = np.sqrt(np.diag(unknown)[:count] / np.diag(known))
    return {
        n.name: float(r)
        for n, r in zip(free, ratio, strict=True)
        if n.name in fitted.values and n.name not in fitted.regularised
    }


def confounding_sentence(found: Confounding, *, modelled: bool) -> str:
    """What runs along, what it costs and what to do."""
    growth = f"{found.coefficient} {found.growth:.1f} times as uncertain as at one temperature"
    effect = (
        f"this makes {growth}"
        if modelled
        else f"the coefficients may contain the warming, and temperature terms would make {growth}"
    )
    return (
        f"the tyre's temperature runs along with the {found.setting} in the order of the runs (correlation "
        f"{found.correlation:.2f}): {effect}; repeat one {found.setting} warm and cold, or mix the order of the runs"
    )
