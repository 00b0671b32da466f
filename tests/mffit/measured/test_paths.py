"""Turn slip from several paths: what pushes alike on both sides of the disc, or on two radii, drops out."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from plain_tyre import NEWTON, Plain, R, settings
from scipy.stats import chi2, norm
from uncertainties import ufloat

from mffit.constants import FALSE_ALARM
from mffit.measured import measure
from mffit.measured.turning import turn_slip_stiffness
from mffit.parts import split
from mffit.points.points import concatenate

OFFSET = 40.0  # N, of the load cell; four times what is declared
U_OFFSET = 10.0


class Narrow(Plain):
    """The same tyre at 0.7 of the path radius; its turn-slip force grows with the curvature."""

    def turn_slip_force(self, Fz):
        return super().turn_slip_force(Fz) / 0.7


def campaign(*others, backward=True, offset=OFFSET):
    """The usual path with everything, zeros of the others, each reading too much by the offset."""
    usual = Plain()
    whole = usual.campaign(backward=backward)
    parts = [whole]
    for tyre in others:
        points = tyre.campaign(backward=backward)
        zeros = np.abs(points.alpha) + np.abs(points.gamma) < math.radians(0.2)
        share = 0.7 if isinstance(tyre, Narrow) else 1.0
        zeros = points.select(zeros)
        parts.append(zeros.replace(phi_t=zeros.phi_t / share, sweep=0, sweep_names=("other",)))
    points = concatenate(parts)
    return points.replace(Fy=points.Fy + offset)


def found(points):
    config = settings(u_loadcell_offset_N=U_OFFSET, u_slip_alignment_N=20.0)
    return measure(config, points, split(points))


def of_budget(result, source):
    return next((row.contribution for row in result.budget if row.source == source), 0.0)


def test_one_path_takes_the_offset_for_turn_slip():
    alone = found(campaign())
    assert abs(alone.epsilon_gamma.value - Plain().epsilon) > 2.0 * alone.epsilon_gamma.u
    assert of_budget(alone, "load-cell offset") > 0.03


@pytest.mark.parametrize("other", [Plain(side=1), Narrow()], ids=["other side", "second radius"])
def test_a_second_path_takes_it_out(other):
    alone, both = found(campaign()), found(campaign(other))
    errors = [abs(r.epsilon_gamma.value - Plain().epsilon) for r in (alone, both)]
    assert errors[1] < 0.3 * errors[0]
    assert of_budget(both, "load-cell offset") < 0.25 * of_budget(alone, "load-cell offset")
    assert both.epsilon_gamma.u < 0.5 * alone.epsilon_gamma.u


def test_both_sides_count_half_each_and_noise_by_its_number():
    """Half the difference of two forces of equal noise: u(F) is that of one over the root of two."""
    alone, both = (found(campaign(*others, offset=0.0)) for others in ((), (Plain(side=1),)))
    noise = [
        math.hypot(*(row.contribution for row in r.budget if "noise of the backward" in row.source))
        for r in (alone, both)
    ]
    assert noise[1] == pytest.approx(noise[0] / math.sqrt(2.0), rel=0.1)


def test_conicity_and_misalignment_push_alike_on_both_sides():
    both = found(campaign(Plain(side=1), backward=False))
    assert of_budget(both, "conicity") == pytest.approx(0.0, abs=1e-3)
    assert of_budget(both, "sideslip alignment") == pytest.approx(0.0, abs=2e-3)
    assert not any("cannot be separated" in note for note in both.notes)


def test_the_usual_path_is_reported_as_before():
    """Forces and radius of the record stay those of the declared path."""
    alone, both = found(campaign()), found(campaign(Plain(side=1)))
    assert both.nominal.F_forward == alone.nominal.F_forward
    assert both.nominal.R == alone.nominal.R
    assert both.C_gamma.value == pytest.approx(alone.C_gamma.value)
    assert both.F_phit.value == pytest.approx(alone.F_phit.value - OFFSET, abs=NEWTON)


def contradictions(result) -> list[str]:
    return [warning for warning in result.warnings if "contradict each other" in warning]


@pytest.mark.parametrize("other", [Plain(side=1), Narrow()], ids=["other side", "second radius"])
def test_paths_that_agree_within_what_is_declared_are_not_said_to_contradict(other):
    assert not contradictions(found(campaign(other, offset=0.5 * U_OFFSET)))


def test_an_offset_beyond_what_is_declared_makes_the_paths_contradict():
    """Each path takes it for turn slip, with the opposite sign."""
    (warning,) = contradictions(found(campaign(Plain(side=1), offset=8.0 * U_OFFSET)))
    left, right = (float(x) for x in re.findall(r"(\S+) \+- \S+ Nm", warning))
    assert abs(left - right) == pytest.approx(2.0 * 8.0 * U_OFFSET * R, abs=1.0 + NEWTON * R)
    assert warning.index("to the left") < warning.index("to the right")


def test_a_radius_that_is_not_the_runs_makes_the_paths_contradict():
    """Zeros of 1.3 m declared as of 0.5 m."""
    points = campaign(Plain(side=1), offset=0.0)
    wrong = np.where(points.phi_t > 0.0, points.phi_t * R / 0.5, points.phi_t)
    assert contradictions(found(points.replace(phi_t=wrong)))


@pytest.mark.parametrize("direction", [1, -1])
def test_zeros_of_the_other_side_declared_as_of_the_usual_path_are_reported(direction):
    """Without its path_centre the sweep pulls the mean of the zeros to nothing, and eps_gamma anywhere."""
    points = campaign(Plain(side=1), offset=0.0)
    assert not [warning for warning in found(points).warnings if "cannot come from one path" in warning]
    undeclared = (points.phi_t > 0.0) & (points.direction == direction)
    wrong = found(points.replace(phi_t=np.where(undeclared, -points.phi_t, points.phi_t)))
    (warning,) = [warning for warning in wrong.warnings if "cannot come from one path" in warning]
    assert "other" in warning
    assert ("backward" if direction < 0 else "forward") in warning


@pytest.mark.parametrize(("apart", "contradictory"), [(3.25, False), (3.33, True)])
def test_two_paths_contradict_beyond_a_chance_of_one_in_a_thousand(apart, contradictory):
    """A normal number is beyond 3.29 with that probability."""
    u = 3.0
    both = [ufloat(300.0, u), ufloat(300.0 + apart * u * math.sqrt(2.0), u)]
    found = turn_slip_stiffness(both, (R, -R))
    assert (found.chance < FALSE_ALARM) == contradictory
    assert found.chance == pytest.approx(2.0 * norm.sf(apart), rel=1e-6)
    assert found.numbers[0].nominal_value == pytest.approx(np.mean([C.nominal_value for C in both]))


def test_three_paths_have_two_degrees_of_freedom():
    u = 2.0
    said = [300.0, 306.0, 309.0]
    found = turn_slip_stiffness([ufloat(C, u) for C in said], (R, R, R))
    assert found.chance == pytest.approx(chi2.sf(np.sum((np.array(said) - 305.0) ** 2) / u**2, 2), rel=1e-6)


def test_the_surer_path_counts_more():
    (C_phit,) = turn_slip_stiffness([ufloat(300.0, 1.0), ufloat(310.0, 3.0)], (R, -R)).numbers
    assert C_phit.nominal_value == pytest.approx(301.0)
    assert C_phit.std_dev == pytest.approx(math.sqrt(0.9))


@pytest.mark.parametrize(("fall", "contradictory"), [(0.03, False), (0.3, True)])
def test_a_stiffness_that_falls_with_spin_is_no_contradiction_of_two_radii(fall, contradictory):
    """On a radius of 0.8 m the same tyre is softer by a share of 1/0.8^2 - 1/1.3^2 per m^2; tyres lose some 3 %."""
    u, small = 0.3, 0.8
    softer = 300.0 * (1.0 - fall * (1.0 / small**2 - 1.0 / R**2))
    found = turn_slip_stiffness([ufloat(300.0, u), ufloat(softer, u)], (R, small))
    assert (found.chance < FALSE_ALARM) == contradictory
