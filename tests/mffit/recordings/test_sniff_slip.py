"""Slip of drive and brake recordings: which column, in which unit and sign, against which radius."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest
from flat_belt import DRIVE_UNITS, drive_recording, recording, write_mat73

from mffit import config as configuration
from mffit import pipeline, points
from mffit.errors import InputError
from mffit.recordings import sniff
from mffit.report import text

GIVEN = {"unloaded_radius": 0.228, "nominal_load": 1500.0}


@pytest.fixture(scope="module")
def table():
    return drive_recording()


def started(recording, folder):
    """The project of a recording: points, the entry for slip, and the text."""
    _, written = pipeline.init_from([recording], folder / "p", **GIVEN)
    content = written[0].read_text()
    return points.read(configuration.load(written[0])), tomllib.loads(content)["columns"]["kappa"], content


@pytest.fixture(scope="module")
def project(table, tmp_path_factory):
    folder = tmp_path_factory.mktemp("drive")
    return started(write_mat73(table, folder / "drive.mat"), folder)


def test_a_drive_recording_becomes_a_project_of_slip_sweeps(project):
    found, entry, content = project
    assert entry == {"column": "SL", "against": "free-rolling"}
    assert "SL is taken, not SR" in content
    assert "Fx = 0 lies at slip 0 within" in content
    assert {note.swept for note in found.stretches if note.points} == {"kappa"}


@pytest.mark.parametrize(
    ("change", "entry"),
    [
        (lambda table: table.assign(SL=100.0 * table["SL"]), {"unit": "%"}),
        (lambda table: table.assign(SL=table["SL"] * -1.0), {"scale": -1.0}),
        (lambda table: table.drop(columns="SL"), {"column": "SR", "against": "loaded-radius"}),
    ],
    ids=["per cent", "braking", "loaded radius"],
)
def test_the_same_slip_comes_from_another_unit_sign_or_radius(table, project, tmp_path, change, entry):
    """A CSV file, which states no unit."""
    other = change(table if "column" in entry else table.drop(columns="SR"))
    other.to_csv(tmp_path / "drive.csv", index=False)
    found, written, _ = started(tmp_path / "drive.csv", tmp_path)
    assert entry.items() <= written.items()
    assert np.max(np.abs(found.points.kappa - project[0].points.kappa)) < 0.0025


@pytest.mark.parametrize("heading", ["SL", "Long slip", "brake slip"])
def test_slip_in_per_cent_is_found_under_any_heading_and_a_unit_of_none(table, project, tmp_path, heading):
    other = table.drop(columns="SR").rename(columns={"SL": heading})
    other[heading] *= 100.0
    units = ["none" if name == heading else DRIVE_UNITS.get(name, "") for name in other]
    lines = [
        ",".join(other),
        ",".join(units),
        *(",".join(map(repr, row)) for row in other.to_numpy().tolist()),
    ]
    (tmp_path / "drive.csv").write_text("\n".join(lines) + "\n")
    found, written, _ = started(tmp_path / "drive.csv", tmp_path)
    assert {"column": heading, "unit": "%"}.items() <= written.items()
    assert np.max(np.abs(found.points.kappa - project[0].points.kappa)) < 0.0025


def test_a_force_of_the_other_sign_is_told_by_the_speeds_from_a_slip_of_the_other_sign(
    table, project, tmp_path
):
    other = table.drop(columns="SR").assign(FX=-table["FX"])
    file = write_mat73(other, tmp_path / "drive.mat")
    found, written, content = started(file, tmp_path)
    assert "scale" not in written
    assert tomllib.loads(content)["columns"]["Fx_N"] == {"column": "FX", "scale": -1}
    assert found.points.Fx == pytest.approx(project[0].points.Fx)
    without = sniff([write_mat73(other.drop(columns="N"), tmp_path / "other.mat")]).recordings[0].guesses
    assert (without["kappa"].scale, without["Fx_N"].scale) == (-1.0, 1.0)


def test_a_braking_force_under_an_unknown_heading_is_asked_for_and_then_taken_with_its_sign(table, tmp_path):
    """Without speeds: braking is negative slip and a positive force."""
    recorded = table.assign(FX=-table["FX"]).rename(columns={"FX": "Bremskraft"}).drop(columns=["SR", "N"])
    recorded.to_csv(tmp_path / "a.csv", index=False)
    with pytest.raises(InputError, match=r"Fx was not measured; name its column.*--column 'Fx_N=Bremskraft'"):
        pipeline.init_from([tmp_path / "a.csv"], tmp_path / "p", **GIVEN)
    named = sniff([tmp_path / "a.csv"], headings={"Fx_N": "Bremskraft"}).recordings[0].guesses
    assert (named["kappa"].scale, named["Fx_N"].scale) == (1.0, -1.0)


@pytest.mark.parametrize("without", [["SL", "SR"], ["SR"]], ids=["no slip", "dead slip"])
def test_a_force_of_the_other_sign_is_told_by_the_speeds_alone(table, tmp_path, without):
    both = [
        (table.assign(SL=0.0, FX=sign * table["FX"]).drop(columns=without), name, scale)
        for sign, name, scale in ((1.0, "right", 1.0), (-1.0, "other", -1.0))
    ]
    found = []
    for recorded, name, scale in both:
        _, written = pipeline.init_from(
            [write_mat73(recorded, tmp_path / f"{name}.mat")], tmp_path / name, **GIVEN
        )
        columns = tomllib.loads(written[0].read_text())["columns"]
        assert columns["Fx_N"] == ("FX" if scale > 0.0 else {"column": "FX", "scale": -1})
        found.append(points.read(configuration.load(written[0])).points)
    assert found[1].Fx == pytest.approx(found[0].Fx)
    assert np.ptp(found[1].kappa) > 0.2


def test_the_speed_of_a_wheel_that_is_braked_to_a_stop_is_kept(table, tmp_path):
    """Most of the time it turns more slowly than any wheel of its size that rolls."""
    slip = np.where(table["SL"] < 0.14, -0.9, table["SL"])
    locked = table.drop(columns="SR").assign(SL=slip, N=table["N"] * (1.0 + slip) / (1.0 + table["SL"]))
    (recording,) = sniff([write_mat73(locked, tmp_path / "a.mat")], unloaded_radius=0.228).recordings
    assert np.median(locked["N"]) < 0.2 * np.max(locked["N"])
    assert recording.guesses["omega_radps"].heading == "N"


def test_a_wheel_whose_speed_was_not_recorded_has_no_slip(table, tmp_path):
    noise = 0.0005 * np.sin(np.arange(len(table)))
    silent = table.assign(SL=-1.0 + noise).drop(columns="SR")
    found = sniff([write_mat73(silent, tmp_path / "a.mat")])
    (recording,) = found.recordings
    assert "kappa" not in recording.guesses
    assert "speed of the wheel was not recorded" in text.sniff_summary(found)


def test_the_column_whose_zero_is_nearest_to_free_rolling_is_taken_whatever_its_name(
    table, project, tmp_path
):
    swapped = table.rename(columns={"SL": "SR", "SR": "SL"})
    found, entry, _ = started(write_mat73(swapped, tmp_path / "drive.mat"), tmp_path)
    assert entry["column"] == "SR"
    assert found.points.kappa == pytest.approx(project[0].points.kappa)


def test_a_dead_slip_channel_is_not_taken_before_a_live_one(table, project, tmp_path):
    """SL is the first name of slip; here it was never connected."""
    dead = table.drop(columns="SR").assign(SR=table["SL"], SL=0.0)
    found, entry, content = started(write_mat73(dead, tmp_path / "drive.mat"), tmp_path)
    assert entry["column"] == "SR"
    assert "SL is left out: it is 0 throughout, and SR is not" in content
    assert found.points.kappa == pytest.approx(project[0].points.kappa)


@pytest.mark.parametrize("noise", [0.0, 2e-3])
def test_a_channel_that_stands_still_while_the_wheel_is_driven_is_no_slip(table, tmp_path, noise):
    """No tyre has a force of twice the load within 0.01 of slip. The column named by hand is refused, left to itself left out."""
    scatter = noise * np.random.default_rng(3).standard_normal(len(table))
    dead = table.drop(columns=["SL", "SR"]).assign(SL=scatter)
    file = write_mat73(dead, tmp_path / "drive.mat")
    found = sniff([file])
    assert "kappa" not in found.recordings[0].guesses
    (remark,) = [r for r in found.recordings[0].remarks if r.startswith("SL is left out")]
    assert "hardly moves while Fx changes by" in remark
    assert np.ptp(found.points.kappa) > 0.25  # from the speeds of wheel and road
    _, written = pipeline.init_from([file], tmp_path / "p", **GIVEN)
    by_hand = written[0].read_text().replace("[columns]", '[columns]\nkappa = "SL"', 1)
    written[0].write_text(by_hand)
    with pytest.raises(InputError, match="SL hardly moves while Fx changes by"):
        points.read(configuration.load(written[0]))


def test_driven_readings_without_any_slip_are_not_taken_for_free_rolling(table, tmp_path):
    blind = table.drop(columns=["SL", "SR", "N"], errors="ignore")
    with pytest.raises(InputError, match=r"driven or braked, but no slip is known.*--column 'kappa=HEADING'"):
        sniff([write_mat73(blind, tmp_path / "a.mat")])


def test_still_slip_of_a_freely_rolling_wheel_stays(tmp_path):
    found = sniff([write_mat73(recording(pressures=(83.0,)), tmp_path / "a.mat")])
    assert found.recordings[0].guesses["kappa"].heading == "SL"
