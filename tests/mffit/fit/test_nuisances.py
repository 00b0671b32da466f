"""Temperature and sense as numbers of the fit: found where they are, left out with a reason where they are not."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
import small_rigs
from drawn_rigs import scaled
from flat_belt import RATE, SPEED, recording, write_mat73
from plain_pages import without_pictures

import mffit
import tir
from mffit import as_json
from mffit import config as configuration
from mffit.errors import InputError
from mffit.fit.influences.confounding import confounding_sentence, confoundings, correlation_ratio
from mffit.fit.influences.nuisance_choice import choose
from mffit.fit.influences.nuisances import NUISANCES
from mffit.fit.told import told_by_weights
from mffit.pipeline.measuring import measure
from mffit.points import make_points
from mffit.quantities import CHARACTERISTICS, KEYS
from mffit.report.verdict import headlines
from mffit.rig import Simulation
from mffit.rounding import stated as in_words
from tir import Quantity

TERMS = {"k_T_grip_per_K": -0.006, "k_T_stiffness_per_K": -0.003, "k_T_camber_per_K": -0.005}
COLD, WARM = 25.0, 50.0
NINE = [(F, g) for F in (900, 1400, 2100) for g in (-10, 0, 10)]
"""Loads [N] and cambers [deg] of nine sweeps."""


def with_setting(result, **keys):
    """The configuration of a build with other keys of [fit]."""
    config = configuration.load(result.config)
    changed = config.model_copy(update={"fit": config.fit.model_copy(update=keys)})
    changed._path, changed._lines = config.path, config._lines
    return changed


def verdict(choice, key):
    return next(row for row in choice.verdicts if row.nuisance.id == key)


@pytest.fixture(scope="module")
def warmed(tmp_path_factory):
    """A campaign on a flat track whose tyre warms from 25 to 50 degC; its virtual rig has formulae of its own."""
    folder = tmp_path_factory.mktemp("warmed")
    content = small_rigs.flat(faults=TERMS)
    content["sweep"] = [
        {**sweep, "file": f"{pressure}_{sweep['file']}", "p_kPa": pressure}
        for pressure in (250, 200, 300)
        for sweep in content["sweep"]
        if "forward" not in sweep["file"] and ("camber" not in sweep["file"] or pressure == 250)
    ]
    ends = np.linspace(COLD, WARM, len(content["sweep"]) + 1).tolist()
    for sweep, first, last in zip(content["sweep"], ends[:-1], ends[1:], strict=True):
        sweep["T_degC"] = [first, last]
    small_rigs.simulated(content, folder)
    with without_pictures():
        return mffit.build(folder / "tyre.toml", folder / "out"), folder / "out"


def test_a_tyre_that_warms_up_gets_its_temperature_terms(warmed):
    result, _ = warmed
    found = result.fit.temperature
    assert found is not None
    assert found.T_ref == pytest.approx(0.5 * (COLD + WARM), abs=1.5)
    for name, at_cold in TERMS.items():
        truth = at_cold / (1.0 + at_cold * (found.T_ref - 25.0))  # the virtual rig's reference is 25 degC
        value, u = found.terms[name]
        assert abs(value - truth) < 3.5 * u
        assert abs(value / truth - 1.0) < 0.25
    noise = np.sqrt(np.nanmean(result.points.u_Fy**2))
    assert found.channels["Fy"].rmse < 1.1 * noise < 1.5 * noise < result.fit.channels["Fy"].rmse
    assert not result.reasons  # the cause is modelled
    still = Simulation.of(found.file.tyre, turn_slip=False).readings(result.points).Fy - result.points.Fy
    assert found.alone["Fy"].rmse == pytest.approx(np.sqrt(np.mean(still**2)), rel=0.02)


def test_the_file_at_temperature_is_the_tyre_at_any_temperature(warmed):
    _, folder = warmed
    file = tir.read(folder / "small-at-temperature.tir")
    true = small_rigs.truth()
    alpha = np.radians(np.linspace(-7.0, 7.0, 29))
    for T in (COLD, WARM):
        scaled = true.replace(
            LMUY=1.0 + TERMS["k_T_grip_per_K"] * (T - 25.0),
            LKY=1.0 + TERMS["k_T_stiffness_per_K"] * (T - 25.0),
        )
        aim = scaled(1400.0, alpha, p=230e3).Fy
        assert np.max(np.abs(file.at_temperature(T)(1400.0, alpha, p=230e3).Fy - aim)) < 12.0
        assert np.max(np.abs(tir.read(folder / "small.tir")(1400.0, alpha, p=230e3).Fy - aim)) > 40.0


def test_a_comparison_with_data_takes_the_file_to_their_temperatures(warmed):
    result, folder = warmed
    found = mffit.compare(folder / "small-at-temperature.tir", folder.parent / "tyre.toml")
    gaps = [row.rms for row in found.sweeps if row.channel == "Fy"]
    # the file is the tyre without the zeros of the rig, of which the fit finds up to a noise
    assert np.sqrt(np.mean(np.square(gaps))) < 1.5 * np.sqrt(np.nanmean(result.points.u_Fy**2))
    assert any("holds at" in note for note in found.notes)


def test_both_files_and_the_terms_are_where_a_program_looks(warmed):
    result, folder = warmed
    content = json.loads((folder / "result.json").read_text())
    assert content["files"]["temperature"] == "small-at-temperature.tir"
    assert content["tir"] == "small.tir"
    for name, (value, u) in result.fit.temperature.terms.items():
        assert content["fit"]["rig"][name] == {"value": value, "stderr": u, "unit": "1/K"}
    assert content["fit"]["rig"]["T_ref_degC"]["value"] == result.fit.temperature.T_ref
    assert content["fit"]["temperature"]["T_min_degC"] == COLD
    assert content["fit"]["temperature"]["T_max_degC"] == WARM
    modelled = {row["id"]: row["modelled"] for row in content["fit"]["modelled"]}
    assert modelled == {
        "temperature": True, "temperature-curvature": False, "temperature-camber": True, "hysteresis": False, "lag": False,
        "warm-up": False, "wear": False, "temperature-slip": False, "speed": False, "speed-slip": False,
        "pressure-arm": False, "run-scale": False,
    }  # fmt: skip
    with pytest.raises(tir.TirError, match="no temperature terms"):
        tir.read(folder / "small.tir").at_temperature(30.0)


def test_the_first_sentence_says_which_file_is_for_whom_and_what_each_leaves(warmed):
    result, folder = warmed
    first = result.fit.explanations[0]
    assert first.startswith("small.tir is for simulations that do not know the temperature of the tyre")
    assert "small-at-temperature.tir" in first
    assert f"{result.fit.channels['Fy'].rmse:.3g} N" in first
    assert f"{result.fit.temperature.channels['Fy'].rmse:.3g} N" in first
    assert "small-at-temperature.tir" in (folder / "report.html").read_text(encoding="utf-8")


def test_the_file_at_temperature_names_the_coefficients_that_contain_the_warming(warmed):
    """Pressure was changed while the tyre was warm: PPY3 and PPY4 of the plain file contain some of it in every campaign."""
    fit = warmed[0].fit
    true = small_rigs.truth()
    assert fit.temperature.moved
    for name, (there, here, u) in fit.temperature.moved.items():
        assert fit.coefficients[name].value == there
        assert abs(there - here) > u
    for name in ("PPY4", "PDY2"):
        row = fit.temperature.coefficients[name]
        assert abs(row.value - true[name]) < 3.5 * row.stderr


@pytest.mark.parametrize(
    ("T", "keys", "reason"),
    [
        (None, {"temperature": False}, "[fit] temperature = false"),
        (lambda T: 40.0 + 0.1 * (T - 40.0), {}, "T_degC moves by 2.5 K only, and 3 K are needed"),
        (lambda T: np.full_like(T, np.nan), {}, "T_degC was not measured"),
        (lambda T: np.where(np.arange(len(T)) < 7, np.nan, T), {}, "T_degC is missing at 7 of"),
        (
            lambda T: np.random.default_rng(1).permutation(T),
            {},
            "what it explains is within chance",
        ),
    ],
    ids=["off", "constant", "unknown", "partly", "shuffled"],
)
def test_temperature_is_not_modelled_and_the_reason_is_given(warmed, T, keys, reason):
    result, _ = warmed
    search, points = result.fit.search, result.points
    if T is not None:
        points = points.replace(T=T(points.T))
    search = replace(search, problem=replace(search.problem, points=points))
    found = verdict(choose(with_setting(result, **keys), search), "temperature")
    assert not found.modelled
    assert found.reason.startswith(reason)


def test_a_plan_in_which_temperature_runs_along_with_pressure_is_criticised(warmed):
    """The pressures were run one after the other while the tyre warmed up."""
    result, folder = warmed
    (row,) = result.fit.confounded
    assert (row.setting, row.coefficient[:3]) == ("pressure", "PPY")
    assert 0.85 < row.correlation < 1.0
    assert row.growth > 1.5
    assert any("runs along with the pressure" in sentence for sentence in result.warnings)
    assert json.loads((folder / "result.json").read_text())["fit"]["confounded"][0]["growth"] == row.growth


def test_the_growth_is_that_over_known_terms(warmed):
    """By the conditional variance of the joint posterior of independent readings, as the fit weighs them."""
    row, full = warmed[0].fit.confounded[0], warmed[0].fit.full
    posterior = told_by_weights(full.problem, full.numbers, {})
    C = posterior.covariance
    i = posterior.names.index(row.coefficient)
    k = [posterior.names.index(name) for name in ("k_T_grip_per_K", "k_T_stiffness_per_K")]
    known = C[i, i] - C[i, k] @ np.linalg.solve(C[np.ix_(k, k)], C[k, i])
    assert row.growth == pytest.approx(np.sqrt(C[i, i] / known), rel=0.03)


def test_a_mixed_order_of_the_runs_is_not_criticised(warmed):
    search = warmed[0].fit.search
    points = search.problem.points
    mixed = points.replace(T=np.random.default_rng(2).permutation(points.T))
    assert confoundings(replace(search, problem=replace(search.problem, points=mixed))) == ()


def test_a_temperature_that_follows_the_sideslip_is_criticised(warmed):
    """Every sweep is warm at its ends: friction and shape of the curve then depend on what the temperature does."""
    search = warmed[0].fit.search
    points = search.problem.points
    hot = 30.0 + 150.0 * np.abs(points.alpha) + np.random.default_rng(6).normal(0.0, 1.0, len(points))
    found = confoundings(replace(search, problem=replace(search.problem, points=points.replace(T=hot))))
    (row,) = [row for row in found if row.setting == "sideslip"]
    assert row.correlation > 0.9
    assert row.coefficient[:2] in ("PD", "PE", "PC", "PK")
    assert row.growth > 1.5


def test_a_temperature_that_mostly_follows_the_load_is_said_though_no_coefficient_suffers(warmed):
    """Model error over the load is then taken for the warming, however well the readings tell both apart."""
    search = warmed[0].fit.search
    points = search.problem.points
    random = np.random.default_rng(7)
    T = 30.0 + 10.0 * (
        points.Fz / points.Fz.mean()
        + 0.6 * np.std(points.Fz) / points.Fz.mean() * random.normal(size=len(points))
    )
    found = confoundings(replace(search, problem=replace(search.problem, points=points.replace(T=T))))
    (row,) = [row for row in found if row.setting == "load"]
    assert 0.75 < row.correlation < 0.95
    assert not row.widens
    assert "model error over the load" in confounding_sentence(row, modelled=True)


def test_temperature_that_is_demanded_but_not_measured_is_refused(warmed):
    result, _ = warmed
    search = result.fit.search
    search = replace(search, problem=replace(search.problem, points=search.problem.points.replace(T=np.nan)))
    with pytest.raises(
        InputError, match="asks for the tyre temperature, but T_degC was not measured"
    ) as refused:
        choose(with_setting(result, temperature=True), search)
    assert refused.value.key == "fit.temperature"


def test_friction_that_is_greatest_at_one_temperature_gets_a_curvature(tmp_path):
    """The virtual rig's friction is 1 - 0.002 (T - 40) - 0.0003 (T - 40)^2 times that of the file; sweeps start cold or warm."""
    linear, curvature, T_ref = -0.002, -3e-4, 40.0
    content = small_rigs.flat(
        faults={"k_T_grip_per_K": linear, "k_T_grip_per_K2": curvature, "T_ref_degC": T_ref}
    )
    slip = [sweep for sweep in content["sweep"] if "sideslip" in sweep["file"]]
    starts = iter(np.random.default_rng(3).permutation(np.linspace(22.0, 50.0, 18)).tolist())
    content["sweep"] = [
        {**sweep, "file": f"{pressure}_{again}_{sweep['file']}", "p_kPa": pressure, "T_degC": [T, T + 8.0]}
        for pressure in (250, 200, 300)
        for again in "ab"
        for sweep, T in zip(slip, starts)  # noqa: B905 - the iterator goes on
    ]
    small_rigs.simulated(content, tmp_path)
    result = mffit.build(tmp_path / "tyre.toml", tmp_path / "out", with_report=False)
    assert verdict(result.fit.choice, "temperature-curvature").modelled
    file = tir.read(tmp_path / "out" / "small-at-temperature.tir")
    for T in (25.0, 40.0, 55.0):
        friction = 1.0 + linear * (T - T_ref) + curvature * (T - T_ref) ** 2
        aim = small_rigs.truth().replace(LMUY=friction)(1400.0, np.radians(-8.0)).Fy
        assert file.at_temperature(T)(1400.0, np.radians(-8.0)).Fy == pytest.approx(aim, rel=0.006)
    assert "its curvature" in result.fit.explanations[0]
    assert " per K^2" in result.fit.explanations[0]
    rig = json.loads((tmp_path / "out" / "result.json").read_text())["fit"]["rig"]
    assert rig["k_T_grip_per_K2"]["unit"] == "1/K^2"


def test_temperature_that_is_demanded_is_modelled(warmed):
    result, _ = warmed
    found = verdict(choose(with_setting(result, temperature=True), result.fit.search), "temperature")
    assert found.modelled
    assert found.reason == "[fit] temperature = true"


@pytest.mark.parametrize("width", [0.25, -0.25])
def test_a_hysteresis_of_moving_sweeps_is_found_and_left_out_of_the_file(tmp_path, width):
    """A force that leads its angle, as on no rig, is not modelled: something else looks like it."""
    content = small_rigs.flat(faults={"hysteresis_deg": width})
    there_and_back = [*small_rigs.SLIP, *(x - 0.01 for x in small_rigs.SLIP[::-1])]
    content["sweep"] = [
        {**sweep, "alpha_deg": there_and_back} if "sideslip" in sweep["file"] else sweep
        for sweep in content["sweep"]
        if "forward" not in sweep["file"]
    ] + [
        {"file": f"tilted_{gamma}.csv", "load_N": 1400, "alpha_deg": there_and_back, "gamma_deg": [gamma]}
        for gamma in (-20, -10, 10, 20)
    ]
    result = small_rigs.built(content, tmp_path)
    if width < 0.0:
        found = verdict(result.fit.choice, "hysteresis")
        assert (found.modelled, "hysteresis_deg" in result.fit.rig) == (False, False)
        assert "no rig has one of this sign" in found.reason
        return
    value, u = result.fit.rig["hysteresis_deg"]
    assert value == pytest.approx(0.25, abs=max(4.0 * u, 0.02))
    assert verdict(result.fit.choice, "hysteresis").modelled
    assert any("hysteresis of sideslip sweeps is modelled" in line for line in result.fit.explanations)
    assert result.fit.temperature is None
    alpha = np.radians(np.linspace(-6.0, 6.0, 25))
    apart = result.tyre(1400.0, alpha).Fy - small_rigs.truth()(1400.0, alpha).Fy
    assert np.max(np.abs(apart)) < 12.0


def lacking_sense(sweeps):
    """What the choice says of the sense of sweeps, each of (load in N, camber in deg, angles in deg)."""
    loads, cambers, angles = zip(*sweeps, strict=True)
    sizes = [len(alpha) for alpha in angles]
    points = make_points(
        np.radians(np.concatenate(angles)),
        np.radians(np.repeat(np.array(cambers, dtype=float), sizes)),
        np.repeat(np.array(loads, dtype=float), sizes),
        p=250e3, V=6.0, phi_t=0.0, sweep=np.repeat(np.arange(len(sweeps)), sizes),
        sweep_names=tuple(f"s{k}" for k in range(len(sweeps))),
    )  # fmt: skip
    return next(n for n in NUISANCES if n.id == "hysteresis").lacking(points)


UP = np.linspace(-8.0, 8.0, 17)


@pytest.mark.parametrize(
    ("sweeps", "said"),
    [
        ([(1400, 10, np.r_[UP, UP[::-1]])] * 2, ""),  # there and back
        ([(1400, 0, UP), (1400, 0, UP[::-1])], ""),  # there, and back in another sweep
        ([(F, g, UP[:: (-1) ** k]) for k, (F, g) in enumerate(NINE)], ""),  # ways alternate over conditions
        ([(1400, 10, UP), (1400, -10, UP[::-1])], "differ in load, camber"),  # looks like camber thrust
        ([(F, g, UP[:: 1 if F < 2000 else -1]) for F, g in NINE], "differ in load, camber"),
        ([(1400, 0, np.tile(UP, 3))] * 2, "same angles up and down"),  # jumps back
        ([(1400, 0, UP + 9.0), (1400, 0, UP[::-1] - 9.0)], "same angles up and down"),
    ],
)
def test_the_sense_shows_where_conditions_do_not_tell_it(sweeps, said):
    found = lacking_sense(sweeps)
    assert (said in found) if said else found == ""


def test_the_lag_of_ramps_that_alternate_over_the_conditions_is_off_the_file(tmp_path):
    """One ramp per load and camber, each the other way than the one before; a tyre that lags by a fixed angle."""
    content = small_rigs.flat(faults={"hysteresis_deg": 0.25})
    ways = [small_rigs.SLIP, small_rigs.SLIP[::-1]]
    content["sweep"] = [
        {"file": f"ramp_{k}.csv", "load_N": F, "gamma_deg": [g], "alpha_deg": ways[k % 2]}
        for k, (F, g) in enumerate(NINE)
    ]
    result = small_rigs.built(content, tmp_path)
    assert verdict(result.fit.choice, "hysteresis").modelled
    value, u = result.fit.rig["hysteresis_deg"]
    assert value == pytest.approx(0.25, abs=max(4.0 * u, 0.02))


@pytest.mark.parametrize("key", ["wear", "warm_up"])
def test_a_change_over_the_distance_is_found_if_it_is_asked_for(warmed, key):
    """The readings of the fitted tyre, changed by formulae of this test over the distance rolled."""
    search = warmed[0].fit.search
    problem, count = search.problem, len(search.problem.points)
    points = problem.points.replace(t=3.0 * np.arange(count))
    sound = search.simulation.readings(points)
    km = points.t * points.V / 1000.0
    factor = 1.0 - 0.02 * km if key == "wear" else 1.0 - 0.08 * np.exp(-km)
    rng = np.random.default_rng(3)
    Fy = sound.Fy * factor + 3.0 * rng.standard_normal(len(km))
    Mz = sound.Mz * factor + 0.3 * rng.standard_normal(len(km))
    changed = replace(search, problem=replace(problem, points=points.replace(Fy=Fy, Mz=Mz)))
    asked = choose(with_setting(warmed[0], temperature=False, wear="auto", warm_up="auto"), changed)
    name = key.replace("_", "-")
    assert [row.nuisance.id for row in asked.verdicts if row.modelled] == [name]
    number = "wear_per_km" if key == "wear" else "warm_up"
    assert asked.near.problem.value(number) == pytest.approx(-0.02 if key == "wear" else 0.08, rel=0.25)
    silent = choose(with_setting(warmed[0], temperature=False), changed)
    assert verdict(silent, name).reason == f"[fit] {key} = false"


@pytest.fixture(scope="module")
def moved(tmp_path_factory):
    """A flat track's recording of moving sweeps, behind which the forces lag by a filter of its own."""
    folder = tmp_path_factory.mktemp("moved")
    write_mat73(recording(sigma=0.5, seed=4, cambers=(0.0, 3.0)), folder / "run.mat")
    columns = {"alpha_deg": "SA", "gamma_deg": "IA", "Fz_N": "FZ", "Fy_N": "FY", "Mz_Nm": "MZ", "p_kPa": "P"}
    content = {
        "tyre": {"name": "belt", "unloaded_radius": 0.2057, "nominal_load": 1500, "nominal_pressure": 90},
        "rig": {"type": "flat-track", "axes": "calspan"},
        "columns": columns | {"V_mps": "V", "time_s": "ET"},
        "sweep": [{"file": "run.mat"}],
    }
    return mffit.build(configuration.load(content, folder=folder))


def test_a_lag_of_recorded_sweeps_is_told_from_a_hysteresis(moved):
    """The rate of sideslip of the recording changes sign."""
    found = moved.fit
    assert verdict(found.choice, "lag").modelled
    assert not verdict(found.choice, "hysteresis").modelled
    value, u = found.rig["relaxation_m"]
    delayed = SPEED / RATE / np.expm1(SPEED / RATE / 0.5)  # the mean delay of that filter, which is sampled
    assert value == pytest.approx(delayed, abs=max(3.0 * u, 0.03))


def test_stiffnesses_of_moving_sweeps_are_those_of_the_tyre_at_rest(moved):
    """13 and 1.05 times the load per radian, in result.json as in the headline; the slope of the readings at rest is far off."""
    load, stated = 1500.0, as_json.document(moved)["spin"]
    shown = {line.name: line.value for line in headlines(moved)}
    for name, slope in (("C_alpha", 13.0), ("C_gamma", 1.05)):
        value, u = stated[f"{name}_N_per_rad"], stated[f"u_{name}_N_per_rad"]
        assert value == pytest.approx(-slope * load, abs=0.05 * slope * load)
        assert u < 0.05 * slope * load
        known = CHARACTERISTICS[KEYS[name]]
        assert shown[f"{known.word.capitalize()} {known.ascii}"] == in_words(
            Quantity(value, u, "N/rad"), known.unit_behind
        )
        assert moved.tyres["normal"].measured[KEYS[name]].origin == "fitted"
        assert not stated["budgets"]
    assert stated["load_N"] == load
    assert [row["load_N"] for row in stated["per_load"]] == sorted(
        row["load_N"] for row in stated["per_load"]
    )
    before = measure(moved.config, moved.points, None)[1].nominal
    assert before is None or before.C_gamma is None or before.C_gamma.u > 0.2 * 1.05 * load


def test_every_influence_has_words_and_numbers_of_its_own():
    assert len({nuisance.id for nuisance in NUISANCES}) == len(NUISANCES)
    freed = [name for nuisance in NUISANCES for name in nuisance.numbers]
    assert len(set(freed)) == len(freed)
    assert {nuisance.after for nuisance in NUISANCES} - {""} <= {nuisance.id for nuisance in NUISANCES}


def drawn_campaign(seed, folder, terms, scatter=0.0):
    """Thirteen sweeps of a drawn tyre that warms by 28 K; grip and stiffness of a sweep may scatter."""
    rng = np.random.default_rng(seed)
    content = small_rigs.flat(faults=terms)
    sweeps = [
        {**sweep, "file": f"{pressure}_{sweep['file']}", "p_kPa": pressure}
        for pressure in (250, 200, 300)
        for sweep in content["sweep"]
        if "forward" not in sweep["file"] and (pressure == 250 or "sideslip" in sweep["file"])
    ]
    ends = COLD + 28.0 * (1.0 - np.exp(-np.linspace(0.0, 2.5, len(sweeps) + 1))) / (1.0 - np.exp(-2.5))
    order = rng.permutation(len(sweeps)).tolist()
    content["sweep"] = [
        sweeps[k]
        | {"T_degC": [float(first), float(last)]}
        | {"faults": dict(zip(("run_grip", "run_stiffness"), (scatter * rng.standard_normal(2)).tolist()))}  # noqa: B905
        for k, first, last in zip(order, ends[:-1], ends[1:], strict=True)
    ]
    true = scaled(small_rigs.truth(), 0.1, rng)
    true.write(folder / "drawn.tir")
    content["truth"] = {"tyre": str(folder / "drawn.tir")}
    return small_rigs.built(content, folder / "rig", seed)


def test_a_plain_warming_is_found_although_few_sweeps_hold_most_of_its_gain(tmp_path):
    """Fy falls by 14 %: without the terms left-out sweeps miss it by ten times the noise, most of it in one or two of them."""
    terms = {"k_T_grip_per_K": -0.005, "k_T_stiffness_per_K": -0.005, "k_T_camber_per_K": -0.005}
    result = drawn_campaign(0, tmp_path, terms)
    assert verdict(result.fit.choice, "temperature").modelled
    assert not result.reasons
    for name, (value, u) in result.fit.temperature.terms.items():
        if name in terms:
            truth = terms[name] / (1.0 + terms[name] * (result.fit.temperature.T_ref - COLD))
            assert abs(value - truth) < 4.0 * u


def test_warming_without_an_effect_is_not_modelled_even_if_runs_differ(tmp_path):
    """Thirteen gripping and slipping runs in some order are more or less like a warming."""
    result = drawn_campaign(1, tmp_path, {}, scatter=0.01)
    assert not verdict(result.fit.choice, "temperature").modelled


@pytest.mark.parametrize(("spread", "ratio"), [(0.0, 0.0), (0.2, np.sqrt(0.5)), (20.0, np.sqrt(0.5))])
def test_the_correlation_ratio_does_not_depend_on_the_size_of_the_temperature(spread, ratio):
    """Warmest at the middle one of three pressures, and as much again within each: half of the variance is explained."""
    p, way = np.repeat([180e3, 220e3, 260e3], 4), np.tile([1.0, -1.0], 6)
    between = np.where(p == 220e3, np.sqrt(2.0), -np.sqrt(0.5))
    points = make_points(0.02, 0.0, 1500.0, p=p, V=6.0, phi_t=0.0, T=30.0 + spread * (between + way))
    assert correlation_ratio(points, "p") == pytest.approx(ratio)
