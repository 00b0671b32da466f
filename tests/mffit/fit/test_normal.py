"""The file for simulations without turn slip, and what both files state."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from normal_outcome import box, limit, outcome, usual_ranges

import mffit
import tir
from mffit import as_json
from mffit.config.models import NormalTable
from mffit.diagnosis.notes import ModelFittedFirst
from mffit.fit.comments import whole_words
from mffit.fit.written.files import file_names, use_mode
from mffit.fit.written.normal import derive
from mffit.fit.written.road import forces, inside, road_grid, weights
from mffit.pipeline.diagnosing import chosen_model
from mffit.pipeline.provenance import use_of
from mffit.tested import end_tested
from tir.checking import check
from tir.parameters import TABLE

SAMPLES = Path(__file__).parents[3] / "samples"


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    out = tmp_path_factory.mktemp("front") / "out"
    return mffit.build(SAMPLES / "front-120-70" / "tyre.toml", out, with_report=False), out


@pytest.fixture(scope="module")
def result(built):
    return built[0]


@pytest.fixture(scope="module")
def truth():
    return tir.read(SAMPLES / "front-120-70" / "true.tir")


def test_both_files_are_written_each_for_its_use(built):
    result, out = built
    assert result.files == {"turn-slip": "front-120-70.tir", "normal": "front-120-70-normal.tir"}
    on_disk = {use: tir.read(out / name) for use, name in result.files.items()}
    # MF-Tyre's digits: 2 circular cross-section of a motorcycle tyre, 2 nonlinear transient, 5 or 4 with or without turn slip
    assert {use: int(tyre["USE_MODE"]) for use, tyre in on_disk.items()} == {"turn-slip": 225, "normal": 224}
    assert {use_of(tyre) for tyre in on_disk.values()} == {"turn-slip", "normal"}
    assert as_json.document(result)["files"] == result.files
    assert as_json.document(result)["tir"] == "front-120-70.tir"


def test_exact_selects_the_file_with_the_plain_name():
    names = {"turn-slip": "a-turn-slip.tir", "normal": "a.tir"}
    assert file_names("a", "normal", True) == names
    assert file_names("a", "turn-slip", False) == {"normal": "a.tir"}


@pytest.mark.parametrize(
    ("turn_slip", "name"), [(True, "front-120-70.tir"), (False, "front-120-70-normal.tir")]
)
def test_diagnosis_takes_the_file_of_its_simulation(built, turn_slip, name):
    result, out = built
    table = result.config.model.model_copy(update={"turn_slip": turn_slip})
    config = result.config.model_copy(update={"model": table})
    config._folder = out.parent
    tyre, notes, _ = chosen_model(config, None, lambda sentence: None)
    assert not any(isinstance(note, ModelFittedFirst) for note in notes)
    assert tyre == tir.read(out / name)


def test_a_tyre_without_motorcycle_contour_gets_a_smooth_road():
    assert use_mode({"MC_CONTOUR_A": 0.0}, "turn-slip") == 125
    assert use_mode({"MC_CONTOUR_A": 0.0}, "normal") == 124


def test_the_upright_wheel_is_the_same_in_both_files(result):
    on, off = result.tyres["turn-slip"], result.tyres["normal"]
    alpha = np.radians(np.linspace(-15, 15, 31))
    for channel in ("Fy", "Mz"):
        with_spin = getattr(on(1800.0, alpha, turn_slip=True), channel)
        without = getattr(off(1800.0, alpha, turn_slip=False), channel)
        assert without == pytest.approx(with_spin, abs=1e-6)


def test_the_normal_file_follows_the_true_tyre_on_a_straight_path(result, truth):
    """The formula's own limit on this tyre is 44 N and 1.8 Nm (tests/studies/normal_study.py); the fit adds its noise."""
    road = box(truth["FNOMIN"], truth["NOMPRES"])
    made = forces(result.tyres["normal"].values, road, turn_slip=False)
    true = forces(truth.values, road, turn_slip=True)
    assert np.sqrt(np.mean((made.Fy - true.Fy) ** 2)) < 52.0
    assert np.sqrt(np.mean((made.Mz - true.Mz) ** 2)) < 2.5


def test_derivation_comes_within_a_twentieth_of_the_limit(truth):
    found = outcome(truth)
    Fy, Mz = limit(truth)
    assert found.Fy < 1.05 * Fy
    assert found.Mz < 1.05 * Mz


def test_camber_thrust_does_not_turn_back_where_the_model_does_not(result):
    gamma = np.linspace(0.0, result.tyre["CAMMAX"], 40)
    for load in (600.0, 1400.0, 2300.0):
        model = np.diff(result.tyres["turn-slip"](load, gamma=gamma, turn_slip=True).Fy)
        made = np.diff(result.tyres["normal"](load, gamma=gamma, turn_slip=False).Fy)
        assert np.all(made[model < 0.0] < 1.0)


def test_the_missing_force_and_stiffness_of_the_normal_file_are_stated(result):
    files = result.fit.files
    assert 0.0 < files.stiffness_loss < 0.25
    forces = list(files.lacking.values())
    assert forces == sorted(forces)
    assert (
        as_json.document(result)["fit"]["files"]["normal"]["turn_slip_force_lacking_N"]["10 m"] == forces[-1]
    )


def test_with_the_weight_of_the_road_the_file_is_better_where_one_rides(result):
    files, values = result.fit.files, dict(result.tyre.values)
    made = derive(values, files.tested, files.written, weight="road")
    road = road_grid(files.tested, files.written, values["FNOMIN"])
    aim = forces(values, road, turn_slip=True).Fy
    off = forces({**values, **made}, road, turn_slip=False).Fy - aim
    within = inside(road, files.tested)
    ridden = weights(road, files.tested, "road")[within]
    here = files.by_use["normal"].straight["Fy"]
    assert np.sqrt(np.average(off[within] ** 2, weights=ridden)) < here.ridden
    assert here.rms < np.sqrt(np.mean(off[within] ** 2)) < 1.5 * here.rms
    stated = as_json.document(result)["fit"]["files"]["normal"]
    assert (stated["weight"], stated["camber_max_deg"]) == ("everything", None)


def test_held_to_thirty_degrees_the_file_is_four_times_as_near(result):
    """Independently computed, the formula reaches 11 to 15 N to 30 deg; CAMMAX is that of this file alone."""
    config = result.config.model_copy(update={"normal": NormalTable(camber_max_deg=30.0)})
    config._folder, config._path = result.config.folder, result.config.path
    held = mffit.build(config).fit.files
    normal = held.by_use["normal"]
    assert normal.straight["Fy"].rms < 16.0
    assert (normal.tyre["CAMMIN"], normal.tyre["CAMMAX"]) == pytest.approx((-np.pi / 6.0, np.pi / 6.0))
    assert "[normal] camber_max_deg" in normal.tyre.status["CAMMAX"]
    assert end_tested(normal.tyre.status["CAMMAX"]) == pytest.approx(np.pi / 6.0, rel=1e-5)
    assert held.by_use["turn-slip"].tyre["CAMMAX"] == result.tyre["CAMMAX"]
    assert abs(normal.camber_stiffness) > abs(result.fit.files.by_use["normal"].camber_stiffness)


def test_pecp1_is_the_measured_eps_gamma(result):
    assert result.tyre["PECP1"] == result.measured.epsilon_gamma.value


@pytest.mark.parametrize("use", ["turn-slip", "normal"])
def test_limits_hold_over_the_written_ranges(result, use):
    sentences = [p.sentence for p in check(result.tyres[use]) if p.level == "error" or "E_y" in p.sentence]
    assert not sentences


def test_written_ranges_exceed_the_tested_ones_and_state_them(result):
    tyre, tested = result.tyre, result.fit.files.tested
    assert np.degrees(tyre["ALPMAX"]) == pytest.approx(20.0)
    assert np.degrees(tested["CAMMAX"]) == pytest.approx(50.0, abs=0.5)
    assert tyre["FZMIN"] < 0.7 * tested["FZMIN"] < tested["FZMAX"] < tyre["FZMAX"]
    assert tyre["PRESMIN"] < tested["PRESMIN"] < tested["PRESMAX"] < tyre["PRESMAX"]
    assert "tested to" in tyre.status["FZMAX"]


def test_every_value_has_an_origin(built):
    result, out = built
    again = tir.read(out / result.tir_path)
    numbers = {row.name for row in TABLE if row.kind == "number"} - {"QDRP2"}
    assert numbers <= again.status.keys()
    assert again["TYRESIDE"] == "LEFT"
    stated = as_json.document(result)["fit"]["coefficients"]
    assert numbers <= stated.keys()
    assert all(c["status"] and c["origin"] for c in stated.values())


def test_no_comment_is_cut_within_a_word():
    assert whole_words("a tyre of many words", 10) == "a tyre of"
    assert whole_words("short", 10) == "short"


def test_fitted_values_have_their_standard_error_in_the_file(result, tmp_path):
    result.tyre.write(tmp_path / "t.tir")
    again = tir.read(tmp_path / "t.tir")
    assert again == result.tyre
    assert again.status["PKY1"].startswith("fitted +- ")
    assert again.status["PKX1"] == "from base"
    assert again.measured["epsilon_gamma"].u == pytest.approx(result.measured.epsilon_gamma.u)


def test_a_straight_path_measures_no_spin():
    flat = mffit.build(SAMPLES / "flat-track" / "tyre.toml")
    assert flat.measured.epsilon_gamma is None
    assert flat.files == {"normal": "flat-track.tir"} or len(flat.files) == 1
    assert str(int(flat.tyre["USE_MODE"])).endswith("4")
    assert flat.fit.coefficients["PECP1"].fixed
    assert all(not row.free for row in flat.fit.coverage if row.stage == "spin")


@pytest.mark.parametrize("sample", ["front-120-70", "rear-190-55"])
def test_one_file_for_both_uses_is_better_than_either_in_the_other_ones_use(sample):
    truth = tir.read(SAMPLES / sample / "true.tir")
    values, tested = dict(truth.values), usual_ranges(truth)
    written = {**tested}
    both = {**values, **derive(values, tested, written, both_on=-1 / 1.323)}
    normal = {**values, **derive(values, tested, written)}
    road = box(values["FNOMIN"], values["NOMPRES"])

    def misfit(file, *, turn_slip, phi_t=0.0):
        there = forces(values, road, turn_slip=True, phi_t=phi_t).Fy
        return np.sqrt(np.mean((forces(file, road, turn_slip=turn_slip, phi_t=phi_t).Fy - there) ** 2))

    assert misfit(both, turn_slip=False) < 0.5 * misfit(values, turn_slip=False)
    for phi_t in (0.0, -1 / 1.323):
        assert misfit(both, turn_slip=True, phi_t=phi_t) < 0.5 * misfit(normal, turn_slip=True, phi_t=phi_t)
    upright = np.radians(np.linspace(-8, 8, 9))
    a, b = (tir.Tyre.from_values(v)(values["FNOMIN"], upright, turn_slip=False) for v in (both, values))
    assert a.Fy == pytest.approx(b.Fy, abs=1e-6)
