"""An error that the formula makes in all sweeps of a kind is no fault of one of them."""

from __future__ import annotations

import numpy as np
from scipy.special import ndtr

from mffit.points import make_points
from mffit.suspicion import constants
from mffit.suspicion.groups import alike, groups
from mffit.suspicion.others import _usual

RARE = float(ndtr(-constants.DOUBTFUL_SIGMA))


def test_an_error_counts_only_beyond_those_of_other_sweeps():
    """Relative errors of 1 %, once more than twice that of the others, and a gain of 6 % among errors of 0.5 %."""
    assert _usual([0.02, 0.006, 0.008]) > 100.0 * RARE
    assert _usual([0.06, *np.full(8, 0.005)]) < RARE
    assert _usual([0.06, *np.zeros(2)]) == 0.0  # the others follow the formula
    assert _usual([0.06]) == _usual([0.0, 0.0]) == 1.0  # no other sweep shares its kind; no error


def test_the_threshold_rises_as_fewer_sweeps_tell_what_is_usual():
    chances = [_usual([0.03, *np.full(n, 0.005)]) for n in (1, 2, 5, 10)]
    assert chances == sorted(chances, reverse=True)


def test_slip_sweeps_are_compared_with_those_at_the_same_angles():
    """Sideslip at two cambers, slip straight on, under sideslip of both signs, and under one that no other sweep has."""
    held = [(0.0, 0.0), (0.0, 0.0), (4.0, 0.0), (-4.0, 0.0), (2.0, 0.0), (0.0, 4.0)]
    slip, angle = np.linspace(-0.2, 0.2, 9), np.radians(np.linspace(-8.0, 8.0, 9))
    zero = np.zeros(9)
    alpha = np.concatenate([angle, angle, *(np.full(9, np.radians(a)) for a, _ in held)])
    gamma = np.concatenate([zero, zero + np.radians(4.0), *(np.full(9, np.radians(g)) for _, g in held)])
    kappa = np.concatenate([zero, zero, *(slip for _ in held)])
    sweep = np.repeat(np.arange(8), 9)
    points = make_points(alpha, gamma, 4000.0, kappa=kappa, p=250e3, V=16.0, phi_t=0.0).replace(
        sweep=sweep, sweep_names=tuple(f"run{k}" for k in range(8)), Fy=-10.0 * alpha, Mz=alpha
    )
    found = groups(points)
    partners = {one.name: [other.name for other in alike(points, one, found)] for one in found}
    assert partners["run0"] == ["run1"]
    assert partners["run2"] == ["run3"]
    assert partners["run4"] == ["run5"]
    assert partners["run6"] == partners["run7"] == []
