"""A tyre that drifts between sweeps without a recorded temperature: repeated conditions show it, and eps_gamma is corrected."""

from __future__ import annotations

import numpy as np
import pytest
from plain_tyre import NEWTON, Plain, settings

from mffit.measured import measure
from mffit.measured.drift import shares_of_sweeps
from mffit.parts import split
from mffit.points import make_points
from mffit.suspicion.trust import JudgedMeasurement, judge

LOADS = (1000.0, 1500.0, 2000.0)


def measured(shares=(), *, zeros=(), seed=1, T=None, noise=NEWTON, u_Fy=NEWTON):
    """The plain tyre with noise, its forces larger by ``shares`` and its load cell off by ``zeros`` [N] in the first sweeps."""
    points = Plain().campaign(LOADS, backward_camber=(1500.0,), u_Fy=u_Fy)
    grown, off = np.zeros(5), np.zeros(5)
    grown[: len(shares)], off[: len(zeros)] = shares, zeros
    rng = np.random.default_rng(seed)
    Fy = points.Fy * (1.0 + grown[points.sweep]) + off[points.sweep] + noise * rng.normal(size=len(points))
    points = points.replace(Fy=Fy, **({} if T is None else {"T": T[points.sweep]}))
    return measure(settings(), points, split(points)), points


def said(found, points):
    return judge(JudgedMeasurement(points=points, nominal=found.nominal, drift=found.drift)).doubts


def contribution(found):
    return next((row.contribution for row in found.budget if row.source == "drift between sweeps"), 0.0)


@pytest.mark.parametrize("share", [-0.08, 0.08])
def test_camber_sweeps_of_another_state_are_brought_to_that_of_the_zeros(share):
    """Their forces are off by 8 %; eps_gamma would be by 0.08 (1 - eps) = 0.09."""
    sound = measured()[0].epsilon_gamma
    found, points = measured([0.0, share, 0.0, 0.0, share])
    assert found.epsilon_gamma.value - sound.value == pytest.approx(0.0, abs=2.0 * contribution(found))
    assert contribution(found) < 0.03
    (sentence,) = said(found, points)
    assert "record T_degC" in sentence
    assert "camber" in sentence
    assert found.drift.apart == pytest.approx(0.08, abs=0.02)


def test_the_stated_uncertainty_is_that_of_the_zeros_that_were_repeated():
    """Over noise, the corrected eps_gamma scatters about the tyre's by no more; its zeros share some of the noise."""
    errors = []
    for seed in range(8):
        found, _ = measured([0.02, -0.12, 0.01, 0.01, -0.12], seed=seed)
        errors.append((found.epsilon_gamma.value - Plain().epsilon) / contribution(found))
    assert np.std(errors) < 1.5
    assert abs(np.mean(errors)) < 1.0


def test_sound_sweeps_show_no_drift():
    alarms = [
        found.drift is not None and found.drift.counts
        for found, _ in (measured(seed=seed) for seed in range(8))
    ]
    assert sum(alarms) == 0


def test_a_load_cell_that_was_zeroed_anew_is_no_drift():
    """Its force is the same at every load and camber, which a share of the force is not."""
    found, points = measured(zeros=[0.0, 30.0, -30.0, 20.0, -10.0])
    assert said(found, points) == ()
    assert contribution(found) == 0.0


def test_a_known_temperature_leaves_the_drift_to_its_terms():
    warm = [0.0, -0.08, 0.0, 0.0, -0.08]
    found, points = measured(warm, T=np.array([30.0, 50.0, 30.0, 30.0, 50.0]))
    assert found.drift is None
    assert said(found, points) == ()
    same, points = measured(warm, T=np.full(5, 30.0))
    assert said(same, points)


def test_a_drift_below_what_every_slope_is_uncertain_by_is_not_said():
    """0.4 % between readings without noise: certain, and without consequence."""
    found, points = measured([0.0, -0.004, 0.0, 0.0, -0.004], noise=0.0, u_Fy=0.1)
    assert found.drift.chance < 1e-3
    assert said(found, points) == ()
    assert contribution(found) == 0.0


def repeats(factor, *, sweeps=2, noise=0.0, seed=1):
    """Sweeps over the same cambers at loads up to 1 % apart, with forces that grow with the load.

    The forces of every second sweep are larger by ``factor``, too.
    """
    gamma = np.radians(np.tile(np.repeat([-20.0, 0.0, 25.0], 4), sweeps))
    sweep, Fz = np.repeat(np.arange(sweeps), 12), np.repeat(np.linspace(1500.0, 1515.0, sweeps), 12)
    points = make_points(
        0.0, gamma, Fz, p=250e3, V=6.0, phi_t=-0.75, sweep=sweep, sweep_names=[f"r{k}" for k in range(sweeps)]
    )
    Fy = 0.9 * Fz * gamma * np.where(sweep % 2, factor, 1.0)
    Fy = Fy + noise * np.random.default_rng(seed).standard_normal(len(Fy))
    return shares_of_sweeps(points.replace(Fy=Fy, u_Fy=np.full(len(Fy), noise or 0.1)))


def test_a_force_that_grows_with_the_load_is_no_drift():
    assert repeats(1.0).drift.apart == pytest.approx(0.0, abs=1e-4)
    assert repeats(1.03).drift.apart == pytest.approx(0.03, rel=0.02)


def test_chance_is_how_often_sound_sweeps_show_as_much():
    """Without drift the most likely scatter is often none, whose chance is a half, and small chances are as rare as they say.

    A little rarer: where zeros that shift explain the readings better, nothing is said.
    """
    found = [repeats(1.0, sweeps=10, noise=5.0, seed=k) for k in range(150)]
    chances = np.array([0.5 if one is None else one.drift.chance for one in found])
    assert max(chances) == pytest.approx(0.5, abs=0.01)
    assert 0.1 < np.mean(chances < 0.2) < 0.25
