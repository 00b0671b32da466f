"""A file whose model explains little of a channel is not to be trusted, with and without a stated noise."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from mffit.fit.agreement import agreement
from mffit.points import make_points
from mffit.suspicion import distrust

RNG = np.random.default_rng(3)
ALPHA = np.linspace(-0.1, 0.1, 40)


def reasons(Mz: np.ndarray, model: np.ndarray) -> tuple[str, ...]:
    Fy = -1e4 * ALPHA
    points = make_points(ALPHA, 0.0, 1500.0, Fy=Fy, Mz=Mz, p=2e5, V=11.0, phi_t=0.0)
    readings = SimpleNamespace(Fy=Fy, Mz=model)
    r2 = {name: agreement(getattr(readings, name), getattr(points, name)).r2 for name in ("Fy", "Mz")}
    return distrust(points, readings, {"Fy": 1.0, "Mz": 1.0}, r2)


def test_a_moment_that_the_model_does_not_follow_is_reported_with_its_share():
    trail = 30.0 * np.sin(30.0 * ALPHA)
    assert reasons(trail + RNG.normal(0.0, 2.0, 40), trail) == ()
    (said,) = reasons(trail + RNG.normal(0.0, 90.0, 40), trail)
    assert "not to be trusted" in said
    assert "of the variance of Mz" in said


def test_a_channel_that_was_not_measured_causes_no_distrust():
    assert reasons(np.full(40, np.nan), np.zeros(40)) == ()
