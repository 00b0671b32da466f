"""Formulae that save time, against the plain ones: bumps beside shared changes."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from mffit.diagnosis.bumps import bump_scan
from mffit.diagnosis.needs import possible, without
from mffit.diagnosis.noise import Noise, Scatter
from mffit.effects import CATALOG
from mffit.linearised.chained import Memory
from mffit.linearised.gaussian import Directions
from mffit.points import Points, make_points
from mffit.rig import Simulation
from mffit.rig_errors import T_REF

WARMTH = next(effect for effect in CATALOG if effect.id == "temperature")


def _points(n: int = 120) -> Points:
    rng = np.random.default_rng(3)
    return make_points(
        rng.uniform(-0.15, 0.15, n), rng.uniform(-0.1, 0.1, n), rng.choice([900.0, 1500.0], n), p=250e3, V=10.0,
        phi_t=0.0, T=rng.uniform(50.0, 70.0, n), Fy=rng.normal(0.0, 900.0, n), Mz=rng.normal(0.0, 20.0, n),
        sweep=np.repeat(np.arange(6), n // 6), sweep_names=tuple("abcdef"),
    )  # fmt: skip


@pytest.mark.parametrize("structured", [False, True])
def test_the_best_bump_is_that_of_whole_whitened_shapes(structured):
    points, rng = _points(), np.random.default_rng(5)
    n = len(points)
    u = np.repeat([5.0, 0.6], n)
    u[7] = np.inf
    noise = Noise(
        u=u,
        stated=u,
        chain=np.concatenate([points.sweep, points.sweep + 6]),
        origin=None,
        scatter={"Fy": Scatter(memory=Memory(0.6)), "Mz": Scatter()},
    ).sharing(rng.normal(0.0, 3.0, (2 * n, 6)))
    axes = np.linalg.qr(rng.normal(size=(2 * n - 1, 3)))[0]
    residual = rng.normal(0.0, 2.0, 2 * n - 1)
    inside = {name: np.linalg.qr(rng.normal(size=(n - (name == "Fy"), 4)))[0] for name in noise.channels}
    scan = bump_scan(points, noise, structure=inside)
    if structured:  # one scan serves whatever structure the covariance has
        noise = replace(noise, structure={"Mz": Directions(inside["Mz"], np.array([0.1, 1.0, 10.0, 1e3]))})
    found = scan.best(SimpleNamespace(axes=axes, residual=residual), noise)
    gains = []
    for name in noise.channels:
        nothing = np.zeros(scan.bumps.shape)
        columns = np.vstack([scan.bumps if one == name else nothing for one in noise.channels])
        shapes, spread = noise.whiten(columns), scan.spread[name]
        inside = axes.T @ shapes
        score = shapes.T @ residual - inside.T @ (axes.T @ residual)
        precision = np.sum(shapes**2, axis=0) - np.sum(inside**2, axis=0) + spread**-2
        tried = np.log(2 * len(scan.regions))
        gains.append(np.max(0.5 * score**2 / precision - 0.5 * np.log(precision * spread**2) - tried))
    assert found.gain == pytest.approx(max(gains), rel=1e-4)
    assert found.channel == noise.channels[int(np.argmax(gains))]


def test_a_misfit_that_is_left_counts_as_noise():
    n = 50
    u = np.repeat([5.0, 0.5], n)
    noise = Noise(u=u, stated=u, chain=np.zeros(2 * n, dtype=int), origin=None)
    wider = noise.at_least(np.concatenate([np.full(n, 20.0), np.full(n, 0.1)]))
    assert wider.typical("Fy") == pytest.approx(20.0)
    assert wider.typical("Mz") == pytest.approx(0.5)
    assert wider.scatter["Fy"].scale == pytest.approx(4.0)


def test_the_model_holds_at_a_temperature_of_the_data():
    points = _points()
    start = Simulation({}, turn_slip=True)
    (warm,), _ = possible([WARMTH], points, start)
    (held_at,) = (free for free in warm.free if free.name == T_REF)
    assert held_at.lower == points.T.min()
    assert held_at.upper == points.T.max()
    assert held_at.spread == pytest.approx(np.std(points.T))
    assert without(warm, T_REF).parameters == ("k_T_per_K",)
    assert replace(warm, free=WARMTH.free) == WARMTH
