"""Differences of two files, of a file and data, and of two builds, with their uncertainties."""

from __future__ import annotations

import json
import math
import re
import shutil
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from small_rigs import SAMPLE, built, disc, simulated, truth

import mffit
import tir
from mffit import as_json, fleet, pipeline
from mffit.cli import main
from mffit.comparison import ComparedSubject, Difference, between, wording
from mffit.comparison.characteristics import characteristics
from mffit.comparison.of_rig import explained_by_rig
from mffit.comparison.record import ranked
from mffit.constants import TERMINAL_LINES
from mffit.errors import InputError
from mffit.fleet import Specimen
from mffit.numbers import Numbers
from mffit.pipeline.build_output import write_build
from mffit.quantities import CHARACTERISTICS, DIRECT
from mffit.report import compare
from mffit.rig_errors import words_of
from mffit.rounding import AtLeast, stated
from mffit.tested import words_on_tested
from tests.browser import assert_readable


@pytest.fixture(scope="module")
def stiffer():
    return truth().replace(PKY1=1.1 * truth()["PKY1"], PDY1=0.95 * truth()["PDY1"])


def by_key(found, load=1400.0):
    return {row.key: row for row in found.numbers if row.load == pytest.approx(load)}


def values_of(*given, **settings):
    return {key: number.value for key, number in characteristics(*given, **settings).items()}


def test_numbers_are_those_of_the_equations():
    """Slopes at zero as in the equations; turn-slip stiffness from eps_gamma by (17) with R0 for r_e."""
    tyre = truth().replace(PHY1=0.0, PHY2=0.0, PVY1=0.0, PVY2=0.0)
    found = values_of(tyre, 1400.0, turn_slip=True)
    state = tyre.state(1400.0)
    assert found["C_alpha_N_per_rad"] == pytest.approx(float(state.K_ya), rel=2e-3)
    assert found["epsilon_gamma"] == pytest.approx(tyre["PECP1"])
    assert values_of(tyre.replace(PECP1=0.0), 1400.0, turn_slip=True)["epsilon_gamma"] == 0.0
    implied = abs(float(state.K_yg0)) * tyre["UNLOADED_RADIUS"] / (1.0 - tyre["PECP1"])
    assert found["C_phit_Nm"] == pytest.approx(implied, rel=2e-3)
    assert found["r_e_m"] == pytest.approx(float(state.Re))
    assert found["K_xk_N"] == pytest.approx(float(state.K_xk), rel=2e-3)
    assert found["mu_x"] == pytest.approx(
        float(state.mu_x), rel=5e-3
    )  # the shift S_Vx makes the two ends differ
    assert "C_phit_Nm" not in values_of(tyre, 1400.0, turn_slip=False)


def test_the_peak_of_a_file_of_braking_is_that_of_braking():
    """A file that was tested braked only: at the driven end of its range, zero, there is no force."""
    tyre = truth().replace(KPUMIN=-0.2, KPUMAX=0.0)
    peak = max(abs(float(tyre(1400.0, kappa=-x).Fx)) for x in np.linspace(0.0, 0.2, 401))
    assert values_of(tyre, 1400.0, turn_slip=False)["mu_x"] == pytest.approx(peak / 1400.0, rel=1e-3)


def known_to(names, covariance):
    return Numbers.of(names, np.zeros(len(names)), covariance)


def reaching(tyre, degrees):
    """The file of a build whose sweeps reached a sideslip."""
    return tyre.annotate(status={"ALPMAX": f"estimate, {words_on_tested(math.radians(degrees), 'rad')}"})


@pytest.mark.parametrize("degrees", [3.0, 6.0, 9.0, 14.0])
def test_a_force_that_still_rises_where_the_readings_end_is_no_peak(degrees):
    """The front tyre's side force peaks at 12.0 deg at this load, its moment at 3.7 deg."""
    tyre = truth()
    found = characteristics(reaching(tyre, degrees), 1400.0, turn_slip=False)
    for key, channel, scale, at_peak in (("mu_y", "Fy", 1400.0, 12.0), ("Mz_peak_Nm", "Mz", 1.0, 3.7)):
        slip = np.radians(np.linspace(0.0, degrees, 3001))
        force = np.abs(getattr(tyre(1400.0, alpha=slip, turn_slip=False), channel)) / scale
        assert found[key].value == pytest.approx(force.max(), rel=1e-3)
        assert isinstance(found[key], AtLeast) == (degrees < at_peak), (key, degrees)
    assert stated(found["mu_y"]).startswith("at least ") == (degrees < 12.0)


def test_a_fall_within_its_uncertainty_shows_no_peak():
    """At 14 deg the side force has fallen by 0.3 %: what a curvature known to 0.05 shows, and one known to 1 does not."""
    for u, no_peak in ((0.05, False), (1.0, True)):
        known = known_to(("PEY1",), np.array([[u**2]]))
        found = characteristics(reaching(truth(), 14.0), 1400.0, turn_slip=False, known=known)
        assert isinstance(found["mu_y"], AtLeast) is no_peak


def test_a_comparison_says_where_the_readings_of_both_end():
    sides = [ComparedSubject(name, reaching(truth(), end), False) for name, end in (("a", 5.0), ("b", 14.0))]
    found = between(*sides)
    row = by_key(found)["mu_y"]
    assert row.at_least_first
    assert row.at_least_second
    assert row.change == 0.0
    assert wording.sides(row)[0] == f"at least {row.first:.4g}"
    assert (
        found.notes[-1] == '"At least": the curve does not fall up to the end of the slip compared, 5.0 deg.'
    )
    content = as_json.document(found)["numbers"]
    assert {one["key"] for one in content if one["at_least_first"]} == {"mu_y"}


def test_what_a_side_did_not_measure_has_no_significance():
    """A radius and an arm of Mx by rule of thumb, against a build that measured both; what both measured keeps its place."""
    names = ("DREFF", "QSX3", "PKY1")
    known = known_to(names, np.diag([0.01, 1e-4, 0.1]) ** 2)
    guesses = dict.fromkeys(("BREFF", "DREFF", "FREFF", "QSX3"), "estimate, not measured")
    measured = ComparedSubject("measured", truth(), False, known)
    other = truth().replace(DREFF=0.5, QSX3=0.2, PKY1=-25.0)
    guessed = ComparedSubject("guessed", other.annotate(status=guesses), False)
    for one, two, side in ((measured, guessed, "second"), (guessed, measured, "first")):
        found = between(one, two)
        rows = {**by_key(found), **{row.key: row for row in found.coefficients}}
        for key in ("r_e_m", "QSX3"):
            assert rows[key].change
            assert rows[key].z is None
            assert rows[key].u is None
            assert getattr(rows[key], f"estimated_{side}")
        assert {row.key for row in found.significant} >= {"PKY1", "C_alpha_N_per_rad"}
        (note,) = (note for note in found.notes if note.startswith("guessed did not measure"))
        assert "effective radius" in note
        assert "QSX3" in note
    both = between(measured, ComparedSubject("exact", other, False))
    assert {"r_e_m", "QSX3"} <= {row.key for row in both.significant}


def test_peaks_of_a_file_have_another_name_than_those_of_a_road():
    """Reason and side are stated where a build, which has a road, is on either side; two plain files have none."""
    one, other = (ComparedSubject(name, reaching(truth(), 14.0), False) for name in "ab")
    found = between(one, other)
    of_file = {key: wording.quantity(found, row).word for key, row in by_key(found).items()}
    assert of_file["mu_y"] == f"{DIRECT['mu_y'].word} of the file"
    assert of_file["trail_m"] == CHARACTERISTICS["trail_m"].word
    of_build = replace(other, build=moved("b", "may", {}))
    for sides, said in (((one, other), 0), ((one, of_build), 1), ((of_build, one), 1)):
        notes = [note for note in between(*sides).notes if "positive sideslip" in note]
        assert len(notes) == said
        assert all(note.startswith("mu_y and M_zmax are those of each file") for note in notes)
    short = [replace(side, tyre=reaching(truth(), 0.1)) for side in (one, of_build)]
    assert not any("positive sideslip" in note for note in between(*short).notes)


def test_without_sideslip_there_is_no_largest_side_force():
    found = characteristics(reaching(truth(), 0.1), 1400.0, turn_slip=False)
    assert "mu_y" not in found
    assert "Mz_peak_Nm" not in found
    assert "C_alpha_N_per_rad" in found


def test_numbers_hold_at_the_pressure_of_the_file():
    tyre = truth().replace(PHY1=0.0, PHY2=0.0, PVY1=0.0, PVY2=0.0, PPY1=0.5, PPY2=0.9)
    nominal, soft = (
        values_of(tyre.replace(INFLPRES=p), 1400.0, turn_slip=False) for p in (tyre["NOMPRES"], 200e3)
    )
    assert soft["C_alpha_N_per_rad"] == pytest.approx(float(tyre.state(1400.0, p=200e3).K_ya), rel=2e-3)
    assert abs(soft["C_alpha_N_per_rad"] / nominal["C_alpha_N_per_rad"] - 1.0) > 0.01


def test_a_number_that_depends_on_no_uncertain_coefficient_has_no_uncertainty():
    tiny = known_to(("PKY1", "PDX1", "LOADED"), np.diag([1e-6, 1e-26, 1.0]))
    found = characteristics(truth(), 1400.0, turn_slip=True, known=tiny)
    assert found["epsilon_gamma"].u == found["r_e_m"].u == 0.0
    assert found["C_alpha_N_per_rad"].u == pytest.approx(
        1e-3 * abs(found["C_alpha_N_per_rad"].value / truth()["PKY1"]), rel=0.01
    )


def test_uncertainties_of_numbers_are_those_of_small_changes():
    """By differences, of every number that a few coefficients move."""
    tyre, u = truth(), {"PKY1": 0.3, "PDY1": 0.02, "PDX1": 0.03, "QDZ1": 0.002, "PECP1": 0.05}
    for name, size in u.items():
        found = characteristics(tyre, 1200.0, turn_slip=True, known=known_to((name,), np.array([[size**2]])))
        low, high = (
            characteristics(tyre.replace(**{name: tyre[name] + side * 0.01 * size}), 1200.0, turn_slip=True)
            for side in (-1.0, 1.0)
        )
        for key, number in found.items():
            wanted = abs(high[key].value - low[key].value) / 0.02
            assert number.u == pytest.approx(wanted, rel=0.02, abs=1e-6 * abs(number.value)), (name, key)


def test_the_model_error_counts_for_the_numbers_of_its_channel():
    """A miss of the side force that is proportional to sideslip adds its slope to the cornering stiffness's uncertainty."""
    known = known_to(("PKY1", "QDZ1"), np.diag([9.0, 0.01]) ** 2)
    missed = SimpleNamespace(
        channels={"Fy": None},
        missed=lambda _, points: 4000.0 * points.alpha,
        u_between=lambda tyre, ends, channel: 1e5 * float(np.ptp(np.radians(ends.alpha_deg))),
    )
    alone, beside = (
        characteristics(truth(), 1400.0, turn_slip=False, known=known, predictor=by) for by in (None, missed)
    )
    assert alone["C_alpha_N_per_rad"].u < 1e5
    u = math.hypot(1e5, 4000.0)  # the slope at zero is known no better than readings show it
    assert beside["C_alpha_N_per_rad"].u == pytest.approx(u, rel=1e-6)
    assert beside["C_alpha_N_per_rad"].value == alone["C_alpha_N_per_rad"].value
    assert alone["Mz_peak_Nm"] == beside["Mz_peak_Nm"]


def test_a_changed_coefficient_shows_where_it_acts(stiffer):
    found = between(ComparedSubject("a", truth(), True), ComparedSubject("b", stiffer, True))
    rows = by_key(found)
    assert rows["C_alpha_N_per_rad"].second == pytest.approx(1.1 * rows["C_alpha_N_per_rad"].first, rel=0.01)
    assert rows["mu_y"].change < 0.0
    assert rows["epsilon_gamma"].change == 0.0
    assert {row.key for row in found.coefficients} == {"PKY1", "PDY1"}
    (worst, *_) = sorted((g for g in found.curves if g.channel == "Fy"), key=lambda g: -g.rms)
    assert worst.over == "alpha"


@pytest.mark.parametrize(
    ("second", "words"),
    [(None, "is unknown"), (known_to(("PKY1",), np.eye(1)), "if one rig measured both")],
)
def test_a_note_says_what_is_known_of_the_uncertainty(second, words):
    known = ComparedSubject("a.tir", truth(), False, known_to(("PKY1",), np.eye(1)))
    note, *_ = between(known, ComparedSubject("b.tir", truth(), False, second)).notes
    assert words in note


def test_equal_files_do_not_differ():
    found = between(ComparedSubject("a", truth(), True), ComparedSubject("b", truth(), True))
    assert not found.coefficients
    assert all(row.change == 0.0 for row in found.numbers)
    assert wording.headline(found) == "All numbers of a and b are equal. The curves do not differ."


def test_files_that_give_other_forces_are_not_called_equal():
    """Equal coefficients at two inflation pressures: a call without a pressure gives other forces, and the comparison says so."""
    tyre = truth().replace(PPY1=0.4)
    other = tyre.replace(INFLPRES=1.2 * tyre["INFLPRES"])
    found = between(ComparedSubject("a", tyre, False), ComparedSubject("b", other, False))
    (gap,) = (g for g in found.curves if (g.channel, g.over, g.load) == ("Fy", "alpha", found.curves[0].load))
    asked = [t(gap.load, gap.x, turn_slip=False).Fy for t in (tyre, other)]
    np.testing.assert_allclose(gap.first, asked[0], rtol=1e-9)
    np.testing.assert_allclose(gap.second, asked[1], rtol=1e-9)
    assert gap.rms > 0.01 * np.max(np.abs(gap.first))
    assert "own inflation pressure" in wording.headline(found)
    assert "do not differ" not in wording.headline(found)


def test_uncertainties_propagate_to_the_numbers():
    """One uncertain number, PKY1: the cornering stiffness is proportional to it."""
    u = 0.02 * abs(truth()["PKY1"])
    known = ComparedSubject("a", truth(), True, known_to(("PKY1",), np.array([[u**2]])))
    row = by_key(between(known, ComparedSubject("b", truth(), True)))["C_alpha_N_per_rad"]
    assert row.u_first == pytest.approx(0.02 * abs(row.first), rel=0.02)
    assert row.u_second is None
    assert row.u == row.u_first


def test_significant_differences_come_first():
    rows = [
        Difference("mu_y", 1.0, 1.0, 1.5),
        Difference("trail_m", 1.0, 1.0, 1.1, 0.01, None),
        Difference("r_e_m", 1.0, 0.30, 0.33, 0.003, 0.004),
    ]
    first, second, third = ranked(rows)
    assert (first.key, second.key, third.key) == ("trail_m", "r_e_m", "mu_y")
    assert second.z == pytest.approx(6.0)
    assert third.z is None


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A project of one load and its build."""
    content = disc()
    content["sweep"] = [s for s in content["sweep"] if s["load_N"] == 1400]
    content["rolling_radius"] = [{"load_N": 1400}]
    place = tmp_path_factory.mktemp("project")
    write_build(built(content, place), place / "out", with_report=False)
    return place


def test_the_cornering_stiffness_of_a_disc_has_the_uncertainty_that_its_build_states(folder, tmp_path):
    """It counts what the coefficients do not know, at other loads in proportion to the stiffness at least; in a fleet, too."""
    out, doubtful = folder / "out", tmp_path / "doubtful"
    shutil.copytree(out, doubtful)
    result = json.loads((out / "result.json").read_text())
    size, u = (abs(result["spin"][f"{of}C_alpha_straight_N_per_rad"]) for of in ("", "u_"))
    result["spin"]["u_C_alpha_straight_N_per_rad"] = 2.0 * u
    (doubtful / "result.json").write_text(json.dumps(result))
    rows = {row.load: row for row in mffit.compare(out, doubtful).numbers if row.key == "C_alpha_N_per_rad"}
    assert (rows[1400.0].u_first, rows[1400.0].u_second) == pytest.approx((u, 2.0 * u), rel=1e-3)
    assert all(row.u_second > 1.99 * u * abs(row.second) / size for row in rows.values())
    sound, other = (row.numbers["C_alpha_N_per_rad"] for row in pipeline.fleet([out, doubtful]).rows)
    assert (sound.u, other.u) == pytest.approx((u, 2.0 * u), rel=1e-2)


def test_a_build_is_compared_with_its_uncertainties(folder, stiffer, tmp_path):
    stiffer.write(tmp_path / "stiffer.tir")
    found = mffit.compare(folder / "out", tmp_path / "stiffer.tir", turn_slip=True, out=tmp_path / "page")
    row = by_key(found)["C_alpha_N_per_rad"]
    assert row.u_first
    assert abs(row.z) > 5.0
    written = json.loads((tmp_path / "page" / "compare.json").read_text())
    assert written["numbers"][0]["in_u"] == found.numbers[0].z
    page = (tmp_path / "page" / "compare.html").read_text()
    assert "cornering stiffness" in page
    _, curves = compare.differences(found).panels
    apart = [gap.rms / np.abs(gap.first).max() for gap in found.curves]
    assert curves.series[0].y is found.curves[int(np.argmax(apart))].first
    assert "curves_Fy" in {path.stem for path in (tmp_path / "page" / "plots").iterdir()}
    assert "in u</th>" in page
    assert "Shaded areas" in page


def test_a_reader_sees_every_picture_of_the_page(folder, stiffer, tmp_path):
    stiffer.write(tmp_path / "stiffer.tir")
    mffit.compare(folder / "out", tmp_path / "stiffer.tir", out=tmp_path)
    assert_readable(tmp_path / "compare.html")


def test_a_force_that_is_equal_on_both_sides_is_said_and_not_drawn(stiffer, tmp_path):
    truth().write(tmp_path / "a.tir")
    stiffer.write(tmp_path / "b.tir")
    found = mffit.compare(tmp_path / "a.tir", tmp_path / "b.tir", out=tmp_path / "page")
    assert {gap.channel for gap in found.curves if not gap.rms} == {"Fx"}
    assert not (tmp_path / "page" / "plots" / "curves_Fx.png").exists()
    page = (tmp_path / "page" / "compare.html").read_text()
    assert "Longitudinal force is equal on both sides" in page
    assert "in u</th>" not in page  # nor bands: no build states an uncertainty
    assert "Shaded areas" not in page


def test_two_builds_of_one_name_are_called_by_their_folders(folder):
    later = shutil.copytree(folder / "out", folder / "later")
    found = mffit.compare(folder / "out", later)
    assert (found.first, found.second) == ("out/small.tir", "later/small.tir")
    assert all(row.z == 0.0 for row in found.numbers if row.z is not None)


def test_a_file_is_compared_with_data(folder, stiffer, tmp_path):
    stiffer.write(tmp_path / "stiffer.tir")
    right, wrong = (
        mffit.compare(path, folder / "tyre.toml") for path in (SAMPLE / "true.tir", tmp_path / "stiffer.tir")
    )
    noise = {gap.sweep: gap.rms / gap.noise for gap in right.sweeps if gap.channel == "Fy"}
    assert max(noise.values()) < 2.0
    assert wrong.sweeps[0].rms > 5.0 * wrong.sweeps[0].noise
    row = by_key(wrong)["C_alpha_N_per_rad"]
    assert abs(by_key(right)["C_alpha_N_per_rad"].z) < 3.0 < abs(row.z)
    assert row.change > 0.0  # the data are less stiff, and C_alpha is negative
    readings = wrong.simulation.readings(wrong.points)
    apart = {c: wrong.points.channel(c) - read for c, read in readings.items()}
    Fy, Mz = (f"{np.sqrt(np.nanmean(gap**2)):.3g}" for gap in apart.values())
    assert f" by {Fy} N rms in Fy and {Mz} Nm rms in Mz. It is the tyre, or the rig is" in wording.headline(
        wrong
    )
    assert "differ significantly: measured cornering stiffness" in wording.headline(wrong)
    # The same sign by sweep.
    for gap in wrong.sweeps:
        rows = np.array([wrong.points.sweep_names[k] == gap.sweep for k in wrong.points.sweep])
        assert gap.bias == pytest.approx(np.nanmean(apart[gap.channel][rows]))


DECLARED = {"F0_N": 10.0, "gamma_0_deg": 0.5, "gain": 0.005}


@pytest.mark.parametrize(
    ("hidden", "said", "named"),
    [
        ({}, "That is noise", set()),
        ({"F0_N": 12.0, "gamma_0_deg": -0.6}, "It can be the rig", {"F0_N", "gamma_0_deg"}),
        ({"PKY1": 1.1 * truth()["PKY1"]}, "It is not the rig as declared", None),
        (
            {"gain": 1.1},
            "It is the tyre, or the rig is worse than declared (calibration of Fy 0.0",
            None,
        ),
    ],
)
def test_a_gap_is_said_to_be_of_the_rig_or_of_the_tyre(folder, hidden, said, named):
    """Readings made by the simulation with something hidden, and their own noise."""
    found = mffit.compare(SAMPLE / "true.tir", folder / "tyre.toml")
    rng = np.random.default_rng(5)
    read = found.simulation.with_numbers(hidden).readings(found.points)
    made = {name: x + rng.normal(size=len(x)) * found.points.u(name) for name, x in read.items()}
    explained = explained_by_rig(found.points.replace(**made), found.simulation, DECLARED)
    assert wording.rig_or_tyre(explained, fitted=False).startswith(said)
    assert len(wording.rig_or_tyre(explained, fitted=False)) < 250  # the other errors are in a remark
    of_fit = wording.rig_or_tyre(explained, fitted=True)
    remark = "".join(wording.notes_on_rig(explained))
    assert explained.is_noise or [n for n in explained.errors if words_of(n) not in remark] in (
        [],
        [*explained.errors][:1],
    )
    assert of_fit.startswith(
        said if explained.is_noise or explained.suffices else "The file was fitted to these points"
    )
    if named is not None:
        assert named <= set(explained.errors)
        for name in named:
            assert explained.errors[name].value == pytest.approx(
                hidden[name], abs=4.0 * explained.errors[name].u
            )


def test_a_build_is_fitted_to_its_own_points_and_to_no_others(folder, stiffer, tmp_path):
    """Neither the same forces in another file nor a reading that is new."""
    stiffer.write(tmp_path / "stiffer.tir")
    other = shutil.copytree(folder, tmp_path / "other")
    table = next(other.glob("sideslip*.csv*"))
    table.write_bytes(table.read_bytes() + b"\n")
    for file, project, fitted in (
        (folder / "out", folder, True),
        (folder / "out" / "small.tir", folder, True),
        (tmp_path / "stiffer.tir", folder, False),
        (folder / "out", other, False),
    ):
        assert mffit.compare(file, project / "tyre.toml").fitted is fitted


def test_chance_alone_makes_no_difference_significant():
    """Of a hundred differences drawn from their uncertainties a few pass 95 %, and none is called significant."""
    rng = np.random.default_rng(3)
    rows = [Difference("mu_y", 1.0, 1.0, 1.0 + 0.01 * x, 0.01) for x in rng.normal(size=100)]
    found = replace(
        between(ComparedSubject("a", truth(), True), ComparedSubject("b", truth(), True)), numbers=tuple(rows)
    )
    assert sum(abs(row.z) > 1.96 for row in rows) > 1
    assert found.significant == ()
    clear = replace(found, numbers=(*rows, Difference("r_e_m", 1.0, 0.3, 0.33, 0.003)))
    assert [row.key for row in clear.significant] == ["r_e_m"]


def test_a_coefficient_that_moves_no_number_is_named(folder, tmp_path):
    """QDZ8 acts with camber alone, and no number of the comparison is of a moment under camber."""
    tyre = tir.read(folder / "out" / "small.tir")
    u = json.loads((folder / "out" / "result.json").read_text())["fit"]["coefficients"]["QDZ8"]["stderr"]
    tyre.replace(QDZ8=tyre["QDZ8"] + 5.0 * u).write(tmp_path / "small.tir")
    said = wording.headline(mffit.compare(folder / "out", tmp_path / "small.tir"))
    assert re.match(r"\S+ and \S+ differ significantly in 1 of \d+ numbers and coefficients: QDZ8\. ", said)


def test_two_sets_of_data_are_refused(folder):
    with pytest.raises(InputError) as caught:
        mffit.compare(folder / "tyre.toml", folder / "other.toml")
    assert f"{folder / 'tyre.toml'} and {folder / 'other.toml'} are both measured data; build each" in str(
        caught.value
    )


@pytest.mark.parametrize(("first", "second"), [(15, 14), (5, 4), (14, 25)])
def test_files_without_provenance_are_for_turn_slip_if_their_use_modes_end_in_5_and_that_is_said_first(
    tmp_path, first, second
):
    for name, mode in (("a.tir", first), ("b.tir", second)):
        truth().replace(USE_MODE=mode, FNOMIN=1000.0 + 100.0 * mode).write(tmp_path / name)
    on, off = ("a.tir", "b.tir") if first % 10 == 5 else ("b.tir", "a.tir")
    found = mffit.compare(tmp_path / "a.tir", tmp_path / "b.tir")
    use = f"{on} is evaluated with turn slip on, {off} with turn slip off, each for its own use. "
    assert wording.headline(found).startswith(f"{use}Nominal conditions differ")
    alike = mffit.compare(tmp_path / "a.tir", tmp_path / "b.tir", turn_slip=True)
    assert alike.apart.startswith("Nominal conditions differ")


def test_a_folder_without_a_build_is_refused(tmp_path):
    with pytest.raises(InputError, match="not the folder of a build"):
        mffit.compare(tmp_path, SAMPLE / "true.tir")


def test_the_command_prints_the_differences(capsys):
    main(["compare", str(SAMPLE / "base.tir"), str(SAMPLE / "true.tir"), "--turn-slip", "on"])
    said = capsys.readouterr().out
    assert "The curves differ in Fy by up to" in " ".join(said.split())
    assert len(said.splitlines()) <= TERMINAL_LINES
    names = re.findall(r"^(\S.*?)  +\d+ N  ", said, re.MULTILINE)
    assert len(names) > 1
    assert len({*names}) == len(names)  # each at the worst of its loads
    assert "camber reduction factor" in said
    assert "written to" not in said


def moved(name, setup, moves):
    """A build of the rig "bench" with one set-up whose numbers its path radius and its load-cell zero move."""
    names = ("PKY1", *moves)
    u = {error: move.get(error, 1.0) for error, move in moves.items()}
    information = np.eye(len(names))
    information[0, 1:] = information[1:, 0] = [-move["PKY1"] / u[error] for error, move in moves.items()]
    told = Numbers(
        names, np.zeros(len(names)), information, np.zeros(len(names)), np.zeros(len(names)),
        np.array([math.inf, *u.values()]), frozenset(moves),
    )  # fmt: skip
    return Specimen(
        name=name, folder=Path(name), tyre=truth(), file="a.tir", on_disc=True, rig={"name": "bench"}, numbers=told,
        epsilon_gamma=None, epsilon_direct=None, misfit={}, warnings=(), setups=(setup,), budget={"load-cell offset": -0.03},
    )  # fmt: skip


@pytest.mark.parametrize("setups", [("may", "may"), ("may", "june")])
def test_what_one_rig_does_to_both_sides_cancels_in_the_difference(setups):
    """Against draws: a common path radius, the zero of a set-up in readings and in PECP1 as measured, errors of each side."""
    rng, own, of_zero, names = np.random.default_rng(3), 0.1, -0.03, ("PKY1", "PECP1")

    def drawn(common):
        one = rng.standard_normal((2, 400_000))
        return (one[0], one[0]) if common else (one[0], one[1])

    one_setup = setups[0] == setups[1]
    radius, zero, direct = drawn(True), drawn(one_setup), drawn(one_setup)
    rest, noise = drawn(False), drawn(False)
    sides, errors = [], []
    for k, (by_radius, by_zero, u, by_epsilon) in enumerate([(0.5, 0.2, 0.06, 0.3), (0.4, -0.1, 0.05, 0.2)]):
        epsilon = of_zero * direct[k] + math.sqrt(u**2 - of_zero**2) * rest[k]
        stiffness = by_radius * radius[k] + by_zero * zero[k] + by_epsilon / u * epsilon + own * noise[k]
        errors.append(np.array([stiffness, epsilon]))
        moves = {
            "path_radius_m": {"PKY1": by_radius},
            "F0_N": {"PKY1": by_zero},
            "PECP1": {"PECP1": u, "PKY1": by_epsilon},
        }
        tyre = truth().replace(PKY1=truth()["PKY1"] + k, PECP1=0.1 * k)
        known = known_to(names, np.cov(errors[k]))
        sides.append(ComparedSubject(f"{k}", tyre, True, known, moved(f"{k}", setups[k], moves)))
    found = between(*sides)
    rows = {row.key: row.u for row in found.coefficients}
    assert [rows[name] for name in names] == pytest.approx(np.std(errors[1] - errors[0], axis=1), rel=0.01)
    stiff, slip = by_key(found)["C_alpha_N_per_rad"], by_key(found)["epsilon_gamma"]
    assert slip.u == pytest.approx(rows["PECP1"])
    # C_alpha is in proportion to PKY1.
    scaled = [
        e[0] * row / side.tyre["PKY1"]
        for e, row, side in zip(errors, (stiff.first, stiff.second), sides, strict=True)
    ]
    assert stiff.u == pytest.approx(np.std(scaled[1] - scaled[0]), rel=0.02)
    other = replace(sides[1], build=replace(sides[1].build, rig={"name": "other"}))
    apart = by_key(between(sides[0], other))["epsilon_gamma"]
    assert apart.u == pytest.approx(math.hypot(0.06, 0.05), rel=0.01)


def test_a_declared_path_radius_moves_a_build_as_stated(tmp_path):
    """Built again with the radius one standard uncertainty larger."""
    builds = []
    for k, radius in enumerate((1.323, 1.3248)):
        content = disc()
        content["rig"] |= {"path_radius": 1.323, "u_path_radius": 0.0018}
        simulated(content, tmp_path / f"{k}", seed=7)
        path = tmp_path / f"{k}" / "tyre.toml"
        path.write_text(path.read_text().replace("path_radius = 1.323", f"path_radius = {radius}"))
        mffit.build(path, tmp_path / f"{k}" / "out", with_report=False)
        builds.append(fleet.read(tmp_path / f"{k}" / "out"))
    first, second = (build.numbers for build in builds)
    stated = dict(zip(first.names, first.moved_by()["path_radius_m"], strict=True))
    found = dict(zip(second.names, second.values, strict=True))
    result = json.loads((tmp_path / "0" / "out" / "result.json").read_text())["fit"]
    u = {name: row["stderr"] for table in ("coefficients", "rig") for name, row in result[table].items()}
    for name, before in zip(first.names, first.values, strict=True):
        assert found[name] - before == pytest.approx(stated[name], abs=0.1 * (u.get(name) or math.inf)), name


def test_what_a_build_says_of_its_own_file_needs_no_rig(folder):
    """A miss of 20 N over sideslip, and an axis 1.1 deg off where 0.3 deg are declared."""
    found = mffit.compare(SAMPLE / "true.tir", folder / "tyre.toml")
    rng = np.random.default_rng(5)
    read = found.simulation.with_numbers({"alpha_0_deg": 1.1}).readings(found.points)
    missed = 20.0 * np.sqrt(2.0) * np.sin(np.degrees(found.points.alpha))
    noisy = {name: x + rng.normal(size=len(x)) * found.points.u(name) for name, x in read.items()}
    points = found.points.replace(**{**noisy, "Fy": noisy["Fy"] + missed})
    known = explained_by_rig(points, found.simulation, {**DECLARED, "alpha_0_deg": 0.3}, {"Fy": 25.0})
    said = wording.rig_or_tyre(known, fitted=False)
    assert re.search(r"the rig is worse than declared \(sideslip axis misaligned 1\.\d+ ± \S+ deg", said)
    assert known.beyond[0] == "alpha_0_deg"
    straight = points.replace(Fy=found.simulation.readings(points).Fy + missed)
    without, within = (
        explained_by_rig(straight.replace(Mz=np.nan), found.simulation, DECLARED, known)
        for known in ({}, {"Fy": 25.0})
    )
    assert not without.is_noise
    assert "is noise and what the formula misses" in wording.rig_or_tyre(within, fitted=False)
