"""Evidence of a hypothesis against closed forms."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm
from small_programme import TYRE, U_FY, U_MZ, problem, programme, read

from mffit import config as configuration
from mffit.config.loading import STAND_IN
from mffit.diagnosis import constants
from mffit.diagnosis.hypothesis import Hypothesis
from mffit.diagnosis.priors import beyond_declaration, log_prior
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.diagnosis.selection import Contest
from mffit.diagnosis.stated import stated_noise
from mffit.diagnosis.ties import Separation, separation
from mffit.diagnosis.validation import gap, validate
from mffit.effects import CATALOG, Effect, Free
from mffit.least_squares import FreeNumber
from mffit.points import Points
from mffit.rig import Simulation
from mffit.rig_errors import Faults
from tir import Tyre

BY_ID = {effect.id: effect for effect in CATALOG}
OFFSET = BY_ID["loadcell-offset-fy"]


@pytest.mark.parametrize("offset", [0.0, 5.0, -20.0])
def test_evidence_of_an_offset_in_closed_form(offset):
    """Gaussian noise and a Gaussian prior: the integral over the one number is exact."""
    points = read(programme(), faults=Faults(F0_N=offset), noise=1)
    chosen = problem(points)
    found = chosen.fit((OFFSET,))
    residual = points.Fy - Simulation.of(TYRE).readings(points).Fy
    n, spread = len(points), OFFSET.free[0].spread
    precision = n / U_FY**2 + 1.0 / spread**2
    value = residual.sum() / U_FY**2 / precision
    assert found.numbers["F0_N"] == pytest.approx(value, rel=1e-4, abs=1e-4)
    assert found.stderr["F0_N"] == pytest.approx(precision**-0.5)
    gained = 0.5 * value**2 * precision - 0.5 * math.log(1.0 + n * spread**2 / U_FY**2)
    assert found.log_evidence - chosen.null.log_evidence == pytest.approx(gained, rel=1e-4, abs=1e-3)
    assert chosen.null.chi2 == pytest.approx(
        np.sum((residual / U_FY) ** 2)
        + np.sum(((points.Mz - Simulation.of(TYRE).readings(points).Mz) / U_MZ) ** 2)
    )
    assert found.chi2 == pytest.approx(
        chosen.null.chi2 - 2.0 * value * residual.sum() / U_FY**2 + n * (value / U_FY) ** 2
    )


@pytest.mark.parametrize(
    ("free", "spread"),
    [
        (Free("QSX3", 0.15), 0.15),
        (Free("QSY1", 0.15, relative=True), 0.15 * float(TYRE["QSY1"])),
        (Free("QSX12", 0.5, relative=True), 0.5 * 0.2 * 10.0),
    ],
)
def test_a_number_without_influence_keeps_its_spread_and_adds_no_evidence(free, spread):
    """The spread is relative to the coefficient, or to a fifth of its usual range if the model has it at zero."""
    chosen = problem(read(programme(), noise=2))
    found = chosen.fit((Effect("x", "x", "tyre", "", (free,)),))
    assert found.stderr[free.name] == pytest.approx(spread)
    assert found.numbers[free.name] == pytest.approx(float(TYRE[free.name]))
    assert found.log_evidence == pytest.approx(chosen.null.log_evidence)


@pytest.mark.parametrize("play", [0.15, 0.3])
def test_an_effect_without_slope_at_zero_is_found_from_its_scan(play):
    """Forces are even in the play: only a start away from zero finds it."""
    chosen = problem(read(programme(), faults=Faults(backlash_deg=play)))
    found = chosen.fit((BY_ID["backlash"],))
    assert found.numbers["backlash_deg"] == pytest.approx(play, abs=0.01)
    assert found.chi2 < 0.05 * chosen.null.chi2


def test_numbers_of_one_effect_may_have_different_scans():
    """The play has three starts, the load cell one."""
    points = read(programme(), faults=Faults(backlash_deg=0.3, F0_N=10.0))
    loose = Effect("loose", "loose", "rig", "", (*BY_ID["backlash"].free, *OFFSET.free))
    found = problem(points).fit((loose,))
    assert found.numbers == {
        "backlash_deg": pytest.approx(0.3, abs=0.01),
        "F0_N": pytest.approx(10.0, abs=0.3),
    }


def test_turn_slip_is_switched_on():
    """A simulation without spin misses the turn-slip force of the disc; the switch has no standard error."""
    points = read(programme())
    start = Simulation.of(TYRE, turn_slip=False)
    found = DiagnosisProblem(points, start, stated_noise(points)).fit((BY_ID["turn-slip"],))
    assert dict(found.numbers) == {"turn_slip": 1.0}
    assert found.chi2 == pytest.approx(0.0, abs=1e-9)
    assert not found.stderr


def test_two_hidden_effects_are_fitted_together():
    true = TYRE.replace(PKY6=1.1 * float(TYRE["PKY6"]))
    chosen = problem(read(programme(), true, Faults(M0_Nm=1.5)))
    found = chosen.fit((BY_ID["camber-stiffness"], BY_ID["loadcell-offset-mz"]))
    assert found.numbers["PKY6"] == pytest.approx(true["PKY6"], rel=0.01)
    assert found.numbers["M0_Nm"] == pytest.approx(1.5, abs=0.05)
    assert found.residual @ found.residual == pytest.approx(found.chi2)


def test_a_channel_that_was_not_measured_is_ignored():
    points = read(programme(), faults=Faults(F0_N=12.0, M0_Nm=2.0), noise=3)
    without = points.replace(Mz=np.nan, u_Mz=np.inf)
    assert len(problem(without).null.residual) == len(points)
    found = problem(without).fit((OFFSET,))
    assert found.numbers["F0_N"] == pytest.approx(problem(points).fit((OFFSET,)).numbers["F0_N"], rel=1e-6)


def contest(**evidence: float) -> Contest:
    """A first place of rig effects whose prior grows with the length of their name; no effect has evidence 0."""
    nothing = np.empty(0)

    def hypothesis(effects, value):
        return Hypothesis(effects, {}, {}, 0.0, value, Simulation.of(TYRE), nothing, np.empty((0, 0)))

    trials = [
        hypothesis((Effect(name, name, "rig", "", (Free("F0_N", 1.0),), prior=0.5 * (len(name) - 1)),), value)
        for name, value in evidence.items()
    ]
    return Contest(hypothesis((), 0.0), tuple(trials), 4.0, Simulation.of(TYRE))


def test_weights_are_evidence_times_prior_and_add_up():
    found = contest(a=3.0, bb=2.0, c=-1.0).weights()
    logs = {"a": 3.0 - math.log(3), "bb": 2.5 - math.log(3), "c": -1.0 - math.log(3), "none": 0.0}
    total = sum(math.exp(v) for v in logs.values())
    assert found == pytest.approx({name: math.exp(v) / total for name, v in logs.items()})
    assert sum(found.values()) == pytest.approx(1.0)


def test_a_coefficient_at_zero_is_likelier_to_be_missing():
    absent, present = TYRE.replace(PVY3=0.0), TYRE.replace(PVY3=0.4)
    effect = BY_ID["camber-thrust-curvature"]
    one, other = (log_prior(effect, Simulation.of(tyre)) for tyre in (absent, present))
    assert one - effect.prior == effect.prior - other == 1.0
    for name in ("loadcell-offset-fy", "turn-slip", "relaxation"):
        assert log_prior(BY_ID[name], Simulation.of(TYRE)) == BY_ID[name].prior


DISC = configuration.load(
    {"tyre": {"name": "t", **STAND_IN}, "rig": {"path_radius": 1.323}, "sweep": [{"file": "a.csv"}]}
)
NOISE = {"Fy": U_FY, "Mz": U_MZ}


def between(points: Points, tyre: Tyre = TYRE, **faults: float) -> Separation:
    """The run that separates a tyre and rig errors from the tyre of the programme on a rig without errors."""
    null = problem(points).null
    return separation(DISC, points, null, replace(null, state=Simulation.of(tyre, Faults(**faults))), NOISE)


def test_expected_chi2_between_two_offsets_is_their_square_at_every_point():
    """The two differ alike in all runs; the shortest has 9 points: (9/6)^2 and (0.3/0.6)^2 each."""
    points = read(programme())
    assert between(points, F0_N=9.0, M0_Nm=0.3).chi2 == pytest.approx(9 * (1.5**2 + 0.5**2))
    null = problem(points).null
    other = replace(null, state=Simulation.of(TYRE, Faults(F0_N=9.0, M0_Nm=0.3)))
    only_force = separation(DISC, points, null, other, NOISE | {"Mz": math.nan})
    assert only_force.chi2 == pytest.approx(9 * 1.5**2)


@pytest.mark.parametrize(
    ("faults", "words"),
    [
        ({"k_V_per_mps": 0.01}, "2 times the speed"),
        ({"k_T_grip_per_K": 0.01, "T_ref_degC": 25.0}, "20 K warmer"),
        ({"k_t_per_s": 1e-5}, "at the end of the test"),
    ],
)
def test_what_changes_with_a_condition_is_seen_where_it_is_another(faults, words):
    assert words in between(read(programme()), **faults).run


def test_a_pressure_is_proposed_for_what_depends_on_it():
    found = between(read(programme()), TYRE.replace(PPY1=TYRE["PPY1"] + 0.5))
    assert "another pressure" in found.run
    assert found.worthwhile


def test_runs_can_be_added_to_a_continuous_recording():
    """The added points are steady, the recorded ones are not."""
    points = read(programme())
    moving = points.replace(continuous=True, time=np.linspace(0.0, 99.0, len(points)))
    assert between(moving, F0_N=9.0).chi2 == pytest.approx(9 * 1.5**2)


def test_the_gap_in_numbers():
    points = read(programme(), faults=Faults(F0_N=9.0, M0_Nm=-1.2))
    chosen = problem(points)
    found = gap(chosen.measured - chosen.start.predict(points), chosen.noise)
    assert found.rms("Fy") == pytest.approx(9.0)
    assert found.rms("Mz") == pytest.approx(1.2)
    assert found.chi2_per_dof == pytest.approx(0.5 * (1.5**2 + 2.0**2))


def test_a_sweep_left_out_is_predicted_from_the_others():
    """An offset of 12 N in all sweeps but one, which lacks it: left out, that one is off by what the others say."""
    points = read(programme(), faults=Faults(F0_N=12.0))
    odd_one = points.sweep == 4
    points = points.replace(Fy=np.where(odd_one, points.Fy - 12.0, points.Fy))
    chosen = problem(points)
    checked = validate(chosen, chosen.fit((OFFSET,)))
    assert checked.folds == 5
    n, m = len(points), int(odd_one.sum())
    assert checked.gap_before.rms("Fy") == pytest.approx(12.0 * math.sqrt((n - m) / n))
    squares = 0.0
    for k in range(5):
        out = points.sweep == k
        rest = np.where(odd_one, 0.0, 12.0)[~out]
        predicted = rest.sum() / U_FY**2 / (len(rest) / U_FY**2 + 1.0 / 10.0**2)
        squares += float(np.sum((np.where(odd_one, 0.0, 12.0)[out] - predicted) ** 2))
    assert checked.gap_after.rms("Fy") == pytest.approx(math.sqrt(squares / n), rel=1e-3)


def test_without_an_effect_the_gap_stays():
    chosen = problem(read(programme(), noise=5))
    nothing = validate(chosen, chosen.null)
    assert nothing.gap_before == nothing.gap_after


@pytest.mark.parametrize(("value", "u"), [(0.3, 0.1), (2.5, 0.1), (2.5, 1.0), (-6.0, 2.5)])
def test_a_declaration_is_the_prior_of_all_rigs_but_a_few(value, u):
    """Against the usual size, 2 around 0; a declaration may be wrong, and wider than usual it never favours an effect."""
    known = FreeNumber("F0_N", 0.0, expected=0.0, spread=2.0)
    ratio = norm.pdf(value, 0.5, u) / norm.pdf(value, 0.0, 2.0) * max(u / 2.0, 1.0)
    worse = float(constants.RIGS_WORSE_THAN_DECLARED)
    found = beyond_declaration(known, value, {"F0_N": (0.5, u)})
    assert found == pytest.approx(min(math.log((1.0 - worse) * ratio + worse), 0.0), abs=1e-12)
    assert beyond_declaration(known, value, {}) == 0.0
