"""What is uncertain of the given model and of the rig: numbers with priors, estimated together with the effects."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from scipy.linalg import block_diag

from mffit.fit.priors import scatter
from mffit.numbers import Numbers
from mffit.points import Points
from mffit.quantities import SIDEWAYS
from mffit.rig import Simulation
from tir import Tyre
from tir.parameters import TABLE


def slopes_of(state: Simulation, points: Points, names: Sequence[str], channels: Iterable[str]) -> np.ndarray:
    """Derivatives of the readings (c n, k) of a simulation by the named numbers; 0 where they are undefined."""
    if not names:
        return np.zeros((len(tuple(channels)) * len(points), 0))
    return np.nan_to_num(state.sensitivities(points, names, channels)[1].stacked)


def columns_of(
    numbers: Numbers, state: Simulation, points: Points, channels: Iterable[str] = SIDEWAYS
) -> np.ndarray:
    """Changes of the readings (c n, k) by one standard deviation each of independent combinations of the numbers."""
    return slopes_of(state, points, numbers.names, channels) @ numbers.root


def spread_of(numbers: Numbers, state: Simulation, points: Points, channels: Sequence[str]) -> np.ndarray:
    """Standard deviation (c n,) of the readings at a simulation by the prior of these numbers."""
    return np.asarray(np.sqrt(np.sum(columns_of(numbers, state, points, channels) ** 2, axis=1)))


def known_around(values: Mapping[str, float], u: Iterable[float]) -> Numbers:
    """Independent numbers with their values as prior means, and their standard uncertainties."""
    at = np.array([*values.values()], dtype=float)
    return Numbers.beforehand(tuple(values), at, at, np.array([*u], dtype=float))


EXACT = known_around({}, ())


def declared(tyre: Tyre, u_coefficients: float) -> Numbers:
    """Independent relative errors of every nonzero lateral and aligning coefficient of a file."""
    if u_coefficients <= 0.0:
        return EXACT
    values = {row.name: float(tyre[row.name]) for row in TABLE if row.normal_mode and float(tyre[row.name])}
    return known_around(values, [u_coefficients * abs(value) for value in values.values()])


def together(known: Numbers, others: Numbers) -> Numbers:
    """Numbers of two priors that are independent of each other."""

    def both(key: str) -> np.ndarray:
        return np.concatenate([getattr(known, key), getattr(others, key)])

    information = block_diag(known.information, others.information)
    names = (*known.names, *others.names)
    return Numbers(names, both("values"), information, both("score"), both("expected"), both("spread"))


def with_rig(known: Numbers, priors: Mapping[str, tuple[float, float]], names: Sequence[str]) -> Numbers:
    """The prior with the named numbers of the rig added; ``priors`` has the value and standard uncertainty of each."""
    return together(known, known_around({n: priors[n][0] for n in names}, [priors[n][1] for n in names]))


def refitted(tyre: Tyre, *, curved: bool, stated: Mapping[str, float] | None = None) -> Numbers:
    """The coefficients that a build fitted, with the scatter of similar tyres or the ``stated`` one as prior.

    For points that the build already used: the posterior of the build would count them twice.
    """
    fitted = [row.name for row in TABLE if row.kind == "number" and "+-" in tyre.status.get(row.name, "")]
    spread = {n: scatter(n, float(tyre[n]), from_base=True, curved=curved) for n in fitted}
    spread |= {n: u for n, u in (stated or {}).items() if n in spread}
    known = {n: u for n, u in spread.items() if np.isfinite(u) and u > 0.0}
    return known_around({n: float(tyre[n]) for n in known}, known.values())
