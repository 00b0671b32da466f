"""Every remark of the direct method is a sentence that holds the numbers of its fact."""

from __future__ import annotations

import math
from dataclasses import MISSING, fields, replace

import pytest

from mffit.measured import Contribution, LoadResult, Measured, wording
from mffit.measured.result import CarriedEpsilon, LoadDependence
from tir import Quantity

ANGLE, AXIS, TYRE = (
    Quantity(math.radians(x), math.radians(u), "rad") for x, u in ((0.25, 0.02), (0.07, 0.06), (0.18, 0.06))
)


def at_zero(**more):
    """The zeros of one load both ways."""
    known = {"alpha_M": ANGLE, "misalignment": AXIS, "ply_steer": TYRE, "paths": (-1.0 / 1.3,)}
    known |= {"F_phit": Quantity(-331.4, 5.0, "N"), "C_alpha": Quantity(-19575.0, 90.0, "N/rad")}
    return LoadResult(load=1500.0, epsilon_gamma=Quantity(-0.1, 0.05, "-"), **known | more)


NOTES = [
    (wording.STRAIGHT_PATH, "it has no turn slip to measure"),
    (wording.UNKNOWN_WARMTH, "loses 6 % along each sweep is 3 % stiffer when cold"),
    (
        wording.alignment(at_zero(alpha_M=None), 25.0),
        "If the force -331 N at (0, 0) were not turn slip, it would take 0.97 deg of misalignment",
    ),
    (
        wording.alignment(at_zero(alpha_M=None, C_alpha=None), 25.0),
        "an unknown angle (no sideslip sweep gives C_alpha) of",
    ),
    (
        wording.off_nominal_pressure(250.2e3, 290e3),
        "holds at 250 kPa, that of most sweeps; the nominal pressure is 290 kPa",
    ),
    (
        wording.camber_skew(Quantity(-0.1382, 0.0551, "deg")),
        "steers the wheel by -0.138 +- 0.055 deg times the sine",
    ),
    (
        wording.alignment(at_zero(), 100.0),
        "misalignment plus ply-steer alpha_M = 0.250 +- 0.020 deg (-85 N); uncorrected it would move eps_gamma by 0.28. By usual "
        "sizes of both, misalignment is 0.070 +- 0.060 deg and ply-steer 0.180 +- 0.060 deg",
    ),
    (wording.alignment(at_zero(), 25.0), "exceeds what the alignment is declared to leave"),
    (wording.conicity_measured(Quantity(12.31, 2.04, "N")), "the conicity force is 12.3 +- 2.0 N"),
    (wording.load_slope(1.25, 0.1), "PECP2 = 1.250 +- 0.100 (k = 1)."),
    (wording.ONE_LOAD, "one load was measured"),
    (wording.slope_in_noise(0.05, 0.07), "the slope 0.050 per nominal load is within 2 u = 0.140"),
    (wording.EPSILON_IN_NOISE, "within 2 u of zero"),
    (wording.slope_too_steep(0.93), "would reach 0.93"),
    (wording.steering(0.004, 0.0331), "yields by 0.004 deg per Nm of Mz would change it by 3.3 %"),
]
WARNINGS = [
    (
        wording.taken_elsewhere(900.0, 1500.0, 250e3, {"lean": 200e3}, ["a camber sweep at zero sideslip"]),
        "at 900 N and not at 1500 N, the load nearest to the nominal one: at the main pressure of 250 kPa there is no complete "
        "measurement there, for lack of a camber sweep at zero sideslip; lean (200 kPa) ran at 1500 N and another pressure",
    ),
    (
        wording.camber_skew_beyond(Quantity(0.4907, 0.0212, "deg"), 0.1),
        "a camber skew of 0.491 +- 0.021 deg, and 0.1 deg are declared (u_camber_skew_deg)",
    ),
    (wording.guessed_stiffness(1400.0), "sideslip sweep at 1400 N gives C_alpha"),
    (wording.slope_not_possible(1500.0, 15.0), "at 1500 N the camber sweep is too short"),
    (wording.secant_not_possible(1500.0, 15.0), "does not reach 15 deg"),
    (
        wording.nothing_measured(wording.lacking(camber=False, zeros=True, radius=False)),
        "for lack of a camber sweep at zero sideslip and the rolling radius",
    ),
    (wording.nothing_measured([]), "at different loads"),
    (
        wording.paths_contradict(
            1400.0, (1.3, -1.3), (Quantity(51.2, 3.0, "Nm"), Quantity(-20.0, 4.0, "Nm"))
        ),
        "51 +- 3 Nm (disc's centre 1.3 m to the left), -20 +- 4 Nm (disc's centre 1.3 m to the right); look for",
    ),
    (
        wording.zeros_disagree(900.0, "backward", ("a", "b"), (-120.0, 310.0)),
        "at 900 N the backward zeros of a and b are -120 N and 310 N; these zeros cannot come from one path",
    ),
    (wording.alignment(at_zero(misalignment=ANGLE), 25.0), "differ by 171 N"),
]


@pytest.mark.parametrize(("note", "words"), NOTES)
def test_a_note_is_a_sentence_with_its_numbers(note, words):
    assert words in note
    assert note.endswith(".")


@pytest.mark.parametrize(("warning", "words"), WARNINGS)
def test_a_warning_is_a_sentence_with_its_numbers(warning, words):
    assert words in warning


OF_RESULTS = {"lacking", "OtherEstimate", "beside_the_file", "expanded", "advice"}
OF_SETUPS = {
    "setup_without_zeros", "sweeps_without_setup", "last_is_aligned", "setup_misaligned", "setup_scatter",
}  # fmt: skip
"""Tested with the records that they are about, and in test_setups."""


def test_every_remark_is_tested():
    public = {name: value for name, value in vars(wording).items() if not name.startswith("_")}
    sentences = [x for x in public.values() if isinstance(x, str)]
    functions = [x for x in public.values() if getattr(x, "__module__", "") == wording.__name__]
    remarks = {x.__name__ for x in functions} - OF_RESULTS - OF_SETUPS
    assert set(sentences) <= {text for text, _ in (*NOTES, *WARNINGS)}
    assert (
        len({text for text, _ in (*NOTES, *WARNINGS)}) == len(sentences) + len(remarks) + 5
    )  # one in five forms, one in two


def at_one_load(budget=(), **more):
    """eps_gamma with u 0.05 at one load, all of it known before the fit."""
    empty = dict.fromkeys((f.name for f in fields(LoadResult) if f.default is MISSING), None)
    known = {"load": 1400.0, "epsilon_gamma": Quantity(-0.1, 0.05, "-"), "budget": budget}
    row = LoadResult(**empty | known, **more)
    return Measured((row,), row, None, {}, False, (), ())


def carrying(source, value):
    """A tyre with eps_gamma -0.1 +- 0.05, of which the finite spin adds 0.02, and a file that carries another value."""
    file = CarriedEpsilon(source, Quantity(value, 0.03, "-"), LoadDependence(0.0, None, ""))
    debiased = Quantity(-0.12, 0.045, "-")
    return replace(at_one_load(epsilon_debiased=debiased), carried=file)


@pytest.mark.parametrize(
    ("source", "value", "others"),
    [
        ("direct", -0.1, {"debiased": "adds +0.020 to what is measured"}),
        ("debiased", -0.12, {"measured": "adds +0.020"}),
        ("model", -0.2, {"measured": "2.0 u apart", "debiased": "adds +0.020 to what is measured"}),
    ],
)
def test_every_other_estimate_stands_beside_that_of_the_file_with_a_reason(source, value, others):
    found = wording.beside_the_file(carrying(source, value))
    assert {one.name: one.value.value for one in found} == {
        name: {"measured": -0.1, "debiased": -0.12}[name] for name in others
    }
    assert all(one.why.endswith(others[one.name]) for one in found)


def test_the_expanded_uncertainty_is_told_with_its_factor():
    budget = (Contribution("noise", 1.0, "N", 0.05, "A", dof=10.0),)
    assert wording.expanded(at_one_load(budget)) == (
        "U = 0.111 with k = 2.23 for 95 % (effective degrees of freedom: 10)"
    )
    assert wording.expanded(at_one_load()) == ""
