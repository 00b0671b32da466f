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
        wording.OFF_NOMINAL_PRESSURE.format(used=250.2, nominal=290.0),
        "holds at 250 kPa, that of most sweeps; the nominal pressure is 290 kPa",
    ),
    (
        wording.CAMBER_SKEW.format(skew="-0.138 +- 0.055 deg"),
        "steers the wheel by -0.138 +- 0.055 deg times the sine",
    ),
    (
        wording.alignment(at_zero(), 100.0),
        "misalignment plus ply-steer alpha_M = 0.250 +- 0.020 deg (-85 N); uncorrected it would move eps_gamma by 0.28. By usual "
        "sizes of both, misalignment is 0.070 +- 0.060 deg and ply-steer 0.180 +- 0.060 deg",
    ),
    (wording.alignment(at_zero(), 25.0), "exceeds what the alignment is declared to leave"),
    (wording.CONICITY.format(conicity="12.3 +- 2.0 N"), "the conicity force is 12.3 +- 2.0 N"),
    (wording.LOAD_SLOPE.format(pecp2=1.25, u=0.1), "PECP2 = 1.250 +- 0.100 (k = 1)."),
    (wording.ONE_LOAD, "one load was measured"),
    (
        wording.SLOPE_IN_NOISE.format(slope=0.05, twice=0.14),
        "the slope 0.050 per nominal load is within 2 u = 0.140",
    ),
    (wording.EPSILON_IN_NOISE, "within 2 u of zero"),
    (wording.SLOPE_TOO_STEEP.format(largest=0.93), "would reach 0.93"),
    (
        wording.STEERING.format(compliance=0.004, percent=3.31),
        "yields by 0.004 deg per Nm of Mz would change it by 3.3 %",
    ),
]
WARNINGS = [
    (
        wording.taken_elsewhere(900.0, 1500.0, 250e3, {"lean": 200e3}, ["a camber sweep at zero sideslip"]),
        "at 900 N and not at 1500 N, the load nearest to the nominal one: at the main pressure of 250 kPa there is no complete "
        "measurement there, for lack of a camber sweep at zero sideslip; lean (200 kPa) ran at 1500 N and another pressure",
    ),
    (
        wording.CAMBER_SKEW_BEYOND.format(skew="0.491 +- 0.021 deg", declared=0.1, unit="deg"),
        "a camber skew of 0.491 +- 0.021 deg, and 0.1 deg are declared (u_camber_skew_deg)",
    ),
    (wording.GUESSED_STIFFNESS.format(load=1400.0), "sideslip sweep at 1400 N gives C_alpha"),
    (wording.SLOPE_NOT_POSSIBLE.format(load=1500.0, angle=15.0), "at 1500 N the camber sweep is too short"),
    (wording.SECANT_NOT_POSSIBLE.format(load=1500.0, angle=15.0), "does not reach 15 deg"),
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
        wording.ZEROS_DISAGREE.format(
            load=900.0, way="backward", least="a", most="b", low=-120.0, high=310.0
        ),
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


OF_SETUPS = {"SETUP_WITHOUT_ZEROS", "SWEEPS_WITHOUT_SETUP", "LAST_IS_ALIGNED", "SETUP_MISALIGNED"}
"""Tested in test_setups and test_align."""


def test_every_remark_is_tested():
    sentences = {name: x for name, x in vars(wording).items() if name.isupper() and isinstance(x, str)}
    said = [text for text, _ in (*NOTES, *WARNINGS)]
    for name, template in sentences.items():
        first = template.partition("{")[0]
        assert name in OF_SETUPS or any(text.startswith(first) for text in said), name


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
