"""Keys that a file lacks: their defaults belong to the file's own tyre, whatever its size, load and pressure."""

from __future__ import annotations

import math

import pytest

import tir
from tir.checking import check

SMALL = """[MODEL]
FITTYP = 61
[DIMENSION]
UNLOADED_RADIUS = 0.2
[VERTICAL]
FNOMIN = 800
[LATERAL_COEFFICIENTS]
PCY1 = 1.5
PDY1 = 2.0
PKY1 = -30
PKY2 = 1.6
PKY4 = 2
PPY1 = 0.4
PPY3 = 0.2
"""


def read(tmp_path, more=""):
    path = tmp_path / "small.tir"
    path.write_text(SMALL + more, encoding="ascii")
    return tir.read(path)


def side_force(Fz, alpha):
    """The side force of SMALL at its nominal pressure, written out: D sin(C atan(K alpha / (C D))), with the default PEY1."""
    C, D, E = 1.5, 2.0 * Fz, -0.8
    K = -30.0 * 800.0 * math.sin(2.0 * math.atan(Fz / (1.6 * 800.0)))
    x = K / (C * D) * alpha
    return D * math.sin(C * math.atan(x - E * (x - math.atan(x))))


@pytest.mark.parametrize("stated", ["NOMPRES", "INFLPRES"])
def test_a_file_with_one_pressure_is_at_its_nominal_one(tmp_path, stated):
    """Read as 250 kPa beside 85 kPa, PPY1 and PPY3 would add tens of per cent."""
    tyre = read(tmp_path, f"[OPERATING_CONDITIONS]\n{stated} = 85000\n")
    assert tyre["NOMPRES"] == tyre["INFLPRES"] == 85e3
    assert tyre(800.0, 0.06).Fy == pytest.approx(side_force(800.0, 0.06), rel=1e-6)
    assert tir.Tyre.from_values({**tyre.values}) == tyre


@pytest.mark.parametrize(
    "changes",
    [{"NOMPRES": 1e5}, {"INFLPRES": 1.1e5}, {"FNOMIN": 900.0, "UNLOADED_RADIUS": 0.25}, {"ALPMAX": 0.2}],
)
def test_a_changed_tyre_is_that_of_its_file(tmp_path, changes):
    """What is written is read as it was: defaults follow the changed values in both."""
    tyre = read(tmp_path, "[OPERATING_CONDITIONS]\nNOMPRES = 85000\n").replace(**changes)
    tyre.write(tmp_path / "changed.tir")
    again = tir.read(tmp_path / "changed.tir")
    assert again == tyre
    assert again(900.0, 0.05, 0.02).Mz == tyre(900.0, 0.05, 0.02).Mz
    kept = read(tmp_path, "RIM_RADIUS = 0.15\n").replace(UNLOADED_RADIUS=0.4)
    assert kept["RIM_RADIUS"] == 0.15


def test_two_stated_pressures_are_kept(tmp_path):
    tyre = read(tmp_path, "[OPERATING_CONDITIONS]\nNOMPRES = 85000\nINFLPRES = 110000\n")
    assert (tyre["NOMPRES"], tyre["INFLPRES"]) == (85e3, 110e3)
    assert abs(tyre(800.0, 0.06).Fy) > 1.02 * abs(side_force(800.0, 0.06))


def test_a_small_tyre_gets_the_rim_and_the_deflection_of_a_small_tyre(tmp_path):
    """The table's tyre deflects by 20 mm of 300 under its load, and its rim has 2/3 of its radius: alike at any size."""
    small = read(tmp_path)
    for tyre in (
        small,
        small.replace(UNLOADED_RADIUS=0.5, FNOMIN=9e3),
        tir.Tyre.from_values({"UNLOADED_RADIUS": 0.5, "FNOMIN": 30e3}),
    ):
        R0 = tyre["UNLOADED_RADIUS"]
        assert tyre["RIM_RADIUS"] / R0 == pytest.approx(2.0 / 3.0)
        assert tyre["FNOMIN"] / tyre["VERTICAL_STIFFNESS"] / R0 == pytest.approx(0.02 / 0.3)
        assert tyre["FZMIN"] < 0.05 * tyre["FNOMIN"] < 2.0 * tyre["FNOMIN"] < tyre["FZMAX"]


def test_what_the_file_does_not_state_is_no_error(tmp_path):
    """Friction would turn negative at a camber that nobody claimed, and the nominal load of 30 N lies below a car's FZMIN."""
    more = "PDY3 = 2\nPDY2 = -0.2\n[SLIP_ANGLE_RANGE]\nALPMAX = 0.2\n"
    tyre = read(tmp_path, more.replace("PDY3 = 2", "PDY3 = -12"))
    assert tyre["ALPMIN"] == -0.2
    found = check(tyre) + check(tir.Tyre.from_values({"FNOMIN": 30.0, "UNLOADED_RADIUS": 0.1, "WIDTH": 0.03}))
    assert not [p.sentence for p in found if p.level == "error"]


def test_the_error_of_a_stated_range_remains(tmp_path):
    """1 - PDY3 gamma^2 falls below zero beyond 0.58 rad; 0.8 rad is stated."""
    found = check(read(tmp_path, "PDY3 = 3\n"))
    assert ("PDY1", "warning") in [(p.name, p.level) for p in found]
    found = check(read(tmp_path, "PDY3 = 3\n[INCLINATION_ANGLE_RANGE]\nCAMMIN = -0.8\nCAMMAX = 0.8\n"))
    assert ("PDY1", "error") in [(p.name, p.level) for p in found]


def test_what_moves_a_force_is_named_first(tmp_path):
    (sentence,) = [p.sentence for p in read(tmp_path).problems if "missing" in p.sentence]
    first = sentence.partition("taken: ")[2].split(", ")[:4]
    assert first[0] == "INFLPRES = 250000 Pa"
    assert all("=" in words for words in first)
    assert not any(name in sentence for name in ("TYRESIDE", "MASS", "LMUX"))
