"""One broken file among sound ones is refused by its name."""

from __future__ import annotations

import numpy as np
import pytest
from disc_project import disc_project

import mffit
from mffit.errors import InputError
from mffit.points import make_points
from mffit.suspicion.all_files import reversed_file
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


def test_of_a_reversed_file_every_cause_that_explains_its_slopes_is_named_and_no_other(tmp_path):
    """A force reversed leaves the moment, as no reversed angle does, and it turns on a disc, as no wheel that rolls backwards."""
    file = next(name for name in disc_project(tmp_path).tables if "slip" in name)
    said = {}
    for column in ("Fy_N", "alpha_deg"):
        with pytest.raises(InputError) as error:
            mffit.spin(broken(tmp_path / column, file, **{column: -1.0}).write())
        said[column] = str(error.value)
    assert "its side force reversed: correct its sign, or map Fy_N with scale = -1" in said["Fy_N"]
    assert not any(words in said["Fy_N"] for words in ("alpha_deg with scale", "direction of rolling"))
    assert "its sideslip reversed: correct its sign, or map alpha_deg with scale = -1" in said["alpha_deg"]
    assert "Fy_N with scale" not in said["alpha_deg"]


@pytest.mark.parametrize(("camber_deg", "backward_too"), [(0.0, True), (4.0, False)])
def test_a_lean_tells_a_reversed_force_from_a_wheel_that_rolls_backwards(camber_deg, backward_too):
    """Camber pushes a wheel to the side to which it leans, either way it rolls; upright, both readings are alike."""
    alpha = np.radians(np.tile(np.linspace(-3.0, 3.0, 13), 24))
    gamma = np.radians(np.repeat(np.tile([-camber_deg, 0.0, camber_deg], 8), 13))
    file = np.repeat([0, 1], 156)
    Fy = np.where(file == 1, 1.0, -1.0) * 1500.0 * (12.0 * alpha + gamma)
    Fy += np.random.default_rng(4).normal(0.0, 2.0, len(Fy))
    points = make_points(
        alpha,
        gamma,
        1500.0,
        p=2e5,
        V=10.0,
        phi_t=0.0,
        Fy=Fy,
        Mz=45.0 * alpha,
        file=file,
        files=["a.csv", "b.csv"],
    )
    (found,) = reversed_file.find(points, None)
    assert found["file"] == "b.csv"
    assert "its side force reversed" in found["cause"]
    assert ("direction of rolling" in found["cause"]) == backward_too
    assert found["column"] == ("alpha_deg" if backward_too else "Fy_N")


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
