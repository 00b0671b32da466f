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


def judged(
    scale: float = 1.0, r2: float = 1.0, u: float = 6.0, Fy=0.0, names=("a",), sweep=0
) -> tuple[str, ...]:
    """The sentences about a model whose misfit of Fy is given, beside a moment that fits."""
    n = np.size(Fy)
    points = make_points(
        0.0, 0.0, 1500.0, Fy=Fy, Mz=np.zeros(n), u_Fy=u, u_Mz=1.0, p=2e5, V=11.0, phi_t=0.0, sweep=sweep,
        sweep_names=names,
    )  # fmt: skip
    model = SimpleNamespace(Fy=np.zeros(n), Mz=np.zeros(n))
    return distrust(points, model, {"Fy": scale, "Mz": 1.0}, {"Fy": r2, "Mz": 1.0})


def test_a_misfit_of_twice_the_stated_noise_is_the_limit():
    assert judged(scale=1.99) == ()
    (said,) = judged(scale=2.01)
    assert "Fy" in said
    assert "2.0 times" in said


def test_a_misfit_is_compared_with_stated_noise_only():
    assert judged(scale=5.0, u=np.nan) == ()


def test_a_model_explains_half_of_the_variance_or_is_not_trusted():
    assert judged(r2=0.51) == ()
    (said,) = judged(r2=0.49)
    assert "49 %" in said
    assert "0 %" in judged(r2=-3.0)[0]


def test_the_three_sweeps_with_most_of_the_misfit_are_named_worst_first():
    """A sweep is named from one and a half times the misfit of all points on."""
    names = tuple("abcdefghijkl")

    def named(off: list[float]) -> str:
        (said,) = judged(3.0, Fy=np.array(off), u=1.0, names=names, sweep=np.arange(12))
        return said

    quiet = [1.0] * 8
    assert "most of it in d, c, b;" in named([6.0, 7.0, 8.0, 9.0, *quiet])
    # x / sqrt((x^2 + 11) / 12) is 1.5 at x = 1.593
    assert "most of it in a;" in named([1.60, *[1.0] * 11])
    assert "most of it" not in named([1.585, *[1.0] * 11])
