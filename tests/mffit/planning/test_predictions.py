"""Predictions of a plan follow from the build's posterior and budget, and come true on the virtual rig.

``tests/studies/plan_study.py`` repeats the last test for more goals and many rigs.
"""

from __future__ import annotations

import dataclasses
import json
import math
import tomllib

import numpy as np
import pytest
from small_rigs import LOADS, SAMPLE, built, disc, truth

import mffit
from mffit.additions import ADDITIONS, addition_named, candidates
from mffit.cli import main
from mffit.errors import InputError
from mffit.pipeline.planning import additions, plan_of, sheet, write_plan
from mffit.pipeline.refining import finite_spin_bias
from mffit.planning import read_goal, wording
from mffit.planning.prospect import Prospect
from mffit.points import concatenate
from mffit.report.text import plan_summary
from mffit.rig import Simulation
from mffit.rig_errors import CALIBRATED
from mffit.scatter import rms
from tests.browser import assert_readable

FREE = {"PECP1": math.inf}
ONE_SIDE = ("other-side", "other-side-camber")


@pytest.fixture(scope="module")
def content():
    """Two loads of the small campaign on a calibrated rig whose camber axis is nearly square: more runs do not improve either."""
    faults = {"F0_N": 8.0, "gamma_0_deg": 0.4, "path_radius_m": 1.325}
    content = disc(LOADS[:2], faults=faults, spin={"pecp1": "debiased"})
    content["rig"] = content["rig"] | {"u_camber_skew_deg": 0.004, **dict.fromkeys(CALIBRATED.values(), 0.0)}
    return content


@pytest.fixture(scope="module")
def result(content, tmp_path_factory):
    return built(content, tmp_path_factory.mktemp("first"))


@pytest.fixture(scope="module")
def knowledge(result):
    return prospect_of(result)


def prospect_of(result):
    def direct(*_):
        raise AssertionError("the direct method was asked")

    return Prospect(result.config, result.points, result.measured, result.fit, direct)


def run_of(result, kind, load=1400):
    return next(
        r
        for r in candidates(result.config, result.points)
        if r.addition.id == kind and abs(r.load - load) < 10
    )


def test_the_readme_says_what_a_plan_brings_the_sample():
    plan = mffit.plan(SAMPLE / "tyre.toml")
    said = (
        f"the uncertainty of eps_gamma is {plan.now:.2g}. "
        f"The {len(plan.steps)} runs that `mffit plan` names lower it to {plan.then:.2g}."
    )
    readme = (SAMPLE.parents[1] / "README.md").read_text(encoding="utf-8")
    assert said in " ".join(readme.split()), f"README.md states other figures than: {said}"


def test_without_runs_the_posterior_is_the_builds(result, knowledge):
    found = knowledge.posterior([], held={"PECP1": result.fit.search.held["PECP1"]}).stderr
    stated = result.fit.search.posterior.stderr
    assert {name: found[name] for name in stated} == pytest.approx(stated, rel=1e-6)


def test_more_points_never_raise_an_uncertainty(result, knowledge):
    before = knowledge.posterior([], FREE).stderr
    after = knowledge.posterior([run_of(result, "small-camber")], FREE).stderr
    # The tolerance: a held coefficient contributes to the u of a fitted one.
    assert all(after[name] <= before[name] * 1.001 for name in before)
    assert after["PKY6"] < 0.95 * before["PKY6"]


def test_the_same_points_again_halve_the_variance_due_to_noise(result, knowledge):
    """Only the points determine curvature of the side force and width of the trail, not the rig or priors."""
    again = dataclasses.replace(run_of(result, "sideslip"), points=result.points)
    before, after = (knowledge.posterior(runs, FREE).stderr for runs in ([], [again]))
    for name in ("PEY1", "QBZ4"):
        assert after[name] / before[name] == pytest.approx(math.sqrt(0.5), rel=0.05)


SETTLED = {
    "zeros": ("PHY2",),
    "other-side": ("PECP1", "PHY1", "gamma_0_deg"),
    "other-side-camber": ("PECP1", "gamma_0_deg", "PKY6"),
    "second-radius": ("PECP1", "QDTP1", "gamma_0_deg"),
    "small-camber": ("PKY6",),
    "backward-camber": ("camber_skew_deg", "QDZ8"),
    "flipped": ("PVY1", "QDZ6"),
    "sideslip": ("PDY1", "QBZ1"),
    "camber": ("PKY6", "PKY7"),
    "coupled": ("PDY3", "PVY3", "QDTP1"),
    "unspun": ("QDTP1", "QDZ1"),
    "pressure": ("PPY1", "PPY3", "PPZ1"),
    "load": ("PKY2", "PEY2"),
}
"""Numbers whose uncertainty an addition lowers markedly."""
ON_DISCS = [addition for addition in ADDITIONS if addition.rig != "belt"]


@pytest.mark.parametrize("addition", ON_DISCS, ids=lambda addition: addition.id)
def test_an_addition_settles_what_it_names(result, knowledge, addition):
    every = candidates(result.config, result.points, knowledge.unspun)
    runs = [run for run in every if run.addition is addition]
    before = knowledge.posterior([], FREE).stderr
    after = [knowledge.posterior([run], FREE).stderr for run in runs]
    for name in SETTLED[addition.id]:
        assert min(found[name] for found in after) < (11.0 / 12.0) * before[name], name


def test_additions_are_looked_up_by_id():
    assert {addition_named(addition.id) for addition in ADDITIONS} == set(ADDITIONS)
    assert addition_named("other-side").radius < 0.0
    with pytest.raises(InputError, match="the kinds are zeros, other-side, "):
        addition_named("sun")


def test_no_run_in_one_set_up_separates_ply_steer_from_misalignment(result, knowledge):
    """A run on another path is a new set-up: the mean of two independent zeros."""
    ply = {
        kind: knowledge.posterior([run_of(result, kind)], FREE).stderr["PHY1"]
        for kind in ("zeros", "sideslip", "other-side", "second-radius")
    }
    before = knowledge.posterior([], FREE).stderr["PHY1"]
    for kind in ("zeros", "sideslip"):
        assert ply[kind] == pytest.approx(before, rel=0.05)
    for kind in ("other-side", "second-radius"):
        assert ply[kind] == pytest.approx(before / math.sqrt(2.0), rel=0.1)


@pytest.fixture(scope="module")
def plan(result):
    without = [addition_named(a.id) for a in ADDITIONS if a.id == "second-radius"]
    return plan_of(result, read_goal("eps_gamma", on_disc=True), runs=1, without=without)


def test_the_other_side_of_the_disc_is_chosen_for_eps_gamma(result, plan):
    """A new set-up: conicity cancels, the zeros are those of two independent set-ups."""
    (step,) = plan.steps
    assert step.run.addition.id == "other-side"
    assert plan.now == pytest.approx(result.measured.epsilon_gamma_debiased.u, rel=1e-3)
    lines = {r.source: r.contribution for r in result.measured.budget}
    zeros = math.hypot(lines.pop("camber alignment"), lines.pop("load-cell offset"))
    rest = [u for source, u in lines.items() if source not in ("conicity", "finite spin of the disc")]
    measured = result.measured
    bias = measured.epsilon_gamma.value - measured.epsilon_gamma_debiased.value
    left = math.hypot(zeros / math.sqrt(2.0), *rest, 0.3 * bias)
    assert 0.9 * left < plan.then < 1.1 * left
    assert plan.trials[0].after == pytest.approx(plan.then, rel=0.2)


@pytest.fixture(scope="module")
def longer(content, plan, tmp_path_factory):
    """The build of the campaign with the runs of the plan."""
    points = plan.steps[0].run.points
    more = [
        {
            "file": f"{way}.csv",
            "load_N": float(points.Fz[0]),
            "alpha_deg": np.degrees(points.alpha[points.direction == sign]).round(3).tolist(),
            "direction": way,
            "path_centre": "right",
        }
        for way, sign in (("forward", 1), ("backward", -1))
    ]
    return built({**content, "sweep": [*content["sweep"], *more]}, tmp_path_factory.mktemp("longer"))


def test_the_promise_is_met_within_a_fifth_on_the_virtual_rig(result, plan, longer):
    stated = longer.measured.epsilon_gamma_debiased
    assert stated.u == pytest.approx(plan.then, rel=0.2)
    assert abs(stated.value - truth()["PECP1"]) < 3.0 * plan.then
    of_joint = prospect_of(result).posterior([plan.steps[0].run], held={"PECP1": stated.u})
    same = {name: name for name in ("PKY6", "QDZ1", "PDY1", "F0_N@right", "gamma_0_deg@right")}
    of_first_setup = {f"{name}@left": name for name in ("F0_N", "gamma_0_deg")}
    for name, planned in (same | of_first_setup).items():
        found = longer.fit.posterior.stderr[name]
        assert found == pytest.approx(of_joint.stderr[planned], rel=0.2), name


def band_of_road(result) -> float:
    """The 95 % bands of the road that a build states, rms over its curves, over the largest forces of the upright wheel."""
    road = result.road
    shares = [
        1.96
        * rms(np.concatenate([curve.u[name] for curve in road.curves.values()]))
        / np.max(np.abs(road.upright.best[name]))
        for name in ("Fy", "Mz")
    ]
    return rms(np.array(shares))


@pytest.fixture(scope="module")
def to_the_road(result):
    return plan_of(result, read_goal("road", on_disc=True), runs=1)


def test_the_band_of_the_road_is_that_of_the_build(result, to_the_road):
    assert to_the_road.now == pytest.approx(band_of_road(result), rel=0.02)
    assert all(trial.after <= 1.001 * trial.before for trial in to_the_road.trials)


def test_the_band_of_the_road_narrows_as_promised_on_the_virtual_rig(plan, longer, to_the_road):
    """With the runs of the list for eps_gamma, the first of which is also tried alone for the road."""
    run = plan.steps[0].run
    (promised,) = [trial.after for trial in to_the_road.trials if trial.run.name == run.name]
    assert promised < to_the_road.now
    assert band_of_road(longer) == pytest.approx(promised, rel=0.3)


def test_a_run_at_the_camber_without_spin_is_tried_for_the_road(result, to_the_road):
    """There the file's own spin, phi_t - (1 - eps_gamma) sin(gamma) / r_e, is zero; where it was run, it is not tried again."""
    unspun = [trial.run for trial in to_the_road.trials if trial.run.addition.id == "unspun"]
    row = result.measured.nominal
    for run in unspun:
        spin = run.points.phi_t - (1.0 - row.epsilon_gamma.value) * np.sin(run.points.gamma) / row.r_e.value
        assert np.max(np.abs(spin)) < 0.01 * abs(run.points.phi_t[0])
        assert np.ptp(run.points.alpha) > 0.1
    camber = unspun[0].points.gamma[0]
    again = concatenate([result.points, *(run.points for run in unspun)])
    assert not [one for one in candidates(result.config, again, camber) if one.addition.id == "unspun"]


def test_the_bias_of_finite_spin_is_that_of_the_true_tyre(longer):
    """A model that holds PECP1 at the biased value compensates with other spin coefficients and would find a third of it."""
    measured = longer.measured
    found = measured.epsilon_gamma.value - measured.epsilon_gamma_debiased.value
    true = finite_spin_bias(longer.config, longer.points, Simulation.of(truth()), None)
    assert found == pytest.approx(true, abs=0.006)
    assert true > 0.015


def test_runs_that_the_rig_cannot_make_are_left_out(result):
    without = plan_of(
        result,
        read_goal("eps_gamma:joint", on_disc=True),
        runs=2,
        without=[addition_named(word) for word in ONE_SIDE],
    )
    assert without.steps
    assert not {trial.run.addition.id for trial in without.trials} & set(ONE_SIDE)
    assert without.then == without.steps[-1].after < without.now


def test_two_runs_that_help_only_together_are_found(result):
    """PPY2 needs two pressures at two loads; one more pressure at one load does not inform about it."""
    goal = read_goal("PPY2", on_disc=True)
    others = [one for one in ADDITIONS if one.id not in ("pressure", "sideslip", "small-camber")]
    found = plan_of(result, goal, runs=2, without=others)
    assert [step.run.addition.id for step in found.steps] == ["pressure", "pressure"]
    assert len({step.run.load for step in found.steps}) == 2
    assert found.then < 0.3 * found.now
    assert plan_of(result, goal, runs=1, without=others).steps == ()


def test_a_file_with_eps_gamma_of_the_joint_fit_has_the_uncertainty_of_that_fit(result, knowledge):
    """With ``spin.pecp1 = "model"`` the direct method is not asked, and what trades with PECP1 is less certain."""
    spin = result.config.spin.model_copy(update={"pecp1": "model"})
    config = result.config.model_copy(update={"spin": spin})

    prospect = prospect_of(dataclasses.replace(result, config=config))
    found = prospect.u_of(read_goal("PKY6", on_disc=True))([])
    assert found == pytest.approx(knowledge.posterior([], FREE).stderr["PKY6"], rel=1e-6)
    assert found > knowledge.posterior([], held={"PECP1": 0.0}).stderr["PKY6"]


def test_sheets_are_in_the_rigs_axes_and_their_path_is_declared(result, plan):
    run = plan.steps[0].run
    sae = result.config.model_copy(update={"rig": result.config.rig.model_copy(update={"axes": "sae"})})
    assert sheet(sae, run.points).alpha_deg.to_numpy() == pytest.approx(
        -np.degrees(run.points.alpha), abs=1e-4
    )
    text = additions(result.config, [run])
    assert 'path_centre = "right"' in text
    assert f'file = "{run.name}.csv"' in text
    assert "path_radius" not in text


def test_the_additions_to_tyre_toml_are_valid_toml_behind_it(result, knowledge):
    """A second [rig] table would be a TOML error."""
    config = result.config
    runs = candidates(config, result.points, knowledge.unspun)
    assert {run.addition for run in runs} == set(ON_DISCS)
    read = tomllib.loads("[rig]\naxes = 'iso'\n" + additions(config, runs))
    assert {row["file"] for row in read["sweep"]} == {f"{r.name}.csv" for r in runs}
    assert set(read["rig"]) == {"axes"}


def test_a_band_is_not_called_a_standard_uncertainty(plan):
    bands = dataclasses.replace(plan, goal=read_goal("bands:Mz", on_disc=True))
    assert "k = 1" in plan_summary(plan)
    assert "k = 1" not in plan_summary(bands)
    assert "95 % band now" in plan_summary(bands)


@pytest.mark.parametrize(
    ("goal", "said"),
    [
        ("PKY66", "did you mean PKY6"),
        ("PCFY3", "recordings of steps, which a plan does not propose"),
        ("tie:ply-steer", "neither a goal of a plan nor a coefficient"),
        ("bands:RL", "neither a goal of a plan nor a coefficient"),
    ],
)
def test_an_unknown_goal_is_refused(goal, said):
    with pytest.raises(InputError, match=said):
        read_goal(goal, on_disc=True)


def test_a_flat_track_has_no_eps_gamma_to_plan_for():
    with pytest.raises(InputError, match="needs a disc"):
        read_goal("eps_gamma", on_disc=False)


def test_the_plan_lists_what_the_sweeps_identify(plan):
    said = " ".join(wording.identified_by_now(plan))
    assert "not visible: " in said
    assert "pressure" in said


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--goal", "PKY66"], "did you mean PKY6"),
        (["--without", "sun"], "is not a kind of run"),
        (["--goal", "bands", "--coefficient", "PKY6"], "exclude each other"),
    ],
)
def test_the_command_refuses_bad_options_before_it_builds(options, said, tmp_path, capsys):
    with pytest.raises(SystemExit) as ended:
        main(["plan", str(SAMPLE / "tyre.toml"), "--out", str(tmp_path / "plan"), *options])
    assert ended.value.code == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "plan").exists()


def test_the_command_names_what_it_wrote(plan, monkeypatch, capsys):
    """Sheets only with new points; without any run there is nothing to fill in."""
    for found, more in (
        (plan, ", runs (sheets to fill in)"),
        (dataclasses.replace(plan, steps=()), ""),
    ):
        monkeypatch.setattr("mffit.pipeline.plan", lambda *given, found=found, **keys: found)
        main(["plan", str(SAMPLE / "tyre.toml"), "--out", "somewhere"])
        assert capsys.readouterr().out.endswith(f"written to somewhere: plan.html, plan.json{more}\n")


def test_page_numbers_and_sheets_are_written(plan, tmp_path):
    write_plan(plan, tmp_path / "plan")
    assert_readable(tmp_path / "plan" / "plan.html")
    written = json.loads((tmp_path / "plan" / "plan.json").read_text())
    assert written["u_then"] == plan.then
    assert written["runs"][0]["kind"] == "other-side"
    page = (tmp_path / "plan" / "plan.html").read_text()
    assert plan.steps[0].run.title in page
    assert (tmp_path / "plan" / "runs" / f"{plan.steps[0].run.name}.csv").is_file()
    assert plan.steps[0].run.title in plan_summary(plan)
