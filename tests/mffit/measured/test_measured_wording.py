"""Every fact that the direct method remarks becomes a sentence, and says the numbers of the fact."""

from __future__ import annotations

import math
from dataclasses import MISSING, fields

import pytest

from mffit.measured import LoadResult, Measured, notes, wording
from tir import Quantity

ANGLE = Quantity(math.radians(0.25), math.radians(0.02), "rad")

NOTES = [
    (notes.StraightPath(), "it has no turn slip to measure"),
    (notes.NotSeparable(-331.4, 0.97, 25.0), "-331 N at (0, 0) would take 0.97 deg of misalignment"),
    (notes.NotSeparable(-331.4, None, 25.0), "an unknown angle (no sideslip sweep gives C_alpha) of"),
    (
        notes.SeveralPaths((1.3, -1.3)),
        "combines the zeros of 2 paths (disc's centre 1.3 m to the left, 1.3 m to the right)",
    ),
    (
        notes.CamberSkew(Quantity(-0.1382, 0.0551, "deg")),
        "steers the wheel by -0.138 +- 0.055 deg times the sine",
    ),
    (notes.Aligned(ANGLE, 12.0, 0.04), "alpha_M = 0.250 +- 0.020 deg (12 N); uncorrected it would move"),
    (notes.LoadSlope(1.25, 0.1), "PECP2 = 1.250 +- 0.100 (k = 1)."),
    (notes.OneLoad(), "one load was measured"),
    (notes.SlopeInNoise(0.05, 0.07), "the slope 0.050 per nominal load is within 2 u = 0.140"),
    (notes.EpsilonInNoise(), "within 2 u of zero"),
    (notes.SlopeTooSteep(0.93), "would reach 0.93"),
    (notes.StandardUncertainties(), "k = 1"),
    (notes.Conicity(0.002, 3.0, 0.0096), "3 N (0.2 % of the load) would move eps_gamma by 0.010"),
    (notes.ContactWanders(), "R holds for the upright wheel"),
]
WARNINGS = [
    (notes.SlopeNotPossible(1500.0, 15.0), "at 1500 N the camber sweep is too short"),
    (notes.SecantNotPossible(1500.0, 15.0), "does not reach 15 deg"),
    (notes.NothingMeasured(), "eps_gamma could not be measured"),
    (
        notes.AxisOff(900.0, 64.2, 50.0, 0.213),
        "differ by 64 N (50 N is the limit): the sideslip axis is off by about 0.21",
    ),
    (
        notes.PathsContradict(1400.0, (1.3, -1.3), (Quantity(51.2, 3.0, "Nm"), Quantity(-20.0, 4.0, "Nm"))),
        "51 +- 3 Nm (disc's centre 1.3 m to the left), -20 +- 4 Nm (disc's centre 1.3 m to the right); look for",
    ),
    (
        notes.ZerosDisagree(900.0, True, ("a", "b"), (-120.0, 310.0)),
        "at 900 N the backward zeros of a and b are -120 N and 310 N, which are no readings of one path",
    ),
    (notes.Misaligned(ANGLE, -60.0, 0.2), "differ by 120 N"),
]


@pytest.mark.parametrize(("fact", "words"), NOTES)
def test_a_note_is_a_sentence_with_its_numbers(fact, words):
    said = wording.note(fact)
    assert words in said
    assert said.endswith(".")


@pytest.mark.parametrize(("fact", "words"), WARNINGS)
def test_a_warning_is_a_sentence_with_its_numbers(fact, words):
    assert words in wording.warning(fact)


def test_no_fact_is_without_words():
    assert {type(fact) for fact, _ in NOTES} == set(notes.Note.__args__)
    assert {type(fact) for fact, _ in WARNINGS} == set(notes.Trouble.__args__)


def at_one_load(*remarks):
    """eps_gamma with u 0.05 at one load, all of it known before the fit."""
    empty = dict.fromkeys((f.name for f in fields(LoadResult) if f.default is MISSING), None)
    row = LoadResult(
        **empty | {"load": 1400.0, "epsilon_gamma": Quantity(-0.1, 0.05, "-")}, u_monte_carlo=0.0501
    )
    return Measured((row,), row, -0.1, 0.0, 0.4, {}, False, remarks, ())


def test_random_draws_are_compared_with_what_they_draw():
    before = at_one_load(notes.Conicity(0.005, 7.0, 0.03))
    assert wording.by_draws(before) == "0.0501 by random draws"
    after = before.debiased(0.04)
    assert after.epsilon_gamma.u == pytest.approx(math.hypot(0.05, 0.03, 0.04))
    assert "leave out conicity and finite spin of the disc" in wording.by_draws(after)
    assert wording.by_draws(after).endswith("the budget gives 0.0500")


def test_the_reason_for_no_load_slope_is_the_one_that_applied():
    said = wording.why_no_slope(at_one_load(notes.ContactWanders(), notes.SlopeInNoise(0.02, 0.043)))
    assert said == wording.note(notes.SlopeInNoise(0.02, 0.043))
    assert wording.why_no_slope(at_one_load(notes.LoadSlope(0.4, 0.1))) == ""
