"""The published procedure as it is printed, by hand, and the steps from it to what this program measures."""

from __future__ import annotations

import math

import pytest
from plain_tyre import R_E, U_R, U_R_E, Plain, R, settings

from mffit.measured import measure
from mffit.parts import split

LOAD, PLAY_DEG, ANGLE = 1500.0, 0.2, math.radians(15.0)
PAPER = {
    "u_loadcell_offset_N": 10.0,
    "u_camber_alignment_deg": 0.5,
    "u_slip_alignment_N": 25.0,
    "backlash_deg": PLAY_DEG,
}


def found(tyre, **settings_of_rig):
    points = tyre.campaign()
    return measure(settings(**PAPER, **settings_of_rig), points, split(points))


@pytest.mark.parametrize("off_deg", [0.0, 0.1])
def test_the_published_procedure_is_that_of_the_paper(off_deg):
    """Play falsifies its secant by C_alpha b/2 over the angle, and is taken off its force; (6) removes a misalignment.

    Its budget is (24), whatever else is declared, and both directions do not make it smaller.
    """
    tyre = Plain(play=math.radians(PLAY_DEG), alpha_0=math.radians(off_deg))
    C_alpha = -tyre.cornering * LOAD
    secant = -tyre.camber * LOAD + C_alpha * 0.5 * tyre.play / ANGLE
    force = tyre.turn_slip_force(LOAD)
    epsilon = 1.0 - R_E * secant / (R * force)
    u_F = math.hypot(10.0, math.radians(0.5) * secant, 25.0)
    got = found(tyre, u_conicity=0.01, u_Fy_gain=0.02).published
    assert got.F_phit.value == pytest.approx(force, abs=1.0)
    assert got.C_gamma == pytest.approx(secant, rel=0.002)
    assert got.epsilon_gamma.value == pytest.approx(epsilon, abs=0.005)
    assert got.F_phit.u == pytest.approx(u_F, rel=1e-3)
    # r_e is given here, so that R stands in C_phit alone.
    of_radii = math.hypot(U_R / R, U_R_E / R_E)
    assert got.epsilon_gamma.u == pytest.approx((1.0 - epsilon) * math.hypot(u_F / force, of_radii), rel=0.01)


def test_the_corrections_lead_from_the_paper_to_the_result():
    """Play is the one error of this rig: it is the one large step, in newtons at the angle of the secant."""
    tyre = Plain(play=math.radians(PLAY_DEG))
    result = found(tyre)
    steps = {row.what: row for row in result.published.corrections}
    (play,) = [row for what, row in steps.items() if "play" in what]
    assert play.change == pytest.approx(0.5 * tyre.cornering * LOAD * tyre.play, rel=0.02)
    assert all(abs(row.change) < 2.0 for row in steps.values() if row is not play)
    last = result.published.corrections[-1]
    assert last.epsilon_gamma == pytest.approx(result.epsilon_gamma.value, abs=1e-9)
    assert last.epsilon_gamma == pytest.approx(tyre.epsilon, abs=0.01)


def test_there_is_no_published_procedure_without_its_angle():
    points = Plain().campaign()
    short = points.select(abs(points.gamma) < math.radians(11.0))
    assert measure(settings(), short, split(short)).published is None
