"""What a loose sideslip axis does to a reading, and how much of it stays in doubt."""

from __future__ import annotations

import numpy as np
import pytest
from plain_tyre import DEGREE, Plain, R, settings

from mffit import config as configuration
from mffit.measured import measure
from mffit.measured.evidence import backlash_corrected, backlash_shift, odd_alpha
from mffit.parts import split
from mffit.pipeline.inputs import read_base, read_points
from mffit.points import make_points

PLAY = 0.2 * DEGREE


def test_a_plain_moment_turns_the_wheel_to_the_end_of_the_play():
    """A positive moment (ISO-W, about z upwards) turns the wheel to smaller sideslip."""
    shift, u = backlash_shift(np.array([30.0, -30.0]), np.array([0.5, 0.5]), PLAY)
    assert shift == pytest.approx([-PLAY / 2.0, PLAY / 2.0])
    assert u == pytest.approx([0.0, 0.0], abs=1e-9)


@pytest.mark.parametrize("Mz", [0.0, 0.3, -0.7, 1.5])
def test_a_moment_in_its_noise_leaves_the_side_to_chance(Mz):
    """Mean and scatter of the shift over moments drawn with the noise, their signs taken one by one."""
    drawn = -0.5 * PLAY * np.sign(np.random.default_rng(3).normal(Mz, 0.6, 200_000))
    for u_Mz in (0.6, np.nan):  # 0.6 Nm stands in where no uncertainty is stated
        shift, u = backlash_shift(np.array([Mz]), np.array([u_Mz]), PLAY)
        assert shift[0] == pytest.approx(drawn.mean(), abs=0.005 * PLAY)
        assert u[0] == pytest.approx(drawn.std(), abs=0.005 * PLAY)


def test_the_side_in_doubt_is_a_doubt_about_the_force():
    """Half the play at the cornering stiffness of a motorcycle tyre, 8 to 15 per rad of the load."""
    points = make_points(
        0.0, 0.0, [1000.0, 2000.0], p=250e3, V=6.0, phi_t=-1 / R, Fy=0.0, Mz=0.0, u_Fy=3.0, u_Mz=0.6
    )
    found = backlash_corrected(points, settings(backlash_deg=0.2))
    half = 0.1 * DEGREE * points.Fz
    assert np.all(found.u_Fy > np.hypot(3.0, 8.0 * half))
    assert np.all(found.u_Fy < np.hypot(3.0, 15.0 * half))
    sure = backlash_corrected(points.replace(Mz=20.0), settings(backlash_deg=0.2))
    assert sure.u_Fy == pytest.approx([3.0, 3.0])
    assert sure.alpha == pytest.approx(-0.1 * DEGREE)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_points_without_moment_lie_at_the_side_of_the_spin_moment(side):
    """The spin of the path twists the tyre with the sign of phi_t, and the other way when it rolls backwards."""
    points = make_points(0.0, 0.0, 1500.0, p=250e3, V=6.0, phi_t=side / R, Fy=0.0, direction=[1, -1])
    found = backlash_corrected(points, settings(backlash_deg=0.2))
    assert found.alpha == pytest.approx(-0.1 * DEGREE * side * np.array([1.0, -1.0]))


def test_an_axis_without_play_reads_the_angle():
    tyre = Plain()
    points = tyre.campaign()
    assert backlash_corrected(points, settings()) is points
    assert odd_alpha(points, split(points), settings()) is points.alpha


def test_the_odd_part_belongs_to_half_the_difference_of_the_true_angles():
    tyre = Plain(play=0.4 * DEGREE)
    points = tyre.campaign()
    parts = split(points)
    found = odd_alpha(points, parts, settings(backlash_deg=0.4))
    _, Mz = tyre.readings(points.alpha, points.gamma, points.Fz, points.direction)
    _, mirror = tyre.readings(-points.alpha, -points.gamma, points.Fz, points.direction)
    true = points.alpha - 0.2 * DEGREE * np.sign(Mz), -points.alpha - 0.2 * DEGREE * np.sign(mirror)
    plain = np.minimum(np.abs(Mz), np.abs(mirror)) > 1.5  # five times its noise
    assert plain.sum() > 20
    assert np.any(np.abs(true[0] - points.alpha)[plain] > 0.0)
    assert found[plain] == pytest.approx(((true[0] - true[1]) / 2.0)[plain], abs=1e-6)


def test_without_a_sideslip_sweep_play_and_skew_are_corrected_by_the_usual_stiffness():
    """The sample's eps_gamma moves by less than the usual stiffness is said to leave in doubt, and skew stays in the budget."""
    config = configuration.load("samples/front-120-70/tyre.toml")
    points = read_points(config).points
    rest = points.select(points.file != points.files.index("sideslip_1400N.csv"))
    every, fewer = (measure(config, some, split(some), read_base(config)) for some in (points, rest))
    assert fewer.C_alpha is None
    doubt = {row.source: row.contribution for row in fewer.budget}
    moved = abs(fewer.epsilon_gamma.value - every.epsilon_gamma.value)
    assert 0.005 < moved < doubt["usual cornering stiffness"]
    assert doubt["camber skew"] > 0.01
    assert fewer.epsilon_gamma.u > every.epsilon_gamma.u
    assert [one for one in fewer.warnings if "1400 N gives C_alpha" in one]
    assert not [one for one in every.warnings if "gives C_alpha" in one]


def test_on_a_straight_path_nothing_is_said_of_eps_gamma():
    config = configuration.load("samples/flat-track/tyre.toml")
    points = read_points(config).points
    rest = points.select((points.gamma != 0.0) | (points.alpha == 0.0))
    found = measure(config, rest, split(rest), read_base(config))
    assert found.C_alpha is None
    assert found.C_gamma is not None
    assert not [one for one in found.warnings if "gives C_alpha" in one]
