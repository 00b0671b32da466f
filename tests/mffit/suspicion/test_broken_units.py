"""Mistakes that show in one file before any model is fitted."""

from __future__ import annotations

import numpy as np
import pytest
from disc_project import disc_project

import mffit
from mffit.errors import InputError


def refused(project) -> InputError:
    with pytest.raises(InputError) as error:
        mffit.spin(project.write())
    return error.value


def test_a_sweep_under_two_names_is_refused_with_both_names(tmp_path):
    project = disc_project(tmp_path)
    project.add("copy.csv", project.tables["camber_1000.csv"].sample(frac=1.0, random_state=1))
    error = refused(project)
    assert "copy.csv" in str(error.file)
    assert "camber_1000" in str(error)


def test_the_same_condition_measured_twice_is_not_taken_for_a_copy(tmp_path):
    project = disc_project(tmp_path)
    again = project.tables["camber_1000.csv"].copy()
    again["Fy_N"] += np.random.default_rng(3).normal(0.0, 5.0, len(again)).round(2)
    project.add("again.csv", again)
    assert mffit.spin(project.write()).epsilon_gamma is not None


def test_one_file_in_psi_is_named(tmp_path):
    project = disc_project(tmp_path)
    project.tables["camber_1000.csv"]["p_kPa"] /= 6.894757
    error = refused(project)
    assert ("camber_1000.csv" in str(error.file), error.column) == (True, "p_kPa")
    assert "psi" in str(error)


def test_one_load_far_above_its_sweep_is_named_with_its_line(tmp_path):
    project = disc_project(tmp_path)
    project.tables["sideslip_1500.csv"].loc[4, "Fz_N"] = 99999.0
    error = refused(project)
    assert ("sideslip_1500.csv" in str(error.file), error.line, error.column) == (True, 6, "Fz_N")


@pytest.mark.parametrize(("column", "stuck"), [("Mz_Nm", 3.7), ("Fy_N", -812.5)])
def test_a_channel_that_never_moves_is_dead_at_any_reading(tmp_path, column, stuck):
    project = disc_project(tmp_path)
    project.tables["sideslip_1000.csv"][column] = stuck
    error = refused(project)
    assert ("sideslip_1000.csv" in str(error.file), error.column) == (True, column)
    assert "dead" in str(error)


def test_a_refusal_names_the_declared_heading_and_unit(tmp_path):
    project = disc_project(tmp_path)
    table = project.tables["sideslip_1000.csv"]
    table["FY"] = table.pop("Fy_N") / 1000.0
    (sweep,) = (entry for entry in project.config["sweep"] if entry["file"] == "sideslip_1000.csv")
    sweep["columns"] = {"Fy_N": {"column": "FY", "unit": "lbf"}}
    error = refused(project)
    assert error.column == "FY"
    assert 'Fy_N = { column = "FY", unit = "kN" }' in str(error)
    assert "FY is declared as lbf" in str(error)
    assert 'column = "Fy_N"' not in str(error)
