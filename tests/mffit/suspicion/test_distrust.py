"""The one rule of trust: what is not to be trusted, what is in doubt, and what limits a result that is sound."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import norm

from mffit.linearised import LinearisedFit
from mffit.measured.result import LoadResult, SideslipReading, SideslipZeros
from mffit.points import make_points
from mffit.rig import Readings
from mffit.suspicion import (
    FinishedFit,
    HeldNumber,
    JudgedMeasurement,
    LeftOutSweeps,
    Trust,
    judge,
)
from tir import Quantity

RNG = np.random.default_rng(3)
SWEEPS, EACH, U = 10, 20, 6.0
NAMES = tuple(f"sweep_{k}" for k in range(SWEEPS))
SWEEP = np.repeat(np.arange(SWEEPS), EACH)


def judged(
    off: np.ndarray, *, u: float = U, r2: float = 0.999, lean: float = 0.0, lines: int = 1, **more
) -> Trust:
    """The judgement of a model that misses Fy of ten sweeps of 20 points by ``off`` (200,) [N]."""
    n = len(off)
    points = make_points(
        0.0, np.radians(lean), 1500.0, Fy=np.zeros(n), Mz=np.nan, u_Fy=u, p=2e5, V=11.0, phi_t=0.0, sweep=SWEEP[:n],
        sweep_names=NAMES, line=1, last_line=lines,
    )  # fmt: skip
    used = {"Fy": np.ones(n, bool), "Mz": np.zeros(n, bool)}
    fit = FinishedFit(
        points=points, model=Readings(Fy=off, Mz=np.zeros(n)), used=used, r2={"Fy": r2, "Mz": np.nan}, **more
    )
    return judge(fit)


def noise(scale: float = 1.0) -> np.ndarray:
    """Exactly ``scale`` times the stated noise in every sweep."""
    return scale * U * np.tile([1.0, -1.0], SWEEPS * EACH // 2)


def test_a_fit_at_the_noise_is_trusted_without_doubt():
    found = judged(noise())
    assert found.trusted
    assert found.doubts == found.remarks == ()
    assert found.over_noise["Fy"] == pytest.approx(1.0)


def test_without_a_stated_noise_there_is_no_misfit_over_it():
    assert np.isnan(judged(noise(), u=np.nan).over_noise["Fy"])


@pytest.mark.parametrize(
    ("proof", "trusted", "doubted"), [(4.4, True, False), (12.4, True, True), (12.6, False, False)]
)
def test_noise_that_model_error_may_be_counts_by_its_evidence(proof, trusted, doubted):
    """Half of the squares of three and of five standard deviations; the misfit is twice the stated noise."""
    channel = SimpleNamespace(
        components=SimpleNamespace(noise=1.8), proof_of_noise=proof, misfit=2.0, rows=np.arange(200),
        is_proven=False, size=0.0,
    )  # fmt: skip
    found = judged(noise(2.0), linear=SimpleNamespace(channels={"Fy": channel}, numbers=()))
    assert found.trusted == trusted
    assert bool(found.doubts) == doubted


@pytest.mark.parametrize(
    ("scale", "trusted", "doubted"),
    [(1.19, True, False), (1.25, True, True), (1.49, True, True), (1.51, False, False)],
)
def test_the_misfit_is_in_doubt_from_1_2_and_not_trusted_from_1_5(scale, trusted, doubted):
    found = judged(noise(scale))
    assert found.trusted == trusted
    assert bool(found.doubts) == doubted


def test_the_scatter_within_rests_is_exceeded_with_a_doubt():
    """Points that are means of a hundred lines state the error of the mean; nobody said that rests differ by no more."""
    found = judged(noise(3.0), lines=100, linear=LinearisedFit((), {}))
    assert found.trusted
    assert not judged(noise(3.0), linear=LinearisedFit((), {})).trusted
    assert "3 times the scatter within its rests" in found.doubts[0]


@pytest.mark.parametrize(
    ("sigma", "trusted", "doubted"),
    [(3.4, True, False), (3.6, True, True), (4.9, True, True), (5.1, False, False)],
)
def test_sideslip_zeros_are_in_doubt_from_3_5_and_not_trusted_from_5_standard_deviations(
    sigma, trusted, doubted
):
    """With a fit and without one."""
    angle = Quantity(0.006, 0.0002, "rad")
    one, other = SideslipReading(900.0, -0.75, angle), SideslipReading(1500.0, 0.75, angle)
    zeros = SideslipZeros("A", float(norm.sf(sigma)), one, other)
    points = make_points(0.0, 0.0, 1500.0, Fy=0.0, Mz=np.nan, p=2e5, V=11.0, phi_t=0.0)
    for found in (
        judge(JudgedMeasurement(points=points, sideslip_zeros=(zeros,))),
        judged(noise(), sideslip_zeros=(zeros,)),
    ):
        assert found.trusted == trusted
        assert bool(found.doubts) == doubted
        for sentence in (*found.reasons, *found.doubts):
            assert "0.344 +- 0.011 deg at 900 N (path centre 1.333 m to the left)" in sentence


def test_few_readings_may_miss_by_chance():
    """Two of chi-square for 4 readings at 1.6 times the noise: p = 0.04."""
    assert judged(noise(1.6)[:4]).trusted


def test_one_sweep_far_off_is_told_although_the_total_is_not():
    """One of ten sweeps at 3 times the noise: the total is sqrt(1.8) = 1.34."""
    off = noise()
    off[SWEEP == 3] *= 3.0
    found = judged(off, cause="a load that was wrong", cause_is_certain=True)
    (said,) = found.reasons
    assert "sweep_3 by 3.0 times" in said
    assert "a load that was wrong" in said


def test_a_sweep_at_the_limit_of_chance_is_not_told():
    """20 readings at 1.7 times the noise: chi-square 57.8, p = 2e-5, which is 4.2 standard deviations."""
    off = noise()
    off[SWEEP == 3] *= 1.7
    assert judged(off).reasons == ()


def test_a_doubt_names_the_worst_sweep_and_what_would_explain_it():
    off = noise(1.3)
    off[SWEEP == 4] *= 1.2
    (said,) = judged(off, cause="tyre temperature", cause_is_certain=True).doubts
    assert "sweep_4" in said
    assert "tyre temperature" in said
    (said,) = judged(off, cause="tyre temperature", cause_is_certain=False).doubts
    assert "no known effect explains it" in said


@pytest.mark.parametrize("undeclared", ["", "u_alpha_0_deg"])
def test_an_effect_behind_most_of_the_misfit_is_a_doubt_without_a_stated_noise(undeclared):
    more = {"u": np.nan, "cause": "a lag of the tyre", "cause_is_certain": True, "undeclared": undeclared}
    assert judged(noise(), **more).doubts == ()
    found = judged(noise(), **more, cause_is_most=True)
    assert found.trusted
    (said,) = found.doubts
    assert "a lag of the tyre" in said


def test_the_sweeps_with_most_of_the_misfit_are_named_worst_first():
    off = noise()
    off[SWEEP == 7] *= 20.0
    off[SWEEP == 2] *= 25.0
    assert "most in sweep_2 (25.0 times), sweep_7 (20.0 times);" in judged(off).reasons[0]


def test_a_model_explains_half_of_the_variance_or_is_not_trusted():
    """Its misfit follows a slow curve in every sweep, beside which neighbouring readings hardly scatter."""
    off = noise(0.1) + U * np.tile(np.sin(np.linspace(0.0, 6.0, EACH)), SWEEPS)
    assert judged(off, u=np.nan, r2=0.51).trusted
    assert "49 %" in judged(off, u=np.nan, r2=0.49).reasons[0]
    assert " 0 %" in judged(off, u=np.nan, r2=-3.0).reasons[0]


def test_a_misfit_that_is_the_scatter_of_neighbours_leaves_nothing_to_explain():
    """Whether a noise is stated or not."""
    off = RNG.normal(0.0, U, SWEEPS * EACH)
    assert judged(off, u=np.nan, r2=0.04).trusted
    assert judged(off, r2=0.04).trusted


@pytest.mark.parametrize(("times", "named"), [(4.0, False), (40.0, True)])
def test_a_sweep_without_a_stated_noise_is_judged_by_the_others_and_its_own_scatter(times, named):
    """Nine sweeps scatter by 6 N; the tenth scatters as they do about an offset."""
    off = RNG.normal(0.0, U, SWEEPS * EACH)
    off[SWEEP == 3] += times * U
    u = np.where(SWEEP == 3, np.nan, U)
    reasons = judged(off, u=u).reasons
    assert any("sweep_3" in reason for reason in reasons) == named
    assert judged(np.where(SWEEP == 3, 1.0, off), u=u).trusted


@pytest.mark.parametrize(("scale", "trusted"), [(1.0, True), (0.11, True), (0.09, False), (1.25, False)])
def test_a_channel_with_nothing_but_its_stated_noise_has_nothing_to_explain(scale, trusted):
    """Mx of a wheel that is only driven and braked; readings far below their noise are in another unit."""
    assert judged(noise(scale), r2=0.1).trusted == trusted


@pytest.mark.parametrize(
    ("scale", "n", "said"), [(0.09, 50, True), (0.11, 50, False), (0.09, 4, True), (0.09, 3, False)]
)
def test_a_misfit_far_below_the_noise_is_a_unit(scale, n, said):
    doubts = judged(noise(scale)[:n]).doubts
    assert any("check the units of Fy_N and u_Fy_N" in doubt for doubt in doubts) == said


def test_without_a_stated_noise_left_out_sweeps_decide():
    """Fy varies by 100 N; the median sweep is predicted to 80 N, which leaves 64 % of the variance."""

    def told(typical: float, u: float) -> tuple[str, ...]:
        n = SWEEPS * EACH
        Fy = np.tile([100.0, -100.0], n // 2)
        points = make_points(
            0.0, 0.0, 1500.0, Fy=Fy, u_Fy=u, p=2e5, V=11.0, phi_t=0.0, sweep=SWEEP, sweep_names=NAMES
        )
        used = {"Fy": np.ones(n, bool), "Mz": np.zeros(n, bool)}
        left_out = {"Fy": LeftOutSweeps(SWEEPS, 10.0, 200.0, typical)}
        return judge(
            FinishedFit(
                points=points,
                model=Readings(Fy=Fy, Mz=Fy),
                used=used,
                r2={"Fy": 1.0, "Mz": np.nan},
                left_out=left_out,
            )
        ).reasons

    assert "explains 36 % of the variance of Fy in a sweep to which it is not fitted" in told(80.0, np.nan)[0]
    assert told(60.0, np.nan) == ()
    assert told(80.0, U) == ()


@pytest.mark.parametrize(("left", "trusted"), [(12.0, True), (12.5, False)])
def test_a_search_that_is_stuck_is_not_trusted_whatever_its_misfit(left, trusted):
    held = (HeldNumber("PPX4", 1.0, 0.0),)
    for u in (U, np.nan):
        found = judged(noise(), u=u, left=left, held=held)
        assert found.trusted == trusted
        assert trusted or ("stuck" in found.reasons[0] and "PPX4" in found.reasons[0])


@pytest.mark.parametrize(
    ("sigma", "share", "counts"), [(4.9, 0.2, False), (5.1, 0.2, True), (9.0, 0.01, False)]
)
def test_a_limit_counts_if_the_readings_contradict_it_and_it_matters(sigma, share, counts):
    """One of the curves is a reason; one of published tyres is a question, with the key that widens it."""
    of_curves = (HeldNumber("PCY1", sigma, share, physical=True),)
    assert judged(noise(), held=of_curves).trusted != counts
    assert judged(noise(), u=np.nan, held=of_curves).trusted  # a real tyre is not the formula
    of_tyres = judged(noise(), held=(HeldNumber("PCY1", sigma, share),))
    assert of_tyres.trusted
    assert any("PCY1 = { min = ..., max = ... }" in said for said in of_tyres.doubts) == counts


@pytest.mark.parametrize(
    ("sigma", "share", "counts"), [(4.9, 0.9, False), (26.0, 0.49, False), (26.0, 0.51, True)]
)
def test_what_is_set_by_hand_counts_if_most_of_the_misfit_is_due_to_it(sigma, share, counts):
    """Stated noise or not: no model error has to be found for it."""
    for u in (U, np.nan):
        found = judged(noise(), u=u, held=(HeldNumber("PDY1", sigma, share, by_hand=True),))
        assert found.trusted != counts
        assert any("[coefficients] sets for PDY1" in said for said in (*found.reasons, *found.doubts))


def test_what_check_refuses_is_a_reason():
    (said,) = judged(noise(), broken=("FZMIN 500 is not below FZMAX 400",)).reasons
    assert "FZMIN 500" in said


def camber_reduction(value: float, radius_counts: bool = True, lean: float = 40.0, **of_row: float) -> Trust:
    """The judgement of a measured factor of a tyre that was leaned as far as ``lean`` [deg]."""
    units = {"R": "m", "C_gamma": "N/rad", "C_alpha": "N/rad"}
    row = {name: Quantity(x, 0.0, units[name]) for name, x in of_row.items()}
    nominal = LoadResult(1500.0, epsilon_gamma=Quantity(value, 0.03, "-"), **row)
    return judged(noise(), lean=lean, nominal=nominal, radius_counts=radius_counts)


@pytest.mark.parametrize(
    ("value", "lean", "asked"),
    [
        (-0.49, 40.0, True), (-0.47, 40.0, False), (0.35, 40.0, False), (0.37, 40.0, True),
        (-0.49, 6.0, True), (-0.47, 6.0, False), (0.58, 6.0, False), (1.19, 6.0, False), (1.21, 6.0, True),
    ],
)  # fmt: skip
def test_outside_the_published_range_eps_gamma_is_asked_for(value, lean, asked):
    """Five standard deviations of six motorcycle tyres, -0.06 +- 0.084; upright ones may be tyres of cars and trucks, too."""
    found = camber_reduction(value, lean=lean)
    assert found.trusted
    assert any("outside everything published" in said for said in found.doubts) == asked


def test_a_diameter_entered_as_radius_is_named_with_its_number():
    """1 - eps_gamma is proportional to 1 / R: 0.485 at 1.32 m is -0.03 at 0.66 m."""
    (said,) = camber_reduction(0.485, R=1.32, C_gamma=-2000.0, C_alpha=-18000.0).doubts
    assert "diameter entered as the path radius (with a path radius of 0.66 m" in said
    assert "it would be -0.03" in said


def test_a_halved_radius_and_a_skew_are_named_with_their_numbers():
    """-1.10 at 0.66 m is -0.05 at 1.32 m. The usual -0.06 has a C_gamma of 1.06 / 2.10 of -4000, 1981 N/rad less, which 6.3 deg
    of skew make of 18000 N/rad."""
    (said,) = camber_reduction(-1.10, R=0.66, C_gamma=-4000.0, C_alpha=-18000.0).doubts
    assert "radius of 1.32 m" in said
    assert "it would be -0.05" in said
    assert "camber_skew_deg would have to be +6.3" in said


def test_a_reversed_sign_comes_first_if_it_would_explain_the_value():
    (said,) = camber_reduction(2.07, R=1.32).doubts
    assert (
        "likeliest causes: a reversed sign of camber or path_centre (with the other sign it would be -0.07)"
        in said
    )


def test_a_radius_that_cancels_is_not_blamed():
    (said,) = camber_reduction(0.6, R=1.32, radius_counts=False).doubts
    assert "does not change it" in said


@pytest.mark.parametrize(("count", "doubted"), [(3, False), (12, True)])
def test_a_file_that_limits_decide_is_in_doubt(count, doubted):
    found = judged(noise(), at_limits=tuple(f"P{k}" for k in range(count)), free=90)
    assert found.trusted
    assert any(f"{count} of 90 fitted coefficients" in said for said in found.doubts) == doubted


@pytest.mark.parametrize(
    ("name", "value", "u", "doubted"),
    [
        ("k_T_stiffness_per_K", 0.0032, 0.001, True),
        ("k_T_stiffness_per_K", 0.0032, 0.002, False),
        ("k_T_stiffness_per_K", -0.013, 0.001, False),
        ("k_T_grip_per_K", 0.0032, 0.001, False),
        ("hysteresis_deg", -0.03, 0.005, True),
        ("hysteresis_deg", 0.03, 0.005, False),
        ("F0_N", -30.0, 1.0, False),
    ],
)
def test_a_sign_that_no_other_tyre_has_is_a_doubt(name, value, u, doubted):
    """Rubber softens as it warms up, and a force lags behind its angle; friction may rise, and a zero have either sign."""
    found = judged(noise(), rig={name: (value, u)})
    assert found.trusted
    assert any("has the other sign" in said for said in found.doubts) == doubted
