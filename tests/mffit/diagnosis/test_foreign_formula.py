"""An effect beside what the formula misses is named, and what it leaves is said: the tyre is of another formula.

The brush of ``brush.py`` and the tyre of four lines of ``disc_project.py`` are independent programs that no Magic Formula fits.
"""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import brush
import numpy as np
import pandas as pd
import pytest
from brush import Brush
from disc_project import disc_project

import mffit
import tir
from mffit.diagnosis import Diagnosis
from mffit.diagnosis.notes import CountsAsExact, LeftByFormula, WithoutModelError
from mffit.diagnosis.odd_level import OddLevel
from mffit.diagnosis.rest import Answer
from tir import Tyre


def toy(folder: Path, seed: int, *, turn_slip: bool = True, zeros: Mapping[str, float] | None = None) -> Path:
    """The small campaign on a disc, with more noise [N], [Nm] of a draw of its own, and ``zeros`` of the rig by column."""
    project, rng = disc_project(folder), np.random.default_rng(seed)
    project.config["spin"] = {"exact": "turn-slip"}
    project.config["model"] = {"turn_slip": turn_slip}
    for table in project.tables.values():
        table["Fy_N"] += 2.5 * rng.standard_normal(len(table))
        table["Mz_Nm"] += 0.25 * rng.standard_normal(len(table))
        for column, zero in (zeros or {}).items():
            table[column] += zero
    return project.write()


@pytest.fixture(scope="module")
def built_toy(tmp_path_factory) -> Path:
    """The best file for it, which misses by 8 N where the noise is 5 N, next to its result.json."""
    out = tmp_path_factory.mktemp("toy") / "out"
    name = mffit.build(toy(out.parent, 7), out=out, with_report=False).tyre
    return next(path for path in sorted(out.glob("*.tir")) if tir.read(path).values == name.values)


@pytest.fixture(scope="module")
def fitted_toy(built_toy) -> Tyre:
    """That file alone."""
    return tir.read(built_toy)


@pytest.fixture(scope="module")
def built_brush(tmp_path_factory) -> Path:
    """The file of a build for the brush, which misses by 11 N where the noise is 6 N, next to its result.json."""
    out = tmp_path_factory.mktemp("brush") / "out"
    mffit.build(brush.written(Brush(), out.parent, 51), out=out, with_report=False)
    return out / "brush.tir"


@pytest.fixture(scope="module")
def fitted_brush(built_brush) -> Tyre:
    """That file alone."""
    return tir.read(built_brush)


def softer(tyre: Tyre) -> Tyre:
    """The file with 0.6 of its camber stiffness."""
    return tyre.replace(PKY6=0.6 * tyre["PKY6"], PKY7=0.6 * tyre["PKY7"])


def assert_named(found: Diagnosis, *effects: str) -> None:
    """These alone, and what the formula misses stays unexplained."""
    assert {one.effect.id for one in found.effects} == {*effects}
    assert found.unexplained


def test_a_wrong_camber_reduction_is_named_beside_the_miss_of_the_formula(fitted_toy, tmp_path):
    wrong = fitted_toy.replace(PECP1=fitted_toy["PECP1"] + 0.3)
    found = mffit.diagnose(toy(tmp_path, 2), wrong)
    assert_named(found, "camber-reduction")
    assert found.tyre["PECP1"] == pytest.approx(fitted_toy["PECP1"], abs=0.1)


def test_errors_of_the_rig_are_named_beside_the_miss_of_the_formula(fitted_brush, tmp_path):
    project = brush.written(Brush(), tmp_path, 81)
    for path in tmp_path.glob("*.csv"):
        table = pd.read_csv(path)
        table.assign(Mz_Nm=table["Mz_Nm"] + 1.5, Fy_N=1.04 * table["Fy_N"]).to_csv(path, index=False)
    assert_named(mffit.diagnose(project, fitted_brush), "loadcell-offset-mz", "loadcell-gain")


def test_what_a_build_left_of_its_own_readings_is_not_missing_in_others(built_brush, tmp_path):
    found = mffit.diagnose(brush.written(Brush(), tmp_path, 81), built_brush)
    assert not found.effects
    assert not found.unexplained
    assert found.trusted
    (note,) = [note for note in found.notes if isinstance(note, WithoutModelError)]
    assert 6.0 < note.missed["Fy"] < 15.0
    assert found.gap_examined.rms("Fy") < 0.85 * found.gap_before.rms("Fy")


def warm(project: Path, seed: int) -> Path:
    """The project with runs at temperatures of their own, drawn from 30 to 60 degC; friction falls by 0.5 % per kelvin."""
    rng = np.random.default_rng(seed)
    for path in sorted(project.parent.glob("*.csv")):
        table, T = pd.read_csv(path), rng.uniform(30.0, 60.0)
        less = 1.0 - 0.005 * (T - 45.0)
        table.assign(T_degC=T, Fy_N=less * table["Fy_N"], Mz_Nm=less * table["Mz_Nm"]).to_csv(
            path, index=False
        )
    return project


def test_what_a_build_left_is_not_missing_beside_its_temperature_terms(tmp_path):
    """The plain file also misses by what its coefficients took up of the warming, which is not that of other runs."""
    folders = {seed: tmp_path / str(seed) for seed in (51, 81)}
    for folder in folders.values():
        folder.mkdir()
    first, other = (warm(brush.written(Brush(), folder, seed), seed) for seed, folder in folders.items())
    built = mffit.build(first, out=tmp_path / "out", with_report=False)
    assert built.fit.temperature
    found = mffit.diagnose(other, tmp_path / "out" / "brush.tir")
    assert {one.effect.id for one in found.effects} == {"temperature"}
    assert not found.unexplained
    assert [note for note in found.notes if isinstance(note, WithoutModelError)]
    right = tir.read(tmp_path / "out" / "brush.tir")
    softer(right).write(tmp_path / "out" / "brush.tir")
    found = mffit.diagnose(other, tmp_path / "out" / "brush.tir")
    assert {one.effect.id for one in found.repaired} == {"temperature", "camber-stiffness"}
    assert found.tyre["PKY6"] == pytest.approx(right["PKY6"], rel=0.1)


def test_zeros_of_the_rig_are_no_gap_beside_what_the_build_left(built_toy, tmp_path):
    """They lie within their declaration: nothing is missing, and the misfit is that of readings without them."""
    zeros = {"Fy_N": 8.0, "alpha_deg": 0.1, "gamma_deg": 0.4}
    found = mffit.diagnose(toy(tmp_path, 2, zeros=zeros), built_toy)
    assert found.answer is Answer.NOTHING
    assert found.gap_before.rms("Fy") > 30.0
    assert found.gap_after.rms("Fy") < 16.0
    for name, column in {"F0_N": "Fy_N", "alpha_0_deg": "alpha_deg", "gamma_0_deg": "gamma_deg"}.items():
        value, u = found.coefficients[name]
        true = zeros[column] if name == "F0_N" else -zeros[column]
        assert abs(value - true) < 2.0 * u


def test_zeros_of_a_belt_are_no_gap_beside_what_the_build_left(built_brush, tmp_path):
    """The asymmetries of the tyre take them up there; the file misses its own readings by 11 N."""
    project = brush.written(Brush(), tmp_path, 81)
    for path in tmp_path.glob("*.csv"):
        table = pd.read_csv(path)
        shifted = {
            name: table[name] + zero for name, zero in (("Fy_N", 8.0), ("alpha_deg", 0.1), ("gamma_deg", 0.4))
        }
        table.assign(**shifted).to_csv(path, index=False)
    found = mffit.diagnose(project, built_brush)
    assert found.answer is Answer.NOTHING
    assert found.gap_before.rms("Fy") > 40.0
    assert found.gap_after.rms("Fy") < 13.0


def test_a_change_of_the_tyre_is_repaired_beside_what_its_build_left(built_brush, tmp_path):
    changed = Brush(reduction=0.3)
    found = mffit.diagnose(brush.written(changed, tmp_path, 82), built_brush)
    assert "camber-stiffness" in [one.effect.id for one in found.repaired]
    assert found.answer is Answer.FOUND
    assert found.trusted
    gamma, Fz = np.radians(8.0), 1700.0
    truth = float(changed.forces([0.0], [gamma], [Fz])[0][0])
    given, corrected = (float(tyre(Fz, 0.0, gamma).Fy) for tyre in (tir.read(built_brush), found.tyre))
    assert abs(corrected - truth) < 0.2 * abs(given - truth)


def test_the_speed_of_the_runs_is_suspected_beside_a_moment_that_nothing_describes(built_brush, tmp_path):
    """The force falls with the speed by its very term; the moment gains a part that bends with the sideslip there."""
    project = brush.written(Brush(), tmp_path, 84)
    for k, path in enumerate(sorted(tmp_path.glob("*.csv"))):
        table = pd.read_csv(path)
        if k % 2:
            bend = np.cos(4.0 * np.pi * table["alpha_deg"] / (np.ptp(table["alpha_deg"]) + 1e-9))
            table = table.assign(
                V_mps=table["V_mps"] + 14.0, Fy_N=0.94 * table["Fy_N"], Mz_Nm=table["Mz_Nm"] + 4.0 * bend
            )
        table.to_csv(path, index=False)
    found = mffit.diagnose(project, built_brush)
    assert found.unexplained
    assert "speed" in [one.effect.id for one in found.effects]
    assert "speed" not in {one.effect.id for one in found.limits}
    assert "speed" in found.headline


def with_gain(project: Path, gain: float, load: float | None = None) -> Path:
    """The project with the side force of the runs at a load, or of all, multiplied."""
    for path in project.parent.glob("*.csv"):
        table = pd.read_csv(path)
        wrong = (table["Fz_N"].round(-2) == load) | (load is None)
        table.assign(Fy_N=table["Fy_N"] * np.where(wrong, gain, 1.0)).to_csv(path, index=False)
    return project


@pytest.mark.parametrize(("load", "gain"), [(1000.0, 1.04), (2600.0, 1.04), (2600.0, 1.02)])
def test_one_load_that_reads_wrong_is_said(built_brush, tmp_path, load, gain):
    """Coefficients take most of it up within their uncertainty, which does not make it nothing."""
    found = mffit.diagnose(with_gain(brush.written(Brush(), tmp_path, 85), gain, load), built_brush)
    assert found.answer is Answer.UNDECIDED
    (odd,) = [note for note in found.notes if isinstance(note, OddLevel)]
    assert odd.share == pytest.approx(
        gain - 1.0, abs=0.04 if load < 1700.0 else 0.005
    )  # 3 % are the formula's
    assert abs(odd.others) < 0.005
    assert found.unexplained_where[0].region == {"Fz_N": (load, load)}
    assert found.headline.startswith(f"The side force of the runs at a load of {load:.0f} N is ")


def test_a_gain_of_all_runs_is_named_beside_what_the_build_left(built_brush, tmp_path):
    found = mffit.diagnose(with_gain(brush.written(Brush(), tmp_path, 85), 1.04), built_brush)
    assert [one.effect.id for one in found.repaired] == ["loadcell-gain"]
    value, u = found.effects[0].parameters["gain"]
    assert abs(value - 1.04) < 2.0 * u
    assert found.gap_after.rms("Fy") < 0.3 * found.gap_examined.rms("Fy")


def test_where_a_switch_cures_no_coefficient_moves(built_toy, tmp_path):
    """The simulation lacks turn slip; what the formula misses of these readings too is no reason to fit the file anew."""
    found = mffit.diagnose(toy(tmp_path, 2, turn_slip=False), built_toy)
    assert [one.effect.id for one in found.repaired] == ["turn-slip"]
    given = tir.read(built_toy)
    changed = {name for name in given.values if found.tyre[name] != given[name]}
    assert changed <= {"USE_MODE"}
    assert not found.unexplained


def test_a_tyre_with_less_grip_is_another_than_that_of_the_build(built_brush, tmp_path):
    found = mffit.diagnose(brush.written(Brush(mu=1.0), tmp_path, 83), built_brush)
    assert found.unexplained
    assert not found.repaired


def test_the_miss_of_the_formula_alone_is_no_effect(fitted_brush, tmp_path):
    assert_named(mffit.diagnose(brush.written(Brush(), tmp_path, 81), fitted_brush))


def inexact(project: Path, u: float = 0.03) -> Path:
    """The project with the relative uncertainty of the model's coefficients declared."""
    text = project.read_text(encoding="utf-8")
    project.write_text(f"{text}\n[model]\nu_coefficients = {u}\n", encoding="utf-8")
    return project


def assert_repaired(found: Diagnosis, right: Tyre) -> None:
    """Camber stiffness alone, by its number, in a file that is to be trusted."""
    assert [one.effect.id for one in found.repaired] == ["camber-stiffness"]
    assert found.answer is Answer.FOUND
    assert found.trusted
    value, u = found.effects[0].parameters["PKY6"]
    assert abs(value - right["PKY6"]) < min(3.0 * u, 0.1 * abs(right["PKY6"]))
    assert found.tyre["PKY6"] == value
    assert [note for note in found.notes if isinstance(note, LeftByFormula)]


def test_the_edit_of_a_file_is_found_beside_what_its_build_left(built_brush, fitted_brush, tmp_path):
    """The result.json next to it has other values; the tyre misses the formula all the same."""
    shutil.copytree(built_brush.parent, edited := tmp_path / "out")
    softer(fitted_brush).write(edited / "brush.tir")
    found = mffit.diagnose(brush.written(Brush(), tmp_path, 81), edited / "brush.tir")
    assert_repaired(found, fitted_brush)
    assert [note for note in found.notes if isinstance(note, WithoutModelError)]


def test_the_result_of_another_build_says_nothing_of_a_file(built_brush, fitted_brush, tmp_path):
    shutil.copytree(built_brush.parent, edited := tmp_path / "out")
    other = replace(softer(fitted_brush), provenance={"input points.csv": "0" * 16})
    other.write(edited / "brush.tir")
    found = mffit.diagnose(brush.written(Brush(), tmp_path, 81), edited / "brush.tir")
    assert found.unexplained
    assert not [note for note in found.notes if isinstance(note, WithoutModelError)]


@pytest.mark.parametrize("seed", [51, 81])
def test_an_effect_is_found_in_a_file_that_is_declared_inexact(fitted_brush, tmp_path, seed):
    """What the formula misses, 11 N, is less than what such coefficients move."""
    found = mffit.diagnose(inexact(brush.written(Brush(), tmp_path, seed)), softer(fitted_brush))
    assert_repaired(found, fitted_brush)


def test_an_unknown_cause_says_the_inexactness_that_would_explain_it(fitted_brush, tmp_path):
    """As stated, it is enough: the edit is found and trusted."""
    project, edited = brush.written(Brush(), tmp_path, 81), softer(fitted_brush)
    found = mffit.diagnose(project, edited)
    (note,) = [note for note in found.notes if isinstance(note, CountsAsExact)]
    assert note.cure in found.reasons[0]
    assert_repaired(mffit.diagnose(inexact(project, note.inexactness), edited), fitted_brush)


def test_the_miss_of_the_formula_is_not_missing_in_a_file_that_is_declared_inexact(fitted_brush, tmp_path):
    found = mffit.diagnose(inexact(brush.written(Brush(), tmp_path, 81)), fitted_brush)
    assert not found.effects
    assert not found.unexplained
    assert found.trusted


def test_beside_the_miss_of_the_formula_the_points_of_its_own_fit_name_no_effect(built_brush):
    found = mffit.diagnose(built_brush.parent.parent / "tyre.toml", built_brush)
    assert found.unexplained
    assert all(one.confidence < 0.5 for one in found.effects)
    assert not found.coefficients
    assert found.trusted
