"""The sentences about a diagnosis state its facts and nothing else."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from mffit import as_json
from mffit.diagnosis import wording
from mffit.diagnosis.answer import answered
from mffit.diagnosis.bumps import Bump
from mffit.diagnosis.needs import MET
from mffit.diagnosis.noise import Noise, Scatter
from mffit.diagnosis.notes import (
    AnotherTyre,
    DirectMethodRedone,
    FileKept,
    ModelFittedFirst,
    ModelOfLastBuild,
    NoRepair,
    NotVisible,
    OffsetsOrMemory,
    OneSweep,
    WithoutNoise,
)
from mffit.diagnosis.remains import BestEffect, OneStep
from mffit.diagnosis.rest import Answer, Rest, RestKind
from mffit.diagnosis.ties import Separation
from mffit.diagnosis.validation import Gap, Validation
from mffit.effects import CATALOG, NEEDS
from mffit.linearised.chained import Memory
from mffit.report import text
from mffit.rig_errors import BY_NAME as RIG_ERRORS_BY_NAME
from mffit.suspicion import Outlier
from tir import Quantity

BY_ID = {effect.id: effect for effect in CATALOG}
RIGHT, WRONG = Quantity(-0.06, 0.05, "-"), Quantity(0.2, 0.07, "-")
CHECK = Validation(
    8,
    Gap({"Fy": 36.7, "Mz": 2.0}, 4.0),
    Gap({"Fy": 37.5, "Mz": 2.1}, 4.2),
    Gap({"Fy": 36.0, "Mz": 2.2}, 3.9),
)
BUMP = Bump("Mz", {"alpha_deg": (-4.0, -2.5), "Fz_N": (1400.0, 1600.0)}, -6.2, 30.0)


SMOOTH = Rest(RestKind.SMOOTH, "Fy", 40.0)


def unknown(diagnosis, *rest, **changes):
    """The diagnosis with something that has no name."""
    return replace(diagnosis, answer=Answer.UNKNOWN, rest=rest, bump=None, **changes)


def test_a_misfit_without_a_bump_has_no_place(nothing):
    """The best bump that was tried was once named, although none was found."""
    said = wording.headline(unknown(nothing, SMOOTH))
    assert said.startswith("Something is missing that no effect of the library describes: the rms misfit is")
    assert said.endswith("; what remains changes smoothly with the conditions, most in Fy.")


def test_effects_are_named_next_to_something_unknown(camber):
    said = wording.headline(unknown(camber, SMOOTH))
    assert (
        "no effect of the library describes in addition to camber stiffness: with it the rms misfit is"
        in said
    )


def test_a_bump_is_stated_with_its_size_and_place(nothing):
    local = Rest(RestKind.LOCAL, "Mz", 30.0)
    said = wording.headline(replace(unknown(nothing, local), bump=BUMP))
    assert said.endswith(
        "; Mz remains off by -6.2 Nm around sideslip -4 to -2.5 deg and load 1400 to 1600 N."
    )


@pytest.mark.parametrize(
    ("rest", "remains", "cure"),
    [
        (Rest(RestKind.SWEEP, "Fy", 30.0, 4.0, "camber_900"), "camber_900 contradicts the other sweeps", "check camber_900"),
        (
            Rest(RestKind.SCATTER, "Fy", 90.0, 19.7, "coupled"),
            "Fy scatters by 19.7 times its stated noise, most in coupled",
            "check coupled or repeat it",
        ),
        (
            Rest(RestKind.SCATTER, "Fy", 90.0, 4.9),
            "Fy scatters by 4.9 times its stated noise",
            "if all readings of the rig scatter so, state u_Fy_N as large as that",
        ),
        (Rest(RestKind.ALL, "Mz", np.inf, 41.7), "42 times the stated noise, so that the model hardly is one", "fit it first"),
        (SMOOTH, "changes smoothly", "give the model of this tyre, or fit it first (mffit build)"),
    ],
)  # fmt: skip
def test_what_remains_has_words_and_a_cure(nothing, rest, remains, cure):
    found = unknown(nothing, rest)
    assert remains in wording.headline(found)
    (reason,) = wording.reasons(found)
    scatters = rest.kind is RestKind.SCATTER
    assert reason.startswith(
        remains if scatters else "no effect of the library explains what remains: the model misses "
    )
    assert cure in reason


def test_what_a_formula_misses_of_its_own_points_is_no_reason_against_it(nothing):
    assert wording.reasons(replace(unknown(nothing, SMOOTH), seen=True)) == ()


def test_an_effect_is_named_with_its_ties(camber):
    assert camber.answer is Answer.FOUND
    assert camber.headline.startswith("The missing effect is camber stiffness: with it the rms misfit is")
    tied = replace(camber.effects[0], tied=(BY_ID["path-radius"],))
    assert tied.tied_with == ("path-radius",)
    said = wording.headline(replace(camber, effects=(tied,), answer=Answer.UNDECIDED))
    assert said.startswith("The missing effect is camber stiffness (or path radius, not separable here)")


def test_an_unlikely_effect_is_called_undecided(camber):
    found = replace(camber.effects[0], confidence=0.4, together=0.4, repaired=False)
    said = wording.headline(replace(camber, effects=(found,), answer=Answer.UNDECIDED, alternatives={}))
    assert said.startswith(
        "These data cannot tell what is missing; the best explanation is camber stiffness: with it the rms misfit would be"
    )


def test_an_effect_that_may_be_missing_is_suspected_and_not_the_answer(nothing):
    said = wording.headline(
        replace(nothing, answer=Answer.UNDECIDED, alternatives={"loadcell-gain": 0.75, "drift": 0.1})
    )
    assert said.startswith(
        "Nothing is corrected; calibration of Fy is suspected (probability 75 %), but these data do not establish it: the rms "
        "misfit is"
    )


def test_what_is_not_repaired_is_no_answer_where_something_unknown_is_missing(camber):
    weak = replace(camber.effects[0], confidence=0.4, together=0.4, repaired=False)
    found = replace(camber, effects=(weak,), answer=Answer.UNKNOWN, alternatives={})
    said = wording.headline(found)
    assert said.startswith("More is missing than effects of the library describe: the rms misfit is")
    assert "instead of" not in said
    assert (
        " Suspected but not repaired, at a confidence below 50 %: camber stiffness (40 %, taking side force from "
        in said
    )


@pytest.mark.parametrize(
    ("rest", "named", "alternatives", "answer"),
    [
        ((), (), {}, Answer.NOTHING),
        ((), (), {"loadcell-gain": 0.3}, Answer.NOTHING),
        ((), (), {"loadcell-gain": 0.75}, Answer.UNDECIDED),
        ((), ({},), {}, Answer.FOUND),
        ((), ({}, {"repaired": False}), {}, Answer.FOUND),
        ((), ({"repaired": False},), {}, Answer.UNDECIDED),
        ((), ({}, {"tied": (BY_ID["path-radius"],)}), {}, Answer.UNDECIDED),
        ((SMOOTH,), ({},), {}, Answer.UNKNOWN),
        ((SMOOTH,), (), {"loadcell-gain": 0.75}, Answer.UNKNOWN),
    ],
)
def test_what_remains_decides_first_then_ties_and_confidence(camber, rest, named, alternatives, answer):
    effects = [replace(camber.effects[0], **changes) for changes in named]
    assert answered(rest, effects, alternatives) is answer


def test_a_file_that_is_not_to_be_trusted_is_not_to_be_used(camber):
    doubted = replace(camber, answer=Answer.UNKNOWN, rest=(SMOOTH,))
    assert wording.advice(doubted)[0] == "stiffer.tir contains camber stiffness, and is not to be trusted."


def test_advice_names_the_file_the_rig_and_the_run(camber):
    assert wording.advice(camber) == ["Use stiffer.tir: it contains camber stiffness."]
    axis = replace(camber.effects[0], effect=BY_ID["sideslip-misalignment"])
    warm = replace(
        camber.effects[0],
        effect=BY_ID["temperature"],
        tied=(BY_ID["drift"],),
        separation=Separation("a repeated sideslip sweep at 1400 N", 40.0),
    )
    file, rig, beside, run = wording.advice(
        replace(camber, effects=(axis, warm), delivers=False, given_file="../base.tir")
    )
    assert file == "Keep base.tir: nothing in it is corrected."
    assert rig.startswith(
        "The rest is your rig: sideslip axis misaligned. Correct these readings, or mend the rig"
    )
    assert beside.startswith("Add tyre temperature as a term in addition to the file")
    assert run.startswith("To decide, add this run: a repeated sideslip sweep at 1400 N")


@pytest.mark.parametrize(
    ("region", "words"),
    [
        ({"direction": (-1.0, -1.0)}, ["backward runs"]),
        ({"direction": (1.0, 1.0)}, ["forward runs"]),
        ({"direction": (-1.0, 1.0)}, ["both directions"]),
        ({"p_kPa": (250.0, 250.0)}, ["pressure 250 kPa"]),
        ({"t_s": (0.0, 12345.6)}, ["time 0 to 12346 s"]),
        ({"alpha_deg": (-3.0, 0.00013)}, ["sideslip -3 to 0 deg"]),
        ({}, []),
    ],
)
def test_a_region_in_words(region, words):
    assert wording.place(region) == words


def test_only_a_separating_run_is_recommended():
    run = "a camber sweep at 1500 N"
    assert wording.separation(Separation(run, 40.0)) == f"{run} (expected chi2 40)"
    assert wording.separation(Separation(run, 2.0)).startswith("none of the usual runs")


@pytest.mark.parametrize(
    ("note", "words"),
    [
        (OneSweep(), "One sweep cannot separate causes"),
        (
            NotVisible(("curved", "moment"), (BY_ID["spin-torque"],)),
            "which lack a curved path and Mz: turn-slip moment.",
        ),
        (
            NoRepair(("camber stiffness",), CHECK),
            "No repair is written: camber stiffness would fit these points better, but on left-out sweeps the side force misses "
            "by 37.5 N instead of 36.7 N and the self-aligning moment misses by 2.1 Nm instead of 2 Nm.",
        ),
        (
            FileKept(("grip over load",), CHECK),
            "The property file stays as given: with grip over load it would predict left-out sweeps worse, all channels together "
            "and the errors of the rig taken out (the side force misses by 37.5 N instead of 36 N",
        ),
        (
            AnotherTyre((("UNLOADED_RADIUS", 0.31, 0.2998), ("NOMPRES", 200e3, 250e3))),
            "another tyre than tyre.toml: free radius 0.31 instead of 0.2998 m (UNLOADED_RADIUS); nominal pressure",
        ),
        (
            AnotherTyre((("FNOMIN", 2100.0, 1400.0),)),
            "other nominal conditions than tyre.toml: nominal load 2100 instead of 1400 N (FNOMIN). A file of this tyre may be",
        ),
        (
            WithoutNoise((("Fy", 1.23), ("Mz", 0.027))),
            "1.23 N in Fy and 0.027 Nm in Mz are assumed as their noise (0.1 %",
        ),
        (
            OffsetsOrMemory("Fy", 0.96, 28.7, (BY_ID["run-offsets-fy"],)),
            "(0.96 between neighbours) and may as well be a load-cell zero of Fy that differs from run to run",
        ),
        (ModelOfLastBuild("front-normal.tir"), "The model is front-normal.tir of the last build."),
        (ModelFittedFirst(turn_slip=False), "simulations with turn slip off."),
        (DirectMethodRedone(("backlash",), RIGHT, None), "cannot be measured even without backlash"),
        (DirectMethodRedone(("backlash",), None, RIGHT), "cannot be measured with backlash"),
        (
            DirectMethodRedone(("backlash",), RIGHT, RIGHT),
            "stays -0.060 +- 0.050 (k = 1) with backlash corrected",
        ),
        (
            DirectMethodRedone(("backlash",), Quantity(-0.083, 0.065, "-"), Quantity(-0.063, 0.063, "-")),
            "was -0.083 +- 0.065 with backlash; corrected it is -0.063 +- 0.063 (k = 1), a change within its uncertainty.",
        ),
        (
            DirectMethodRedone(("backlash", "gain"), WRONG, RIGHT),
            "was 0.200 +- 0.070 with backlash and gain; corrected it is -0.060 +- 0.050 (k = 1).",
        ),
    ],
)
def test_every_note_becomes_a_sentence(note, words):
    assert words in note.sentence


def test_the_file_keeps_its_keys(camber):
    content = as_json.document(replace(camber, notes=(OneSweep(),)))
    assert list(content) == [
        "trusted", "reasons",
        "headline", "verdict", "gap_before", "gap_after", "gap_by_effect", "validation", "where", "effects", "alternatives",
        "limits", "unexplained", "unexplained_where", "noise_floor", "outliers", "coefficients", "model_after",
        "model_with_terms", "advice", "apart", "notes", "lab", "left_out",
    ]  # fmt: skip
    assert list(content["effects"][0]) == [
        "id", "name", "kind", "physics", "confidence", "repaired", "parameters", "to_do", "gap_after", "tied_with", "separate_by",
    ]  # fmt: skip
    assert list(content["where"][0]) == ["channel", "region", "bias", "z"]
    assert content["effects"][0]["separate_by"] == ""
    assert content["effects"][0]["parameters"]["PKY6"].keys() == {"was", "value", "stderr"}
    assert content["validation"].keys() == {"method", "gap_before", "gap_after", "gap_given_file", "gain"}
    assert content["verdict"] == "found"
    assert content["model_after"] == "stiffer.tir"
    assert [step["id"] for step in content["gap_by_effect"]] == ["given", "camber-stiffness"]
    assert content["gap_by_effect"][0].keys() == {"id", "gap", "held_out"}
    assert content["apart"][0].keys() == {"where", "rms", "largest"}
    assert content["notes"] == [OneSweep().sentence]


NAMES_OF_NUMBERS = [name for name in (*RIG_ERRORS_BY_NAME, "turn_slip") if "_" in name]


@pytest.mark.parametrize("effect", CATALOG, ids=lambda effect: effect.id)
def test_a_terminal_shows_words_and_units_instead_of_names_of_numbers(camber, effect):
    """A hundred times its uncertainty, every number has digits to show."""
    numbers = {free.name: (1.2345 * free.spread, 0.0123 * free.spread) for free in effect.free}
    found = replace(camber.effects[0], effect=effect, parameters=numbers, before=dict.fromkeys(numbers, 0.0))
    said = text.diagnosis_summary(replace(camber, effects=(found,)))
    block = said[said.index(f"{effect.name} ({effect.kind})") :]
    shown = block[: block.index("to do")] if "to do" in block else block
    assert not [name for name in NAMES_OF_NUMBERS if name in shown]
    assert not re.search(r"\de[+-]?\d", shown)
    step = OneStep(effect, -50.0, {name: x for name, x in numbers.items() if name != "turn_slip"}, 0.4)
    assert not [name for name in NAMES_OF_NUMBERS if name in wording.best_effect(BestEffect(step, (), 40))]


def test_numbers_are_rounded_to_their_uncertainty(camber):
    drift = replace(
        camber.effects[0], effect=BY_ID["drift"], parameters={"k_t_per_s": (-3.671525e-06, 1.3e-07)}, before={"k_t_per_s": 0.0}
    )  # fmt: skip
    said = text.diagnosis_summary(replace(camber, effects=(drift,)))
    assert "drift over the test = -1.322 +- 0.047 % per hour, was 0" in said
    gain = replace(
        camber.effects[0], effect=BY_ID["loadcell-gain"], parameters={"gain": (1.041283, 0.00077)}, before={"gain": 1.0}
    )  # fmt: skip
    assert wording.remedy(gain, camber).endswith("divide its readings by 1.04128")
    step = OneStep(BY_ID["load-camber"], -50.0, {"load_camber": (-0.03204, 0.0011)}, 0.4)
    assert "changes with camber (-3.20 +- 0.11 %) would explain 40 %" in wording.best_effect(
        BestEffect(step, (), 40)
    )


def test_every_need_has_words_and_a_test_of_the_points():
    assert set(MET) == set(NEEDS)


def test_the_noise_is_stated_beside_the_declared_one():
    u = np.repeat([6.0, 0.6], 10)
    parts = {"Fy": Scatter(scale=2.0, growth=0.015, memory=Memory(0.9, 0.3), tails=2.5), "Mz": Scatter()}
    noise = Noise(u=u * np.repeat([2.0, 1.0], 10), stated=u, chain=np.zeros(20), origin=None, scatter=parts)
    Fy, Mz = wording.scatter(noise)
    assert Fy.startswith(
        "The noise of Fy is 12 N (stated 6 N); it grows with the reading, by 1.5 % of it; neighbouring errors of a sweep"
    )
    assert "correlated (0.90), 30 % of their variance is not;" in Fy
    assert "lost their weight" in Fy
    assert Mz == "The noise of Mz is 0.6 Nm (stated 0.6 Nm)."


def test_readings_that_scatter_far_beyond_what_is_stated_are_said_in_the_headline(nothing):
    noise = nothing.noise
    worse = replace(noise, u=np.where(np.arange(len(noise.u)) < len(noise.u) // 2, 3.7, 1.0) * noise.stated)
    stated = noise.typically_stated("Fy")
    said = wording.headline(replace(nothing, noise=worse))
    assert f"3.7 times the stated {stated:.3g} N" in said
    assert "times the stated" not in said.split("Nm in self-aligning moment")[-1]
    assert "times the stated" not in wording.headline(nothing)


def test_an_outlier_is_named_by_its_line():
    said = wording.outlier(Outlier("sideslip_900.csv", 14, "sideslip_900", 3, "Fy", 109.0, 200.0, 15.2))
    assert said == "sideslip_900, line 14: Fy off by -91 N, 15 times its noise"
