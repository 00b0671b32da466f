"""The sideslip zero belongs to the set-up: loads and paths without backward zeros have it too, and all agree on it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from plain_tyre import Plain, settings, share
from scipy.stats import chi2
from uncertainties import ufloat

from mffit import as_json
from mffit.measured import measure
from mffit.measured.axis import ZeroSplit, camber_at_true_zero
from mffit.parts import split
from mffit.points.points import concatenate

LOADS = (1000.0, 1500.0, 2000.0)
OFF = math.radians(0.35)
PLY_STEER = 0.002  # rad, its usual size


def without_backward(points, *loads):
    return points.select(~(np.isin(points.Fz, loads) & (points.direction == -1)))


def zeros(points):
    return points.select(np.abs(points.alpha) + np.abs(points.gamma) < math.radians(0.2))


def in_setup(points, name):
    return points.replace(setup=0, setups=(name,))


def found(*parts, nominal=1500.0, **rig):
    points = concatenate(parts)
    config = settings(tyre={"nominal_load": nominal}, **{"u_slip_alignment_N": 25.0} | rig)
    return measure(config, points, split(points))


def at(result, load):
    return next(row for row in result.per_load if row.load == load)


def contribution(row, source):
    return next((line.contribution for line in row.budget if line.source == source), 0.0)


@pytest.mark.parametrize("alpha_0", [OFF, -OFF])
@pytest.mark.parametrize("lacking", LOADS)
def test_a_load_without_backward_zeros_has_the_axis_of_its_set_up(lacking, alpha_0):
    """Uncorrected its force would be off by 12 Fz 0.35 deg, a third of the turn-slip force."""
    tyre = Plain(alpha_0=alpha_0)
    result = found(without_backward(tyre.campaign(LOADS), lacking))
    row = at(result, lacking)
    assert math.isnan(row.F_backward)
    assert row.alpha_M.value == pytest.approx(alpha_0, rel=0.03)
    assert row.F_phit.value == pytest.approx(tyre.turn_slip_force(lacking), abs=3.0)
    assert row.epsilon_gamma.value == pytest.approx(tyre.epsilon, abs=0.03)
    assert contribution(row, "sideslip alignment") == 0.0
    assert result.pecp2 == 0.0


def test_the_nominal_load_may_be_the_one_without_backward_zeros():
    result = found(without_backward(Plain(alpha_0=OFF).campaign(LOADS), 1500.0), nominal=1500.0)
    assert result.nominal.load == 1500.0
    assert result.misaligned
    assert result.axis_off
    assert result.alpha_M.value == pytest.approx(OFF, rel=0.03)
    assert any("the sideslip axis is misaligned" in warning for warning in result.warnings)


def test_what_ply_steer_may_change_over_load_counts_as_the_force_it_makes():
    """One other load measures the sum there; a third of a nominal load away ply-steer is known to 0.002 rad over three."""
    tyre = Plain()
    row = at(found(without_backward(tyre.campaign((1000.0, 1500.0)), 1000.0)), 1000.0)
    force = 12.0 * 1000.0 * PLY_STEER / 3.0
    assert contribution(row, "ply-steer over load") == pytest.approx(share(force, tyre, 1000.0), rel=0.03)
    assert row.alpha_M.u == pytest.approx(PLY_STEER / 3.0, rel=0.1)  # and little noise


def test_ply_steer_that_changes_with_load_is_followed():
    """Two loads that differ by 0.06 deg, which is usual ply-steer over load: the third lies on their line."""
    slope = math.radians(0.06) / 500.0
    parts = [Plain(alpha_0=OFF + slope * (load - 1500.0)).campaign((load,)) for load in LOADS]
    row = at(found(without_backward(concatenate(parts), 2000.0)), 2000.0)
    assert abs(row.alpha_M.value - OFF - slope * 500.0) < row.alpha_M.u
    assert row.F_phit.value == pytest.approx(Plain().turn_slip_force(2000.0), abs=8.0)


def bent(tyre, points):
    """The points of a curve that turn slip shifts, so that its slope at zero changes; mirrored on the other side of the disc."""
    true = np.where(points.gamma == 0.0, points.alpha + tyre.alpha_0, 0.0)
    return points.replace(Fy=points.Fy - tyre.side * points.Fz * 65.0 * true**2)


@pytest.mark.parametrize("alpha_0", [OFF, -OFF])
def test_a_bent_curve_is_followed_to_the_true_zero(alpha_0):
    """Force and slope at the reading of zero both differ from those at true zero, by 4 N and 6 %."""
    tyre, other = Plain(alpha_0=alpha_0), Plain(side=1, alpha_0=alpha_0)
    row = at(found(without_backward(bent(tyre, tyre.campaign(LOADS)), 2000.0)), 2000.0)
    assert row.alpha_M.value == pytest.approx(alpha_0, rel=0.02)
    assert row.F_phit.value == pytest.approx(tyre.turn_slip_force(2000.0), abs=4.0)
    usual = in_setup(bent(tyre, tyre.campaign()), "A")
    forwards = in_setup(zeros(bent(other, other.campaign(backward=False))), "A")
    (right,) = [row for row in found(usual, forwards).nominal.setups if row.phi_t > 0.0]
    assert right.F_phit.value == pytest.approx(other.turn_slip_force(1500.0), abs=3.0)


@pytest.mark.parametrize(("share", "off"), [(0.0, 1.0), (0.5, 0.0), (1.0, -1.0)])
def test_the_camber_stiffness_is_that_at_true_zero_of_sideslip(share, off):
    """Camber that acts as so much sideslip follows the bent curve: d2Fy/(dgamma dalpha) = share bend C_gamma / C_alpha."""
    tyre = Plain(alpha_0=OFF)
    points = bent(tyre, tyre.campaign())
    mixed = share * 130.0 * 0.9 / 12.0  # per load [1/rad^2]
    leant = found(points.replace(Fy=points.Fy + points.Fz * mixed * OFF * points.gamma)).C_gamma
    straight = found(Plain().campaign()).C_gamma
    correction = 130.0 * OFF / 12.0 * 0.5 * straight.value
    assert leant.value - straight.value == pytest.approx(off * correction, abs=5.0)
    assert abs(leant.value - straight.value) < 1.8 * leant.u


def test_what_camber_shares_with_sideslip_is_any_part_as_likely():
    """A rectangular distribution from 0 to 1 has the variance 1/12; the slope changes by a tenth at the misalignment."""
    exact = 1e-12
    bend, angle = ufloat(130e3, exact), ufloat(math.radians(0.5), exact)
    C_alpha = float(10.0 * (bend * angle).nominal_value)
    factor = camber_at_true_zero(C_alpha, bend, ZeroSplit(angle, ufloat(0.0, exact)))
    assert (factor.nominal_value, factor.std_dev) == pytest.approx((0.95, 0.1 / math.sqrt(12.0)))


def test_a_path_without_backward_zeros_has_the_axis_of_its_set_up_too():
    both = Plain(alpha_0=OFF).campaign()
    other = zeros(Plain(side=1, alpha_0=OFF).campaign(backward=False))
    result = found(in_setup(both, "A"), in_setup(other, "A"))
    for row in result.nominal.setups:
        assert row.F_phit.value == pytest.approx(
            math.copysign(Plain().turn_slip_force(1500.0), row.phi_t), abs=3.0
        )
        assert row.misaligned
    centres = {row.phi_t > 0.0: as_json.document(row)["path_centre"] for row in result.nominal.setups}
    assert centres == {False: "left", True: "right"}  # phi_t = -1/R with the centre to the left


def test_a_set_up_that_was_never_run_backwards_keeps_the_declared_doubt():
    whole = Plain().campaign()
    result = found(in_setup(whole, "1"), in_setup(zeros(Plain(side=1).campaign(backward=False)), "2"))
    (own,) = [row for row in result.nominal.setups if row.name == "2"]
    assert own.alpha_M is None
    assert own.F_phit.u > 25.0


def test_a_set_up_is_misaligned_wherever_its_zeros_are():
    """The second set-up has zeros at another load than the nominal one; the fit starts from them."""
    usual, other = Plain().campaign(LOADS), Plain(alpha_0=OFF).campaign((2000.0,))
    result = found(in_setup(usual, "1"), in_setup(other, "2"))
    assert result.misaligned_setups == {"2": pytest.approx(OFF, rel=0.03)}


def test_zeros_of_one_set_up_that_differ_are_found_with_the_chance_of_it():
    """Two sides 0.05 deg apart: chi-square of one difference, each angle known to its own u."""
    left, right = Plain(), Plain(side=1, alpha_0=math.radians(0.05))
    result = found(in_setup(left.campaign(), "A"), in_setup(zeros(right.campaign()), "A"))
    (agreement,) = result.sideslip_zeros
    one, other = agreement.one, agreement.other
    assert {round(math.degrees(x.alpha_M.value), 2) for x in (one, other)} == {0.0, 0.05}
    assert {x.phi_t > 0.0 for x in (one, other)} == {False, True}
    apart = (one.alpha_M.value - other.alpha_M.value) ** 2 / (one.alpha_M.u**2 + other.alpha_M.u**2)
    # Both share the cornering stiffness, which hardly counts at such angles.
    assert agreement.chance == pytest.approx(chi2.sf(apart, 1), rel=0.05)


@pytest.mark.parametrize(("moved", "named"), [(2000.0, {1500.0, 2000.0}), (1000.0, {1000.0, 1500.0})])
def test_the_loads_that_contradict_each_other_are_the_ones_named(moved, named):
    """The axis slipped between two neighbouring loads; over more of the load ply-steer may change by more."""
    (agreement,) = found(
        *(Plain(alpha_0=OFF * (load == moved)).campaign((load,)) for load in LOADS)
    ).sideslip_zeros
    assert agreement.chance < 1e-12
    assert {agreement.one.load, agreement.other.load} == named
    (sound,) = found(Plain(alpha_0=OFF).campaign(LOADS)).sideslip_zeros
    assert sound.chance > 0.5


def test_alpha_M_is_that_of_the_first_set_up_that_ran_both_ways():
    """The usual path was run forwards only, the other side of the disc both ways and in another set-up, whose axis is off."""
    usual, other = Plain().campaign((1500.0,), backward=False), Plain(side=1, alpha_0=OFF).campaign((1500.0,))
    result = found(in_setup(usual, "1"), in_setup(zeros(other), "2"))
    assert result.nominal.paths[0] == usual.phi_t[0]
    assert result.alpha_M.value == pytest.approx(OFF, rel=0.03)


def test_driven_points_are_no_sideslip_sweep():
    """A braked wheel has little side force left: its points would halve the cornering stiffness."""
    usual = Plain().campaign((1500.0,))
    braked = usual.replace(kappa=-0.1, Fy=0.3 * usual.Fy)
    (alone,), (both,) = found(usual).per_load, found(usual, braked).per_load
    assert both.C_alpha == alone.C_alpha
    assert both.epsilon_gamma == alone.epsilon_gamma
