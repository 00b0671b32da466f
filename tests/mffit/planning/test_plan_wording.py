"""The sentences of a plan, from records made by hand."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import pytest

from mffit import as_json
from mffit.additions import BY_ID, PlannedRun
from mffit.fit.coverage import StageCoverage
from mffit.measured import Contribution
from mffit.planning import Identified, Plan, PlanStep, read_goal, wording

IDENTIFIED = Identified(
    cover=(
        StageCoverage(
            "camber",
            "Camber",
            True,
            free=("PKY3", "PKY6", "PKY7"),
            held=("PEY4",),
            missing=("camber and slip",),
        ),
        StageCoverage("pressure", "Pressure", False, free=(), held=(), missing=()),
    ),
    from_prior=("PKY7",),
    correlated=(("PKY6", "PVY3", -0.987),),
    budget=(Contribution("camber alignment", 0.5, "deg", -0.051), Contribution("conicity", 3.0, "N", 0.02)),
)
RUN = PlannedRun(BY_ID["coupled"], 1400.0, points=[None] * 30, held_deg=10.0)
ZEROS = PlannedRun(BY_ID["zeros"], 1400.0, points=[None] * 10)


def plan(goal="eps_gamma", pecp1="direct", **changes):
    base = Plan(
        config=SimpleNamespace(spin=SimpleNamespace(pecp1=pecp1), tyre=SimpleNamespace(name="small")),
        goal=read_goal(goal, on_disc=True),
        identified=IDENTIFIED,
        now=0.0561,
        steps=(
            PlanStep(ZEROS, before=0.0561, after=0.031),
            PlanStep(RUN, before=0.031, after=0.0123),
        ),
        trials=(),
    )
    return replace(base, **changes)


def test_what_the_sweeps_identify():
    assert wording.identified_by_now(plan()) == [
        "Only the combination of these is determined, as they are strongly correlated: PKY6 and PVY3 (-0.99).",
        "The largest contribution to the uncertainty of eps_gamma (direct method) is camber alignment: 0.051.",
        "Camber: determined by the data: PKY3; determined only in combination: PKY6; determined mostly by prior knowledge: PKY7; "
        "not visible: PEY4 (camber and slip).",
    ]
    nothing = Identified(cover=(), from_prior=(), correlated=(), budget=())
    assert wording.identified_by_now(plan(identified=nothing)) == []


def test_every_coefficient_of_a_stage_has_one_status():
    (camber,) = wording.stages(IDENTIFIED)
    assert camber == ("Camber", ("PKY3",), ("PKY6",), ("PKY7",), (), ("PEY4",), "camber and slip")
    assert camber._fields[1:-1] == tuple(wording.STATUSES)


def test_titles_name_load_camber_and_pressure():
    assert RUN.title == "sideslip sweeps at camber of both signs, 1400 N, 10 deg"
    pressed = PlannedRun(BY_ID["pressure"], 900.0, points=[], pressure_kPa=300.0)
    assert pressed.title == "sideslip and camber sweep at another pressure, 900 N, 300 kPa"
    assert (
        PlannedRun(BY_ID["second-radius"], 900.0, points=[]).title
        == "zeros both ways at 0.7 of the path radius, 900 N"
    )


def test_the_headline_counts_runs_and_points():
    assert wording.headline(plan()) == (
        "2 additions with 40 points: u(eps_gamma) by the direct method from 0.0561 to 0.0123."
    )
    assert wording.headline(plan(steps=plan().steps[:1])) == (
        "1 addition with 10 points: u(eps_gamma) by the direct method from 0.0561 to 0.0310."
    )
    assert wording.headline(plan(steps=(), now=math.inf)) == (
        "u(eps_gamma) by the direct method: not measured. None of the runs tried lowers it by 5 % or more. The budget shows "
        "what limits it."
    )
    assert "budget" not in wording.headline(plan(steps=(), identified=replace(IDENTIFIED, budget=())))


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


def test_the_json_of_a_plan():
    found = as_json.document(plan())
    assert found["goal"] == {
        "kind": "eps_gamma", "name": "", "label": "u(eps_gamma) by the direct method", "unit": "-",
    }  # fmt: skip
    assert (found["u_now"], found["u_then"]) == (0.0561, 0.0123)
    assert [run["name"] for run in found["runs"]] == ["zeros-1400N", "coupled-1400N-10deg"]
    first, second = found["runs"]
    assert (first["kind"], first["points"]) == ("zeros", 10)
    assert (second["u_before"], second["u_after"], second["points"]) == (0.031, 0.0123, 30)


def test_only_the_list_says_which_run_is_first():
    """The sentence on the skew, which only a backward camber sweep shows, gives the place that the list has for it."""
    unseen = replace(IDENTIFIED, unseen_skew=0.16)
    first = wording.remarks(plan(identified=unseen))[0]
    assert "1 deg would change eps_gamma by 0.16" in first
    assert first.endswith("rolled backwards shows it: none of the list.")
    backward = PlanStep(
        PlannedRun(BY_ID["backward-camber"], 1400.0, points=[None] * 11), before=0.0123, after=0.01
    )
    listed = plan(identified=unseen, steps=(*plan().steps, backward))
    assert wording.remarks(listed)[0].endswith("rolled backwards shows it: run 3 of the list.")
    assert not any("backwards" in text for text in wording.remarks(plan()))
