"""(6)-(10): the steering correction from zeros rolled both ways, step by step, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.errors import InputError
from mffit.measured import align
from mffit.points import make_points

TURN_SLIP = -300.0  # N


def zeros(*steps, Fz=1500.0):
    """Forward and backward zeros of an axis that is off by each of the angles [deg]; 11 N per kN and rad of stiffness."""
    rows = []
    for iteration, off in enumerate(steps, start=1):
        slip = -11.0 * Fz * np.radians(off)
        rows += [(TURN_SLIP + slip, 1, iteration, Fz), (TURN_SLIP - slip, -1, iteration, Fz)]
    Fy, direction, iteration, load = np.array(rows).T
    return make_points(
        0.0,
        0.0,
        load,
        p=250e3,
        V=6.0,
        phi_t=-0.76,
        Fy=Fy,
        direction=direction.astype(int),
        iteration=iteration,
    )


def test_forces_of_both_directions_give_turn_slip_and_slip():
    (step,) = align(zeros(0.5)).steps
    assert step.F_turn_slip == pytest.approx(TURN_SLIP)
    assert step.F_slip == pytest.approx(-11.0 * 1500.0 * np.radians(0.5))
    assert step.F_forward - step.F_backward == pytest.approx(2.0 * step.F_slip)
    assert (step.load, step.iteration, step.secant) == (1500.0, 1, False)


def test_the_first_step_guesses_ten_and_corrects_against_the_misalignment():
    """C_alpha = 10 Fz where it is 11 Fz: the correction is a tenth too large and of the other sign."""
    found = align(zeros(0.5))
    assert found.steps[0].C_alpha == -10.0 * 1500.0
    assert found.correction_deg == pytest.approx(-0.55)
    assert align(zeros(0.5), C_alpha=11.0).correction_deg == pytest.approx(-0.5)


def test_the_second_step_knows_the_stiffness_from_the_first():
    """(9): after the correction of -0.55 deg the axis is off by -0.05; the secant of both steps is the true stiffness."""
    first, second = align(zeros(0.5, -0.05)).steps
    assert not first.secant
    assert second.secant
    assert second.C_alpha == pytest.approx(-11.0 * 1500.0)
    assert second.correction_deg == pytest.approx(0.05)


def test_a_step_the_wrong_way_does_not_make_a_stiffness_of_the_wrong_sign():
    _, second = align(zeros(0.5, 0.6)).steps
    assert not second.secant
    assert second.C_alpha == -10.0 * 1500.0


def test_the_correction_is_given_in_the_rigs_axes():
    assert align(zeros(0.5), axes="sae").correction_deg == pytest.approx(0.55)


def test_loads_count_by_their_stiffness():
    from mffit.points.points import concatenate

    both = concatenate([zeros(0.2, Fz=1000.0), zeros(0.5, Fz=3000.0)])
    assert align(both).correction_deg == pytest.approx(-1.1 * (0.2 + 3.0 * 0.5) / 4.0)


@pytest.mark.parametrize(("off", "warned"), [(0.08, False), (0.09, True)])
def test_fifty_newtons_between_both_directions_are_the_limit(off, warned):
    """2 x 11 x 1500 N/rad: 46 N at 0.08 deg, 52 N at 0.09."""
    found = align(zeros(off))
    assert bool(found.warnings) is warned
    if warned:
        assert found.warnings[0].startswith("at 1500 N forward and backward forces differ by 52 N")
        assert "off by about 0.10 deg" in found.warnings[0]


def test_one_direction_alone_is_refused():
    both = zeros(0.5)
    with pytest.raises(InputError, match="both forward and backward"):
        align(both.select(both.direction > 0))
