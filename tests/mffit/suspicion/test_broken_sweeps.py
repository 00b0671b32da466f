"""One broken file among sound ones is refused by its name."""

from __future__ import annotations

import numpy as np
import pytest
from disc_project import disc_project

import mffit
from mffit.errors import InputError
from mffit.sweeps.units import converted


def broken(folder, file: str, **scales: float):
    """The toy project with some columns of one file scaled."""
    project = disc_project(folder)
    table = project.tables[file]
    for column, scale in scales.items():
        table[column] = table[column] * scale
    return project


def test_the_toy_is_sound(tmp_path):
    assert mffit.spin(disc_project(tmp_path).write()).epsilon_gamma is not None


@pytest.mark.parametrize(
    ("scales", "column", "words"),
    [
        ({"alpha_deg": -1.0}, "alpha_deg", "in this file alone"),
        ({"Fz_N": 1.0 / 9.80665}, "Fz_N", "kgf"),
        ({"Mz_Nm": 0.0}, "Mz_Nm", "dead"),
        ({"Mz_Nm": -1.0}, "Mz_Nm", "in this file alone"),
    ],
    ids=["reversed sideslip", "load in kgf", "dead moment", "reversed moment"],
)
def test_a_broken_sideslip_sweep_is_named(tmp_path, scales, column, words):
    file = next(name for name in disc_project(tmp_path).tables if "slip" in name)
    with pytest.raises(InputError) as error:
        mffit.spin(broken(tmp_path, file, **scales).write())
    assert file in str(error.value.file)
    assert error.value.column == column
    assert words in str(error.value)


def test_one_wild_reading_is_named_with_its_line(tmp_path):
    project = disc_project(tmp_path)
    file = next(name for name in project.tables if "slip" in name)
    project.tables[file].loc[3, "Fy_N"] = 99999.0
    with pytest.raises(InputError) as error:
        mffit.spin(project.write())
    assert (file in str(error.value.file), error.value.line, error.value.column) == (True, 5, "Fy_N")


def test_the_unit_that_the_remedy_names_is_known():
    assert converted(np.array([1.0]), "kgf", "N") == pytest.approx([9.80665])


def test_backward_zeros_that_are_not_declared_are_named_together(tmp_path):
    project = disc_project(tmp_path)
    for entry in project.config["sweep"]:
        entry.pop("direction", None)
    with pytest.raises(InputError) as error:
        mffit.spin(project.write())
    assert all(f"backward_{load}.csv" in str(error.value) for load in (1000, 1500))
    assert 'direction = "backward"' in str(error.value)
