"""The sentences of a plan, from records made by hand."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import pytest

from mffit.effects import NAMES
from mffit.fit.coverage import StageCoverage
from mffit.measured import Contribution
from mffit.planning import BY_ID, Identified, Plan, PlannedRun, PlanStep, Tie, read_goal, wording
from mffit.results import as_json

IDENTIFIED = Identified(
    cover=(
        StageCoverage(
            "camber", "Camber", True, free=("PKY6", "PKY7"), held=("PEY4",), missing=("camber and slip",)
        ),
        StageCoverage("pressure", "Pressure", False, free=(), held=(), missing=()),
    ),
    from_prior=("PKY7",),
    correlated=(("PKY6", "PVY3", -0.987),),
    ties=(Tie("ply-steer", "sideslip-misalignment", 0.24), Tie("conicity", "crosstalk-fz-fy", 30.0)),
    budget=(Contribution("camber alignment", 0.5, "deg", -0.051), Contribution("conicity", 3.0, "N", 0.02)),
)
RUN = PlannedRun(BY_ID["coupled"], 1400.0, points=[None] * 30, held_deg=10.0)
CAMBER_ZERO = PlannedRun(BY_ID["camber-zero"], 1400.0, rig={"u_camber_alignment_deg": 0.5 / 3.0})


def plan(goal="eps_gamma", pecp1="direct", **changes):
    base = Plan(
        config=SimpleNamespace(spin=SimpleNamespace(pecp1=pecp1), tyre=SimpleNamespace(name="small")),
        goal=read_goal(goal, on_disc=True),
        identified=IDENTIFIED,
        now=0.0561,
        direct_now=0.0561,
        joint_now=0.0263,
        steps=(
            PlanStep(CAMBER_ZERO, before=0.0561, after=0.031, direct=0.031, joint=0.02),
            PlanStep(RUN, before=0.031, after=0.0123, direct=None, joint=0.0063),
        ),
        trials=(),
    )
    return replace(base, **changes)


def test_what_the_sweeps_identify():
    assert wording.identified(IDENTIFIED) == [
        "Camber: determined by the data: PKY6; determined mostly by prior knowledge: PKY7; not visible: PEY4 (camber and slip).",
        "PKY6 and PVY3 are strongly correlated (-0.99): only their combination is determined.",
        f"Not separated: {NAMES['ply-steer']} and {NAMES['sideslip-misalignment']} (expected chi2 0.2 between them, 9 would "
        "suffice).",
        f"Separated, at their usual size: {NAMES['conicity']} from {NAMES['crosstalk-fz-fy']}.",
        "The largest contribution to the uncertainty of eps_gamma (direct method) is camber alignment: 0.051.",
    ]
    nothing = Identified(cover=(), from_prior=(), correlated=(), ties=(), budget=())
    assert wording.identified(nothing) == []


def test_titles_name_load_camber_pressure_and_declared_uncertainty():
    assert wording.title(RUN) == "sideslip sweeps at camber of both signs, 1400 N, 10 deg"
    pressed = PlannedRun(BY_ID["pressure"], 900.0, pressure_kPa=300.0)
    assert wording.title(pressed) == "sideslip and camber sweep at another pressure, 900 N, 300 kPa"
    assert wording.title(CAMBER_ZERO) == "better zero of the camber axis, known to 0.17 deg"
    assert (
        wording.title(PlannedRun(BY_ID["second-radius"], 900.0))
        == "zeros both ways at 0.7 of the path radius, 900 N"
    )


def test_the_headline_counts_runs_and_points():
    assert wording.headline(plan()) == (
        "2 additions with 30 points: u(eps_gamma) by the direct method from 0.0561 to 0.0123."
    )
    assert wording.headline(plan(steps=plan().steps[:1])) == (
        "1 addition: u(eps_gamma) by the direct method from 0.0561 to 0.0310."
    )
    assert wording.headline(plan(steps=(), now=math.inf)) == (
        "None of the runs tried lowers u(eps_gamma) by the direct method by 5 % or more; it is not measured. The budget and the "
        "ties show what limits it."
    )


def test_both_estimates_of_eps_gamma_now_and_then():
    assert wording.estimates(plan()) == (
        "u(eps_gamma): direct method 0.0561 -> not measured; joint fit 0.0263 -> 0.00630."
    )
    assert wording.estimates(plan(steps=())) == "u(eps_gamma): direct method 0.0561; joint fit 0.0263."
    assert wording.estimates(plan(steps=(), direct_now=None)) == (
        "u(eps_gamma): direct method not measured; joint fit 0.0263."
    )
    assert wording.estimates(plan(steps=(), direct_now=None, joint_now=None)) == ""
    found = plan(steps=plan().steps[:1], direct_now=None, joint_now=None)
    assert wording.estimates(found).startswith("u(eps_gamma): direct method not measured -> 0.0310;")


@pytest.mark.parametrize(
    ("goal", "said"),
    [
        ("eps_gamma", "its own budget"),
        ("eps_gamma:joint", 'spin.pecp1 = "model"'),
        ("bands:Mz", "three loads"),
        ("PKY6", "standard error in the file"),
    ],
)
def test_the_prediction_names_its_estimate(goal, said):
    text = wording.promise(plan(goal))
    assert said in text
    assert ("k = 1" in text) == (not goal.startswith("bands"))
    assert text.endswith("assume the noise of your present points.")


def test_a_debiased_eps_gamma_is_called_so():
    assert "(debiased, without the line of finite spin)" in wording.promise(plan(pecp1="debiased"))
    assert "debiased" not in wording.promise(plan())


def test_uncertainties_have_the_unit_of_the_goal():
    assert wording.shown(plan("bands:Mz"), 2.8049) == "2.80 Nm"
    assert wording.shown(plan("bands:Mz"), math.inf) == "not measured"
    assert wording.measure(plan("bands:Mz")) == "95 % band"
    assert wording.shown(plan(), 0.05612) == "0.0561"
    assert wording.measure(plan()) == "u"


def test_instructions_are_lines_for_tyre_toml():
    assert wording.instructions(CAMBER_ZERO) == [
        "# change in [rig]: u_camber_alignment_deg = 0.167 (0.33 of the uncertainty declared now)"
    ]
    assert wording.instructions(RUN) == []


def test_the_json_of_a_plan():
    found = as_json.plan(plan())
    assert found["goal"] == {
        "kind": "eps_gamma", "name": "", "label": "u(eps_gamma) by the direct method", "unit": "-",
    }  # fmt: skip
    assert (found["u_now"], found["u_then"]) == (0.0561, 0.0123)
    assert (found["u_epsilon_gamma_direct"], found["u_epsilon_gamma_joint"]) == (0.0561, 0.0263)
    assert [run["name"] for run in found["runs"]] == ["camber-zero-1400N", "coupled-1400N-10deg"]
    first, second = found["runs"]
    assert (first["kind"], first["points"], first["rig"]) == (
        "camber-zero", 0, {"u_camber_alignment_deg": pytest.approx(1.0 / 6.0)},
    )  # fmt: skip
    assert (second["u_before"], second["u_after"], second["points"]) == (0.031, 0.0123, 30)
    assert (second["u_epsilon_gamma_direct"], second["u_epsilon_gamma_joint"]) == (None, 0.0063)
    assert [(tie["effect"], tie["chi2"], tie["told"]) for tie in found["ties"]] == [
        ("ply-steer", 0.24, False), ("conicity", 30.0, True),
    ]  # fmt: skip


def test_a_backward_camber_sweep_is_asked_for_first_where_nothing_shows_the_skew():
    first = wording.identified(replace(IDENTIFIED, unseen_skew=0.16))[0]
    assert first.startswith("Run first a backward camber sweep")
    assert "1 deg would change eps_gamma by 0.16" in first
    assert not any("backward camber" in text for text in wording.identified(IDENTIFIED))
