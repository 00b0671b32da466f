"""The order of runs that plan offers: the same sweeps, and a temperature that no setting follows any more."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.fit.influences.confounding import correlation_ratio
from mffit.planning.order import mixed_order
from mffit.points import make_points

LOADS, PRESSURES, EACH = (600.0, 1400.0, 2200.0), (200e3, 250e3, 300e3), 12
NAMES = tuple(f"{p / 1e3:.0f}_{Fz:.0f}_{k}" for p in PRESSURES for Fz in LOADS for k in range(2))


def course(share: np.ndarray) -> np.ndarray:
    """Temperature [degC] after a share of the test."""
    return 25.0 + 30.0 * (1.0 - np.exp(-2.5 * share))


@pytest.fixture(scope="module")
def points():
    """One pressure after the other, while the tyre warms up."""
    Fz = np.repeat([Fz for _ in PRESSURES for Fz in LOADS for _ in range(2)], EACH)
    n = len(Fz)
    return make_points(
        np.tile(np.radians(np.linspace(-6.0, 6.0, EACH)), len(NAMES)),
        np.zeros(n),
        Fz,
        p=np.repeat(PRESSURES, n // 3),
        V=10.0,
        phi_t=0.0,
        T=course(np.arange(n) / n),
        sweep=np.repeat(np.arange(len(NAMES)), EACH),
        sweep_names=NAMES,
    )


def test_every_sweep_is_run_once(points):
    assert sorted(mixed_order(points).sweeps) == sorted(NAMES)


def test_in_the_new_order_no_setting_follows_the_temperature(points):
    """Run again in that order, the tyre warming up as before."""
    found = mixed_order(points)
    rows = np.concatenate([np.flatnonzero(points.sweep == NAMES.index(name)) for name in found.sweeps])
    again = points.select(rows).replace(T=course(np.arange(len(rows)) / len(rows)))
    assert correlation_ratio(points, "p") > 0.9
    assert found.now["pressure"] == pytest.approx(correlation_ratio(points, "p"), abs=0.05)
    for setting, channel in (("pressure", "p"), ("load", "Fz")):
        assert correlation_ratio(again, channel) < 0.2
        assert found.then[setting] == pytest.approx(correlation_ratio(again, channel), abs=0.1)


def test_the_order_is_the_same_every_time(points):
    assert mixed_order(points).sweeps == mixed_order(points).sweeps


def test_a_pressure_in_the_middle_of_the_test_runs_along_too(points):
    """A straight line over pressure would not show it."""
    middle = points.replace(p=np.where((points.p > 220e3) & (points.p < 280e3), 200e3, 250e3))
    T = 25.0 + 20.0 * np.exp(-(((np.arange(len(points)) / len(points) - 0.5) / 0.15) ** 2))
    assert correlation_ratio(middle.replace(T=T), "p") > 0.7
