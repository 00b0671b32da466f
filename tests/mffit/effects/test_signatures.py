"""What each cause leaves in the readings: odd or even, reversed by the direction of rolling or by the mount.

The expected behaviour is that of a rig: a table of causes against symmetries, derived from geometry.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import tir
from mffit.points import make_points
from mffit.rig import Simulation
from mffit.rig_errors import Faults

TYRE = tir.read(Path(__file__).parents[3] / "samples" / "front-120-70" / "true.tir")
ANGLES = np.radians([-6.0, -3.0, -1.0, 0.0, 1.0, 3.0, 6.0])
PLAIN = TYRE.replace(
    **dict.fromkeys(("PHY1", "PHY2", "PVY1", "PVY2", "PEY3", "QDZ6", "QDZ7", "QHZ1", "QHZ2", "PKY3"), 0.0)
)
"""A tyre without plies, conicity or asymmetry; nor PKY3, whose |gamma| is even and odd at once for a small lean."""


def change(numbers, *, alpha=ANGLES, gamma=0.0, phi_t=0.0, channel="Fy", load=1500.0, **conditions):
    """What the numbers change in a channel, (n,), of a plain tyre."""
    points = make_points(alpha, gamma, load, p=250e3, V=6.0, phi_t=phi_t, **conditions)
    start = Simulation(dict(PLAIN.values), Faults(), bool(phi_t), False)
    after = start.with_numbers(numbers).predict(points) - start.predict(points)
    n = len(points)
    return after[:n] if channel == "Fy" else after[n:]


@pytest.mark.parametrize(
    "numbers",
    [
        {"alpha_0_deg": 0.2},
        {"PHY1": 0.002},
        {"gamma_0_deg": 0.5},
        {"F0_N": 9.0},
        {"crosstalk": 0.01},
        {"PVY1": 0.01},
    ],
    ids=lambda numbers: next(iter(numbers)),
)
def test_offsets_are_even_to_first_order(numbers):
    half = {name: value * 1e-3 for name, value in numbers.items()}
    even = change(half)
    assert even == pytest.approx(even[::-1], rel=2e-2)
    assert np.any(even)


@pytest.mark.parametrize(
    "numbers", [{"PDY2": -0.1}, {"PKY2": 1.8}, {"gain": 1.03}, {"PDYP1": 0.4}], ids=lambda n: next(iter(n))
)
def test_effects_on_shape_are_odd_without_a_path(numbers):
    odd = change(numbers)
    assert odd == pytest.approx(-odd[::-1], abs=1e-6)


@pytest.mark.parametrize(
    ("numbers", "sign"),
    [
        ({"alpha_0_deg": 0.2}, -1.0),
        ({"PHY1": 0.002}, -1.0),
        ({"PVY1": 0.01}, 1.0),
        ({"gamma_0_deg": 0.5}, 1.0),
        ({"F0_N": 9.0}, 1.0),
        ({"crosstalk": 0.01}, 1.0),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_force_at_zero_turns_with_the_direction_of_rolling_or_not(numbers, sign):
    forward = change(numbers, alpha=0.0)
    backward = change(numbers, alpha=0.0, direction=-1)
    assert backward == pytest.approx(sign * forward, rel=1e-6)


@pytest.mark.parametrize(
    ("numbers", "channel", "sign"),
    [
        ({"PHY1": 0.002}, "Fy", 1.0),
        ({"PVY1": 0.01}, "Fy", -1.0),
        ({"QDZ6": 0.003}, "Mz", -1.0),
        ({"M0_Nm": 1.0}, "Mz", 1.0),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_mount_tells_conicity_from_offsets(numbers, channel, sign):
    normal = change(numbers, alpha=0.0, channel=channel)
    flipped = change(numbers, alpha=0.0, channel=channel, mount=-1)
    assert flipped == pytest.approx(sign * normal, rel=1e-3)


def test_offset_does_not_know_the_load_and_crosstalk_does():
    offset = [change({"F0_N": 9.0}, load=load)[0] for load in (800.0, 2400.0)]
    crosstalk = [change({"crosstalk": 0.01}, load=load)[0] for load in (800.0, 2400.0)]
    assert offset == pytest.approx([9.0, 9.0])
    assert crosstalk == pytest.approx([8.0, 24.0])


def test_the_path_pushes_outwards_and_a_larger_radius_less():
    force = change({}, alpha=0.0, phi_t=-1 / 1.3)
    assert force == pytest.approx(0.0)
    less = change({"path_radius_m": 1.6}, alpha=0.0, phi_t=-1 / 1.3)
    assert less > 0.0  # centre at the left: turn slip makes Fy < 0, and less of it is a gain


@pytest.mark.parametrize("channel", ["Fy", "Mz"])
@pytest.mark.parametrize(
    ("numbers", "conditions", "share"),
    [
        ({"k_T_per_K": 0.002}, {"T": 45.0}, 0.04),
        ({"k_T_per_K": 0.002}, {"T": 25.0}, 0.0),
        ({"k_t_per_s": 1e-4}, {"t": 300.0}, 0.03),
    ],
)
def test_environment_scales_both_channels(channel, numbers, conditions, share):
    points = make_points(ANGLES, 0.0, 1500.0, p=250e3, V=6.0, phi_t=0.0)
    whole = Simulation(dict(PLAIN.values), Faults(), False, False).predict(points)
    whole = whole[: len(points)] if channel == "Fy" else whole[len(points) :]
    assert np.max(np.abs(whole)) > 1.0
    assert change(numbers, channel=channel, **conditions) == pytest.approx(share * whole, rel=1e-9)


def test_play_is_taken_up_against_the_moment():
    alpha = np.radians([-2.0, 2.0])
    play, half_degree = change({"backlash_deg": 0.1}, alpha=alpha), change({"alpha_0_deg": 0.05}, alpha=alpha)
    # dMz/dalpha > 0: a positive angle has a positive moment, which turns the wheel back by half the play
    assert play[1] == pytest.approx(-half_degree[1], rel=0.05)
    assert play[0] == pytest.approx(half_degree[0], rel=0.05)
