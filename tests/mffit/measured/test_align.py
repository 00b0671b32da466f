"""(6)-(10): the steering correction from zeros rolled both ways, step by step, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.errors import InputError
from mffit.measured import align, wording
from mffit.points import make_points
from tir import Quantity

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
    assert (step.load, step.iteration) == (1500.0, 1)


def test_the_first_step_guesses_ten_and_corrects_against_the_misalignment():
    """C_alpha = 10 Fz where it is 11 Fz: the correction is a tenth too large and of the other sign."""
    found = align(zeros(0.5))
    assert found.steps[0].C_alpha == -10.0 * 1500.0
    assert found.correction_deg == pytest.approx(-0.55)
    assert align(zeros(0.5), measured=MEASURED).correction_deg == pytest.approx(-0.5)


def test_the_second_step_knows_the_stiffness_from_the_first():
    """(9): after the correction of -0.55 deg the axis is off by -0.05; the secant of both steps is the true stiffness."""
    first, second = align(zeros(0.5, -0.05)).steps
    assert first.source != "secant"
    assert second.source == "secant"
    assert second.C_alpha == pytest.approx(-11.0 * 1500.0)
    assert second.correction_deg == pytest.approx(0.05)


def test_a_step_the_wrong_way_does_not_make_a_stiffness_of_the_wrong_sign():
    _, second = align(zeros(0.5, 0.6)).steps
    assert second.source != "secant"
    assert second.C_alpha == -10.0 * 1500.0


def test_the_correction_is_given_in_the_rigs_axes():
    assert align(zeros(0.5), axes="sae").correction_deg == pytest.approx(0.55)


def test_loads_count_by_their_stiffness():
    from mffit.points.points import concatenate

    both = concatenate([zeros(0.2, Fz=1000.0), zeros(0.5, Fz=3000.0)])
    assert align(both).correction_deg == pytest.approx(-1.1 * (0.2 + 3.0 * 0.5) / 4.0)


def test_one_direction_alone_is_refused():
    both = zeros(0.5)
    with pytest.raises(InputError, match="both forward and backward"):
        align(both.select(both.direction > 0))


MEASURED = {1500.0: Quantity(-11.0 * 1500.0, 165.0, "N/rad")}


def test_a_measured_stiffness_is_used_before_any_guess():
    (step,) = align(zeros(0.5), measured=MEASURED).steps
    assert step.source == "measured"
    assert step.correction_deg == pytest.approx(-0.5)


def test_the_correction_is_as_uncertain_as_forces_and_stiffness():
    """4 N on each direction leave 4/sqrt(2) N on the slip force; 1 % of the stiffness is 1 % of the correction."""
    points = zeros(0.5).replace(u_Fy=4.0)
    (step,) = align(points, measured=MEASURED).steps
    from_force = np.degrees(4.0 / np.sqrt(2.0) / (11.0 * 1500.0))
    assert step.u_deg == pytest.approx(np.hypot(from_force, 0.005))
    assert align(points).steps[0].u_deg > 0.2  # a guessed stiffness may be half as large


@pytest.mark.parametrize(("off", "aligned"), [(0.008, True), (0.012, False), (-0.012, False)])
def test_the_axis_is_aligned_when_the_correction_is_within_its_uncertainty(off, aligned):
    """u is 4/sqrt(2) N over 11 x 1500 N/rad: 0.0098 deg."""
    found = align(zeros(off).replace(u_Fy=4.0), measured=MEASURED, resolution_deg=0.001)
    assert found.aligned is aligned
    assert wording.advice(found)[0].startswith("Aligned, stop" if aligned else "Turn the sideslip axis by")
    assert align(zeros(off), measured=MEASURED, resolution_deg=0.02).aligned


def test_a_guessed_stiffness_is_said_to_be_one():
    """Not after a second step, and not with a measured one."""
    words = "C_alpha is guessed from the load"
    assert any(words in said for said in wording.advice(align(zeros(0.5))))
    for found in (align(zeros(0.5, -0.05)), align(zeros(0.5), measured=MEASURED)):
        assert not any(words in said for said in wording.advice(found))


def test_the_advice_says_the_correction_its_uncertainty_and_what_limits_it():
    points = zeros(0.5).replace(u_Fy=4.0)
    (turn, *_) = wording.advice(align(points, measured=MEASURED))
    assert turn.startswith("Turn the sideslip axis by -0.500 +- 0.011 deg of the rig's own scale (k = 1)")
    within = zeros(0.008).replace(u_Fy=4.0)
    (stop, *_) = wording.advice(align(within, measured=MEASURED, resolution_deg=0.001))
    assert stop.endswith("is within its uncertainty.")
    sure = zeros(0.008).replace(u_Fy=0.1)
    (stop, *_) = wording.advice(align(sure, measured=MEASURED, resolution_deg=0.02))
    assert stop.endswith("is within the smallest step of the axis, 0.02 deg.")
