"""The direct method on a tyre of which every answer is known by arithmetic."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from plain_tyre import DEGREE, LEAN, NEWTON, R_E, SLIP, U_R, U_R_E, Plain, R, settings, share
from scipy.stats import t as student

from mffit import as_json
from mffit.errors import InputError
from mffit.measured import Contribution, measure, wording
from mffit.measured.result import FINITE_SPIN, NO_FIT, AfterFit
from mffit.measured.uncertain import expanded
from mffit.parts import split
from mffit.points.points import concatenate
from tir import Quantity

LOADS = (1000.0, 1500.0, 2000.0)


def measured(
    tyre: Plain,
    loads=(1500.0,),
    points=None,
    base=None,
    after=NO_FIT,
    camber_stiffness=None,
    radius=True,
    **rig,
):
    sides = {-1: "left", 1: "right"}
    points = points or tyre.campaign(loads)
    config = settings(path_centre=sides[tyre.side], camber_stiffness=camber_stiffness, radius=radius, **rig)
    return measure(config, points, split(points), base, after)


def contributions(result) -> dict[str, float]:
    return {row.source: row.contribution for row in result.budget}


@pytest.mark.parametrize(
    "tyre", [Plain(), Plain(side=1), Plain(epsilon=0.3, camber=1.1), Plain(cornering=9.0)]
)
def test_stiffnesses_force_and_factor_at_every_load(tyre):
    result = measured(tyre, LOADS)
    assert [row.load for row in result.per_load] == list(LOADS)
    for row in result.per_load:
        assert row.C_alpha.value == pytest.approx(-tyre.cornering * row.load, rel=0.01)
        assert row.C_gamma.value == pytest.approx(-tyre.camber * row.load, rel=0.004)
        assert row.F_phit.value == pytest.approx(tyre.turn_slip_force(row.load), abs=1.0)
        assert row.C_phit.value == pytest.approx(
            R_E * tyre.camber * row.load / (1.0 - tyre.epsilon), rel=0.005
        )
        assert row.epsilon_gamma.value == pytest.approx(tyre.epsilon, abs=0.01)
        assert row.epsilon_slope == pytest.approx(tyre.epsilon, abs=0.01)
        assert row.epsilon_secant == pytest.approx(tyre.epsilon, abs=0.01)
        assert row.alpha_M.value == pytest.approx(0.0, abs=1e-6)
        assert row.R.value == R
        assert row.r_e.value == R_E
    assert result.nominal.load == 1500.0
    assert result.pecp1 == result.epsilon_gamma.value
    assert not result.misaligned


def elsewhere(result) -> list[str]:
    return [warning for warning in result.warnings if warning.startswith("eps_gamma is taken at")]


def test_a_factor_that_is_taken_at_another_load_says_where_and_why():
    """The camber sweep at the nominal load has the label of another pressure."""
    points = Plain().campaign(LOADS)
    leaning = (points.Fz == 1500.0) & (np.abs(points.gamma) > 0.0)
    assert not elsewhere(measured(Plain(), points=points))
    result = measured(Plain(), points=points.replace(p=np.where(leaning, 200e3, points.p)))
    assert result.nominal.load in (1000.0, 2000.0)
    (said,) = elsewhere(result)
    assert said.startswith(f"eps_gamma is taken at {result.nominal.load:.0f} N and not at 1500 N")
    assert "for lack of a camber sweep at zero sideslip;" in said
    assert "camber (200 kPa) ran at 1500 N" in said
    (said,) = elsewhere(measured(Plain(), points=points.select(~leaning)))
    assert said.endswith("for lack of a camber sweep at zero sideslip")


@pytest.mark.parametrize("tyre", [Plain(), Plain(epsilon_moment=0.2, side=1)])
def test_the_opinion_of_the_moments(tyre):
    """Spin moment and camber moment of the plain tyre were made for it."""
    (row,) = measured(tyre).per_load
    assert row.epsilon_moment == pytest.approx(tyre.epsilon_moment, abs=0.02)


def test_a_moment_within_twice_its_noise_has_no_opinion():
    tyre = Plain()
    spin = abs(tyre.readings(0.0, 0.0, 1500.0, 1)[1])
    # One point at zero backwards, a parabola through nine forwards: u is little more than u_Mz / 2.
    quiet, loud = (tyre.campaign(u_Mz=f * spin) for f in (0.8, 1.1))
    assert measured(tyre, points=quiet).per_load[0].epsilon_moment is not None
    assert measured(tyre, points=loud).per_load[0].epsilon_moment is None


@pytest.mark.parametrize("alpha_0", [0.5 * DEGREE, -0.3 * DEGREE])
def test_misalignment_is_half_the_difference_of_both_directions(alpha_0):
    """(7): forwards the force gains C_alpha alpha_M, backwards it loses it."""
    tyre = Plain(alpha_0=alpha_0)
    result = measured(tyre, u_slip_alignment_N=25.0)
    assert result.alpha_M.value == pytest.approx(alpha_0, rel=0.03)
    slip = -12.0 * 1500.0 * alpha_0
    assert result.nominal.F_forward == pytest.approx(tyre.turn_slip_force(1500.0) + slip, abs=3.0)
    assert result.nominal.F_backward == pytest.approx(tyre.turn_slip_force(1500.0) - slip, abs=3.0)
    assert result.F_phit.value == pytest.approx(tyre.turn_slip_force(1500.0), abs=1.0)
    assert result.misaligned
    (warning,) = result.warnings
    assert f"alpha_M = {math.degrees(result.alpha_M.value):.3f}" in warning
    assert f"differ by {abs(2 * slip):.0f} N" in warning or f"differ by {abs(2 * slip) - 1:.0f} N" in warning


def test_what_the_alignment_leaves_is_no_misalignment():
    tyre = Plain(alpha_0=0.1 * DEGREE)  # 31 N
    assert not measured(tyre, u_slip_alignment_N=40.0).misaligned
    assert measured(tyre, u_slip_alignment_N=25.0).misaligned
    stays = measured(tyre, u_slip_alignment_N=40.0)
    shift = abs(1.0 - tyre.epsilon) * 31.4 / abs(tyre.turn_slip_force(1500.0))
    assert any(f"would move eps_gamma by {shift:.2f}" in note for note in stays.notes)


@pytest.mark.parametrize(
    ("rig", "source", "force"),
    [
        ({"u_loadcell_offset_N": 20.0}, "load-cell offset", 20.0),
        ({"u_camber_alignment_deg": 0.5}, "camber alignment", 0.9 * 1500.0 * 0.5 * DEGREE),
        ({"u_slip_alignment_N": 30.0}, "sideslip alignment", 0.0),
        ({"backlash_deg": 0.2, "u_backlash_deg": 0.06}, "backlash", 0.0),
    ],
)
def test_each_doubt_about_the_rig_counts_as_the_force_it_makes(rig, source, force):
    """With runs both ways the force of the sideslip axis drops out, and that of the play at zero moment with it."""
    tyre = Plain(play=rig.get("backlash_deg", 0.0) * DEGREE)
    without, with_it = (
        measured(tyre, **{k: v for k, v in rig.items() if k == "backlash_deg"}),
        measured(tyre, **rig),
    )
    assert contributions(with_it).get(source, 0.0) == pytest.approx(share(force, tyre), rel=0.02, abs=1e-6)
    together = math.hypot(without.epsilon_gamma.u, share(force, tyre))
    assert with_it.epsilon_gamma.u == pytest.approx(together, rel=0.01)
    units = {row.source: (row.u, row.unit) for row in with_it.budget}
    if source in units and "deg" in str(rig):
        assert units[source] == (pytest.approx(0.5), "deg")


def test_camber_skew_counts_through_the_camber_stiffness():
    """A wheel that steers by 0.2 deg sin(gamma) as it leans adds C_alpha 0.2 deg to the slope over camber."""
    tyre = Plain()
    result = measured(tyre, u_camber_skew_deg=0.2)
    u_slope = 12.0 * 1500.0 * 0.2 * DEGREE
    C_phit = tyre.turn_slip_force(1500.0) * tyre.side * R
    expected = abs(R_E * u_slope / C_phit)
    assert contributions(result)["camber skew"] == pytest.approx(expected, rel=0.02)
    without = measured(tyre).C_gamma.u
    assert result.C_gamma.u == pytest.approx(math.hypot(u_slope, without), rel=0.02)


def found_skew(result) -> float:
    """The camber skew in the one note about it [deg]."""
    (note,) = [note for note in result.notes if "camber skew" in note]
    return float(re.search(r"steers the wheel by (\S+) ", note)[1])


@pytest.mark.parametrize("skew", [0.3 * DEGREE, -0.5 * DEGREE])
def test_a_backward_camber_sweep_separates_skew_from_camber(skew):
    """Backwards the camber force keeps its sign and the slip force of the skew turns: half the sum is camber alone."""
    tyre, loads = Plain(skew=skew), (1000.0, 1500.0)
    forward, both = (
        measured(tyre, points=tyre.campaign(loads, backward_camber=cambers), u_camber_skew_deg=0.3)
        for cambers in ((), (1500.0,))
    )
    true = -0.9 * 1500.0
    assert abs(forward.C_gamma.value - true) > 12.0 * 1500.0 * abs(skew) * 0.9
    assert both.C_gamma.value == pytest.approx(true, rel=0.01)
    assert both.epsilon_gamma.value == pytest.approx(tyre.epsilon, abs=0.015)
    assert both.epsilon_gamma.u < 0.4 * forward.epsilon_gamma.u
    assert found_skew(both) == pytest.approx(math.degrees(skew), abs=0.02)
    other = both.per_load[0]  # no backward sweep there: the skew of the rig is the same
    assert other.C_gamma.value == pytest.approx(-0.9 * 1000.0, rel=0.015)
    assert not any("camber skew" in note for note in forward.notes)


def test_a_declared_skew_and_a_noisy_backward_sweep_are_averaged_by_their_weights():
    tyre = Plain(skew=0.03 * DEGREE)
    points = tyre.campaign(backward_camber=(1500.0,), u_Fy=10.0)
    sure, unsure = (measured(tyre, points=points, u_camber_skew_deg=u) for u in (1e-3, 1.0))
    assert found_skew(sure) == pytest.approx(0.0, abs=0.001)
    assert found_skew(unsure) == pytest.approx(0.03, abs=0.01)


def test_a_declaration_that_the_sweeps_contradict_is_not_averaged_in():
    """A skew of 0.5 deg on a rig that declares 0.05 deg is found whole, with the uncertainty of the sweeps."""
    tyre = Plain(skew=0.5 * DEGREE)
    found = measured(tyre, points=tyre.campaign(backward_camber=(1500.0,)), u_camber_skew_deg=0.05)
    assert found.camber_skew.value == pytest.approx(0.5, abs=0.02)
    assert found.epsilon_gamma.value == pytest.approx(tyre.epsilon, abs=0.015)
    (warning,) = (text for text in found.warnings if "camber axis" in text)
    assert "0.05 deg are declared" in warning


def test_a_skew_as_declared_is_no_warning():
    tyre = Plain(skew=0.5 * DEGREE)
    found = measured(tyre, points=tyre.campaign(backward_camber=(1500.0,)), u_camber_skew_deg=0.3)
    assert not any("camber axis" in text for text in found.warnings)


def test_every_estimate_of_the_factor_is_less_the_measured_skew():
    tyre = Plain(skew=0.5 * DEGREE)
    row = measured(tyre, points=tyre.campaign(backward_camber=(1500.0,))).nominal
    for epsilon in (row.epsilon_gamma.value, row.epsilon_slope, row.epsilon_secant):
        assert epsilon == pytest.approx(tyre.epsilon, abs=0.02)
    assert row.C_gamma.value == pytest.approx(-0.9 * 1500.0, rel=0.01)


def test_zeros_on_a_flipped_mount_remove_the_conicity():
    """The tyre turned on its rim pushes the other way; eps_gamma is that of the tyre without conicity."""
    tyre, push = Plain(), 25.0
    normal = tyre.campaign()
    zeros = normal.select((np.abs(normal.alpha) < 0.2 * DEGREE) & (normal.gamma == 0.0))
    turned = zeros.replace(mount=-1, Fy=zeros.Fy - push)
    both = concatenate([normal.replace(Fy=normal.Fy + push), turned])
    alone, found = measured(tyre, points=normal.replace(Fy=normal.Fy + push)), measured(tyre, points=both)
    assert abs(alone.epsilon_gamma.value - tyre.epsilon) > 0.05
    assert found.epsilon_gamma.value == pytest.approx(tyre.epsilon, abs=0.005)
    assert found.nominal.conicity.value == pytest.approx(push, abs=0.5)
    assert contributions(found).get("conicity", 0.0) < 0.2 * contributions(alone)["conicity"]
    assert any("conicity force is 25" in note for note in found.notes)


def test_a_warmer_camber_sweep_counts_by_the_usual_change_of_stiffness():
    tyre = Plain()
    points = tyre.campaign()
    warm = points.replace(T=np.where(points.gamma != 0.0, 45.0, 25.0))
    found = contributions(measured(tyre, points=warm))
    assert found["temperature"] == pytest.approx((1.0 - tyre.epsilon) * 0.002 * 20.0, rel=0.02)
    assert "temperature" not in contributions(measured(tyre, points=points.replace(T=25.0)))


def test_finite_spin_is_in_the_uncertainty_of_the_value_and_taken_off_the_debiased_one():
    """(17) holds at zero spin; with R = 1.3 m a usual tyre reads 0.03 m^2 (1 - eps) / R^2 too much."""
    tyre = Plain()
    result = measured(tyre)
    bias = 0.03 * (1.0 - tyre.epsilon) / R**2
    assert result.epsilon_gamma.value - result.epsilon_gamma_debiased.value == pytest.approx(bias, rel=0.01)
    assert contributions(result)["finite spin of the disc"] == pytest.approx(
        bias * math.hypot(1.0, 0.5), rel=0.01
    )
    rest = math.hypot(*(v for k, v in contributions(result).items() if k != "finite spin of the disc"))
    assert result.epsilon_gamma_debiased.u == pytest.approx(math.hypot(rest, bias / 2.0), rel=0.01)


def test_the_bias_of_the_model_takes_the_place_of_the_usual_one():
    """0.2 m^2 with its own u instead of 0.03 +- 0.015 m^2, at every load alike; the measured value stays."""
    tyre, spin = Plain(), Quantity(0.2, 0.06, "m^2")
    before, after = (measured(tyre, LOADS, after=AfterFit(spin=known)) for known in (None, spin))
    for row, usual in zip(after.per_load, before.per_load, strict=True):
        assert row.epsilon_gamma.value == usual.epsilon_gamma.value
        bias = 0.2 * (1.0 - row.epsilon_gamma.value) / R**2
        assert row.epsilon_gamma.value - row.epsilon_debiased.value == pytest.approx(bias)
        rest = math.hypot(*(line.contribution for line in row.budget if line.source != FINITE_SPIN))
        assert row.epsilon_debiased.u == pytest.approx(math.hypot(rest, 0.3 * bias), rel=1e-3)
        assert row.epsilon_gamma.u == pytest.approx(math.hypot(rest, bias, 0.3 * bias), rel=1e-3)


@pytest.mark.parametrize("source", ["direct", "debiased", "model"])
def test_the_file_carries_what_spin_pecp1_chooses(source):
    """Before the fit of a model the direct value is the start; afterwards the file's own number counts."""
    tyre = Plain()
    config = settings(path_centre="left", spin={"pecp1": source})
    points = tyre.campaign()
    fitted = Quantity(-0.3, 0.02, "-")
    before, after = (
        measure(config, points, split(points), None, AfterFit(pecp1=known)) for known in (None, fitted)
    )
    row = before.nominal
    expected = {"direct": row.epsilon_gamma, "debiased": row.epsilon_debiased, "model": row.epsilon_gamma}
    assert before.carried.pecp1 == expected[source]
    assert before.carried.is_free == (source == "model")
    assert after.epsilon_of_file == (fitted if source == "model" else expected[source])
    stated = as_json.document(after)
    assert (stated["epsilon_gamma"], stated["u_epsilon_gamma"]) == after.epsilon_of_file[:2]
    assert stated["pecp1"] == stated["epsilon_gamma"] == after.quantities()["epsilon_gamma"].value
    assert stated["epsilon_gamma_direct"] == row.epsilon_gamma.value
    assert stated["epsilon_gamma_source"] == source


@pytest.mark.parametrize(("alpha_0", "misaligned"), [(0.05, False), (0.2, False), (0.5, True), (-0.5, True)])
def test_the_axis_is_called_misaligned_only_where_ply_steer_cannot_explain_the_sum(alpha_0, misaligned):
    tyre = Plain(alpha_0=alpha_0 * DEGREE)
    result = measured(tyre, u_slip_alignment_N=25.0)
    row = result.nominal
    assert row.alpha_M.value == pytest.approx(row.misalignment.value + row.ply_steer.value)
    assert row.alpha_M.u < 0.1 * row.misalignment.u
    assert result.axis_off == misaligned == any("misaligned" in warning for warning in result.warnings)
    axis, tyre_part = 25.0 / (12.0 * 1500.0), 0.002
    if not misaligned:
        share = axis**2 / (axis**2 + tyre_part**2)
        assert row.misalignment.value == pytest.approx(share * row.alpha_M.value, rel=0.01)
        assert row.misalignment.u == pytest.approx(axis * tyre_part / math.hypot(axis, tyre_part), rel=0.02)


@pytest.mark.parametrize("alpha_0", [0.5, -0.5])
def test_the_cornering_stiffness_is_that_at_true_zero(alpha_0):
    """Turn slip shifts the curve, so its slope changes at zero: 0.5 deg of misalignment would make 3500 N/rad here."""
    tyre = Plain(alpha_0=alpha_0 * DEGREE)
    points = tyre.campaign()
    true = np.where(points.gamma == 0.0, points.alpha + tyre.alpha_0, 0.0)
    bent = points.replace(Fy=points.Fy + points.direction * 2e5 * true**2)
    found = measured(tyre, points=bent, u_slip_alignment_N=25.0).C_alpha
    assert found.value == pytest.approx(-12.0 * 1500.0, abs=700.0)
    assert abs(found.value + 12.0 * 1500.0) < 2.0 * found.u


def test_the_budget_is_one_of_jcgm_100():
    """Each row is |sensitivity| u; their root sum of squares is u, and U = k u with Student's t for 95 %."""
    row = measured(Plain(), u_loadcell_offset_N=10.0, u_camber_alignment_deg=0.5).nominal
    for line in row.budget:
        assert line.contribution == pytest.approx(abs(line.sensitivity) * line.u)
        assert line.type in ("A", "B")
    assert math.hypot(*(line.contribution for line in row.budget)) == pytest.approx(row.epsilon_gamma.u)
    kinds = {line.source: line.type for line in row.budget}
    assert kinds["camber stiffness"] == kinds["noise of the forward zeros"] == "A"
    assert kinds["load-cell offset"] == kinds["finite spin of the disc"] == "B"
    assert row.expanded.k == pytest.approx(1.96, abs=0.05)
    offset = next(line for line in row.budget if line.source == "load-cell offset")
    assert offset.sensitivity == pytest.approx(-share(1.0, Plain()) * Plain().side, rel=0.02)


def test_few_degrees_of_freedom_widen_the_interval():
    """Welch and Satterthwaite: two equal parts, one with 4 degrees of freedom, have 16; k is that of Student's t."""
    rows = [Contribution("a", 1.0, "-", 0.1, "A", dof=4.0), Contribution("b", 1.0, "-", 0.1)]
    found = expanded(rows)
    assert found.dof == pytest.approx(16.0)
    assert found.k == pytest.approx(student.ppf(0.975, 16))
    assert pytest.approx(found.k * math.hypot(0.1, 0.1)) == found.U


def test_without_backward_runs_the_alignment_is_in_doubt():
    tyre = Plain()
    result = measured(tyre, points=tyre.campaign(backward=False), u_slip_alignment_N=30.0)
    assert result.alpha_M is None
    assert math.isnan(result.nominal.F_backward)
    assert contributions(result)["sideslip alignment"] == pytest.approx(share(30.0, tyre), rel=0.02)
    angle = math.degrees(abs(tyre.turn_slip_force(1500.0)) / (12.0 * 1500.0))
    assert any(f"would take {angle:.2f} deg of misalignment" in note for note in result.notes)


def test_the_play_is_taken_off_and_its_doubt_counts_where_the_moment_holds_one_side():
    """All zeros lie at one end of the play: forwards reading 0 means -play/2 sign(Mz), and so backwards."""
    tyre = Plain(play=0.3 * DEGREE)
    result = measured(tyre, points=tyre.campaign(backward=False), backlash_deg=0.3, u_backlash_deg=0.06)
    assert result.F_phit.value == pytest.approx(tyre.turn_slip_force(1500.0), abs=4.0)
    assert result.C_gamma.value == pytest.approx(-tyre.camber * 1500.0, rel=0.01)
    assert result.C_alpha.value == pytest.approx(-tyre.cornering * 1500.0, rel=0.03)
    assert contributions(result)["backlash"] == pytest.approx(
        share(12.0 * 1500.0 * 0.03 * DEGREE, tyre), rel=0.03
    )


def test_radii_count_once_where_they_come_from_one_path():
    """eps = 1 + r_e C_gamma / (F R): each radius counts with its own relative doubt."""
    tyre = Plain()
    got = contributions(measured(tyre))
    assert got["path radius"] == pytest.approx((1.0 - tyre.epsilon) * U_R / R, rel=0.01)
    assert got["effective radius"] == pytest.approx((1.0 - tyre.epsilon) * U_R_E / R_E, rel=0.01)


@pytest.mark.parametrize("noise", [NEWTON, 3.0 * NEWTON])
def test_noise_of_the_zeros_counts_with_their_number(noise):
    """Backwards one point at zero, forwards what a parabola through nine leaves at zero; half of each goes into the mean."""
    tyre = Plain()
    got = contributions(measured(tyre, points=tyre.campaign(u_Fy=noise)))
    alpha = np.array([-1.0, -0.5, -0.1, 0.0, 0.0, 0.0, 0.1, 0.5, 1.0])
    A = np.column_stack([alpha**0, alpha, alpha**2])
    left = noise * math.sqrt(np.linalg.inv(A.T @ A)[0, 0])
    assert got["noise of the backward zeros"] == pytest.approx(share(noise / 2.0, tyre), rel=0.01)
    assert got["noise of the forward zeros"] == pytest.approx(share(left / 2.0, tyre), rel=0.01)


def test_few_zeros_count_by_their_mean():
    tyre = Plain()
    points = tyre.campaign()
    few = points.select((np.abs(points.alpha) < 1e-6) | (np.abs(points.alpha) > 1.2 * DEGREE))
    got = contributions(measured(tyre, points=few))
    assert got["noise of the forward zeros"] == pytest.approx(
        share(NEWTON / 2.0, tyre) / math.sqrt(3.0), rel=0.01
    )


def test_points_without_uncertainty_count_as_6_newtons():
    tyre = Plain()
    stated, not_stated = (
        contributions(measured(tyre, points=tyre.campaign(u_Fy=u, u_Mz=v)))
        for u, v in ((6.0, 0.6), (np.nan, np.nan))
    )
    assert not_stated == pytest.approx(stated, rel=1e-6)


@pytest.mark.parametrize("method", ["slope", "secant"])
def test_the_configured_camber_stiffness_is_used(method):
    tyre = Plain()
    points = tyre.campaign()
    saturating = np.where(
        points.gamma != 0.0, 1500.0 * 0.9 * (points.gamma - np.sin(2.0 * points.gamma) / 2.0), 0.0
    )
    bent = points.replace(Fy=points.Fy + saturating)  # camber force 1350 N sin(2 gamma)/2
    result = measured(tyre, points=bent, camber_stiffness={"method": method, "angle_deg": 15.0})
    secant = 0.5 * math.sin(math.radians(30.0)) / math.radians(15.0)
    row = result.nominal
    expected, within = {"slope": (1.0, 0.03), "secant": (secant, 1e-3)}[method]
    assert row.C_gamma.value == pytest.approx(-1350.0 * expected, rel=within)
    assert row.secant_bias == pytest.approx((1.0 - tyre.epsilon) * (1.0 - secant), rel=0.5)
    assert row.epsilon_gamma.value == {"slope": row.epsilon_slope, "secant": row.epsilon_secant}[method]


def only(points, mask):
    return points.select(mask | (points.gamma == 0.0))


def test_a_camber_sweep_too_short_for_the_slope_gives_the_secant_and_says_so():
    tyre = Plain()
    points = tyre.campaign()
    short = only(points, np.abs(points.gamma) < 6.0 * DEGREE)
    result = measured(tyre, points=short, camber_stiffness={"method": "slope", "angle_deg": 5.0})
    assert result.epsilon_gamma.value == result.nominal.epsilon_secant
    assert "too short for the slope" in result.warnings[0]
    long = only(points, np.abs(points.gamma) < 16.0 * DEGREE)
    assert measured(tyre, points=long, camber_stiffness={"angle_deg": 5.0}).warnings == ()


def test_a_secant_beyond_the_sweep_gives_the_slope_and_says_so():
    tyre = Plain()
    points = tyre.campaign()
    result = measured(
        tyre,
        points=only(points, np.abs(points.gamma) < 21.0 * DEGREE),
        camber_stiffness={"method": "secant", "angle_deg": 30.0},
    )
    assert result.nominal.epsilon_secant is None
    assert result.epsilon_gamma.value == result.nominal.epsilon_slope
    assert "does not reach 30 deg" in result.warnings[0]


@pytest.mark.parametrize("backward", [True, False])
def test_a_force_towards_the_centre_is_refused_with_its_cause(backward):
    tyre = Plain()
    points = tyre.campaign(backward=backward)
    inward = points.replace(Fy=points.Fy - 2.0 * tyre.turn_slip_force(points.Fz))
    with pytest.raises(
        InputError, match="path_centre or axes are wrong" if backward else "sideslip misaligned"
    ):
        measured(tyre, points=inward)


def test_without_what_it_needs_there_is_no_factor():
    tyre = Plain()
    points = tyre.campaign()
    upright = points.select(points.gamma == 0.0)
    for chosen, radius, lacking in ((upright, True, "a camber sweep"), (points, False, "the rolling radius")):
        result = measured(tyre, points=chosen, radius=radius)
        assert result.epsilon_gamma is None
        assert result.pecp1 is None
        assert result.F_phit.value == pytest.approx(tyre.turn_slip_force(1500.0), abs=1.0)
        assert any(f"for lack of {lacking}" in w and " and the" not in w for w in result.warnings)


def test_a_flat_track_gives_stiffnesses_only():
    tyre = Plain()
    points = tyre.campaign(backward=False)
    flat = points.replace(Fy=points.Fy - tyre.turn_slip_force(points.Fz), phi_t=0.0)
    config = settings(type="flat-track", path_radius=None, u_path_radius=None)
    result = measure(config, flat, split(flat))
    assert result.C_alpha.value == pytest.approx(-12.0 * 1500.0, rel=0.01)
    assert result.C_gamma.value == pytest.approx(-0.9 * 1500.0, rel=0.004)
    assert result.F_phit is None
    assert result.epsilon_gamma is None
    assert result.notes == (wording.STRAIGHT_PATH, wording.UNKNOWN_WARMTH)
    assert result.warnings == ()


@pytest.mark.parametrize("friction", [0.8, 1.25])
@pytest.mark.parametrize("Fz", [900.0, 2250.0])
def test_the_cornering_stiffness_of_a_brush_is_within_what_is_stated(friction, Fz):
    """Parabolic pressure (Pacejka 2012, 3.2): its secant falls with |alpha| from zero on, as that of no smooth odd curve."""

    class Brush(Plain):
        def readings(self, alpha, gamma, Fz, direction):
            slides = np.minimum(self.cornering * np.abs(alpha) / (3.0 * friction), 1.0)
            slip = -np.sign(alpha) * friction * Fz * (1.0 - (1.0 - slides) ** 3)
            smooth, Mz = super().readings(0.0 * alpha, gamma, Fz, direction)
            return direction * slip + smooth, Mz

    found = measured(Brush(), (Fz,)).nominal.C_alpha
    assert abs(found.value + 12.0 * Fz) < 2.0 * found.u
    assert found.u < 0.06 * 12.0 * Fz


@pytest.mark.parametrize("least", [0.0, -41.0], ids=["camber one way", "camber both ways"])
def test_what_pushes_alike_at_every_angle_is_no_stiffness_of_a_flat_track(least):
    """90 N of conicity, and 0.06 deg of ply-steer: a ray from the origin would call both camber thrust."""
    tyre = Plain(alpha_0=0.06 * DEGREE)
    points = tyre.campaign(backward=False)
    points = points.select(points.gamma > least * DEGREE - 1e-6)
    flat = points.replace(Fy=points.Fy - tyre.turn_slip_force(points.Fz) + 90.0, phi_t=0.0)
    result = measure(settings(type="flat-track", path_radius=None, u_path_radius=None), flat, split(flat))
    for found, true in ((result.C_alpha, -12.0 * 1500.0), (result.C_gamma, -0.9 * 1500.0)):
        assert abs(found.value - true) < 2.0 * found.u
        assert found.u < 0.03 * abs(true)


def test_two_cambers_that_the_rig_holds_loosely_are_no_curve():
    """Readings of 1.59 and 1.60 deg are one set-point: their scatter tells no slope over camber."""
    tyre = Plain()
    points = tyre.campaign(backward=False)
    points = points.select(points.gamma == 0.0)
    lean = np.radians(np.repeat([1.6, 3.2], 6) + np.tile([-0.01, 0.0, 0.01], 4))
    leant = points.select(np.zeros(len(lean), dtype=int)).replace(alpha=0.0 * lean, gamma=lean)
    Fy, _ = tyre.readings(0.0 * lean, lean, leant.Fz, 1)
    both = concatenate([points, leant.replace(Fy=Fy)])
    flat = both.replace(Fy=both.Fy - tyre.turn_slip_force(both.Fz), phi_t=0.0)
    result = measure(settings(type="flat-track", path_radius=None, u_path_radius=None), flat, split(flat))
    assert result.C_alpha is not None
    assert result.C_gamma is None


def test_a_parabola_through_many_zeros_is_read_at_zero():
    """Five sideslip angles within 1.2 deg, forwards: the value at 0 of a curve that bends, not their mean."""
    tyre = Plain()
    points = tyre.campaign()
    bend = 4e5 * np.where(np.abs(points.gamma) > 0.0, 0.0, points.alpha**2)
    result = measured(tyre, points=points.replace(Fy=points.Fy + bend))
    assert result.nominal.F_forward == pytest.approx(tyre.turn_slip_force(1500.0), abs=1.0)


def test_the_note_on_load_is_one_of_the_notes():
    result = measured(Plain())
    assert result.carried.over_load.note.startswith("PECP2")
    assert result.carried.over_load.note in result.notes


def test_the_json_holds_value_and_uncertainty_of_every_quantity():
    result = measured(Plain())
    content = as_json.document(result)
    for key, found in (
        ("epsilon_gamma", result.epsilon_gamma), ("C_phit_Nm", result.nominal.C_phit), ("C_gamma_N_per_rad", result.C_gamma),
        ("C_alpha_N_per_rad", result.C_alpha), ("r_e_m", result.r_e), ("R_m", result.nominal.R), ("F_phit_N", result.F_phit),
    ):  # fmt: skip
        assert (content[key], content[f"u_{key}"]) == (found.value, found.u)
    row = content["per_load"][0]
    assert row["alpha_M_deg"] == pytest.approx(math.degrees(result.alpha_M.value))
    assert (row["F_forward_N"], row["load_N"]) == (result.nominal.F_forward, 1500.0)
    forwards = as_json.document(measured(Plain(), points=Plain().campaign(backward=False)))
    assert forwards["alpha_M_deg"] is forwards["u_alpha_M_deg"] is None


def test_the_nominal_load_is_the_one_next_to_it():
    result = measured(Plain(), (900.0, 1300.0, 2000.0))
    assert result.nominal.load == 1300.0
    assert result.r_e_loads == {1500.0: R_E}
    assert result.by_load("C_gamma").keys() == {900.0, 1300.0, 2000.0}


def test_the_sweeps_are_as_long_as_the_tests_say():
    assert len(SLIP) == 15
    assert len(LEAN) == 13


def test_the_property_file_names_what_was_measured_and_nothing_else():
    result = measured(Plain(), after=AfterFit(epsilon_gamma=-0.14))
    found, row = result.quantities(), result.nominal
    assert found["C_phit_Nm"] == row.C_phit
    assert found["C_gamma_N_per_rad"] == row.C_gamma
    assert found["C_alpha_N_per_rad"] == row.C_alpha
    assert (found["r_e_m"], found["R_m"], found["F_phit_N"]) == (row.r_e, row.R, row.F_phit)
    assert found["epsilon_gamma"].value == row.epsilon_gamma.value
    assert found["epsilon_gamma_debiased"] == row.epsilon_debiased
    assert (found["epsilon_gamma_model"].value, found["epsilon_gamma_model"].unit) == (-0.14, "-")
    assert (found["load_N"].value, found["load_N"].unit) == (1500.0, "N")
    assert len(found) == 10
    without_radius = measured(Plain(), radius=False).quantities()
    assert sorted(without_radius) == [
        "C_alpha_N_per_rad",
        "C_gamma_N_per_rad",
        "C_phit_Nm",
        "F_phit_N",
        "R_m",
        "load_N",
    ]


def test_the_comment_of_a_file_gives_no_uncertainty_to_what_has_none():
    found = measured(Plain(), after=AfterFit(epsilon_gamma=-0.1)).quantities()
    assert (found["load_N"].value, found["load_N"].u) == (pytest.approx(1500.0, rel=0.01), 0.0)
    assert (found["epsilon_gamma_model"].value, found["epsilon_gamma_model"].u) == (-0.1, 0.0)
