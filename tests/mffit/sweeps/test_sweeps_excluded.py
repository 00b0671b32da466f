"""[fit] exclude leaves rows out as if they had been deleted from the file, without editing it."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

import mffit
from mffit import as_json, config, points
from mffit.errors import InputError
from mffit.pipeline.inputs import read_points


def excluding(project, *entries):
    """The configuration of a project with some lines of files left out."""
    project.config["fit"] = {
        "exclude": [{"file": file, "lines": lines, "why": "belt tracking"} for file, lines in entries]
    }
    return config.load(project.write())


def without(project, file, rows):
    """The configuration of the same project whose table lacks some rows."""
    project.config.pop("fit", None)
    project.tables[file] = project.tables[file].drop(index=rows)
    return config.load(project.write())


def test_excluded_readings_act_as_if_they_were_not_in_the_file(project):
    """Wild readings of a mirrored pair of sweeps: direct method, parts and points are those of the shorter file."""
    table = project.tables["sideslip_1500.csv"]
    table.loc[[2, 3], "Fy_N"] += 900.0
    settings = excluding(project, ("sideslip_1500.csv", "4-5"))
    found = spin(settings)
    left = read_points(settings)
    deleted = without(project, "sideslip_1500.csv", [2, 3])
    assert found == spin(deleted)
    shorter = read_points(deleted).points
    assert np.array_equal(left.points.Fy, shorter.Fy)
    assert left.excluded is not None
    assert left.excluded.Fy == pytest.approx(table["Fy_N"][[2, 3]].to_numpy())
    assert left.excluded.line.tolist() == [4, 5]
    (entry,) = [row for row in left.left_out if row.by == "hand"]
    assert (entry.file, entry.lines, entry.count, entry.why) == (
        "sideslip_1500.csv",
        "4-5",
        2,
        "belt tracking",
    )


def test_the_diagnosis_and_the_alignment_do_not_see_them_either(project):
    settings = excluding(project, ("sideslip_1500.csv", "4-5"))
    for continuous in (False, True):
        seen = read_points(settings, continuous=continuous).points
        file = seen.files.index("sideslip_1500.csv")
        assert not np.isin(seen.line[seen.file == file], [4, 5]).any()


def test_a_line_of_two_entries_is_listed_once(project):
    found = read_points(excluding(project, ("sideslip_1500.csv", "4-5"), ("sideslip_1500.csv", "5-6")))
    assert [row.lines for row in found.left_out if row.by == "hand"] == ["4-5", "6"]
    assert found.excluded.line.tolist() == [4, 5, 6]


def test_an_entry_for_every_line_leaves_out_what_one_entry_does(project):
    file = "sideslip_1500.csv"
    one = read_points(excluding(project, (file, "4-5, 7, 9")))
    each = read_points(excluding(project, *((file, line) for line in ("9", "4", "7", "5"))))
    assert [row.lines for row in each.left_out if row.by == "hand"] == ["9", "4", "7", "5"]
    for channel in ("line", "alpha", "Fz", "Fy", "Mz"):
        assert np.array_equal(getattr(each.excluded, channel), getattr(one.excluded, channel)), channel
        assert np.array_equal(getattr(each.points, channel), getattr(one.points, channel)), channel


def test_a_damaged_row_does_not_hide_other_excluded_ones(project):
    project.tables["camber_1500.csv"]["Fy_N"] = project.tables["camber_1500.csv"]["Fy_N"].astype(object)
    project.tables["camber_1500.csv"].loc[4, "Fy_N"] = "overload"
    found = read_points(excluding(project, ("camber_1500.csv", "3-4"), ("camber_1500.csv", "6")))
    assert found.excluded.line.tolist() == [3, 4]


def test_a_damaged_row_can_be_excluded(project):
    """The row would be refused otherwise: the files of a laboratory stay as the rig wrote them."""
    project.tables["camber_1500.csv"]["Fy_N"] = project.tables["camber_1500.csv"]["Fy_N"].astype(object)
    project.tables["camber_1500.csv"].loc[4, "Fy_N"] = "overload"
    with pytest.raises(InputError, match="overload"):
        points.read(config.load(project.write()))
    found = points.read(excluding(project, ("camber_1500.csv", "6")))
    assert [row.lines for row in found.left_out] == ["6"]


def spin(settings):
    """The numbers of the direct method, without the hashes of the files."""
    content = as_json.document(mffit.spin(settings))
    del content["made"]
    return content


def series(seed=5):
    """Plateaus of two seconds at 50 Hz over sideslip; the first samples of one of them are wild."""
    rng = np.random.default_rng(seed)
    alpha = np.repeat([-4.0, -2.0, 0.0, 2.0, 4.0], 400)
    time = np.arange(len(alpha)) / 50.0
    Fy = -300.0 * alpha - 330.0 + rng.normal(0.0, 4.0, len(alpha))
    return pd.DataFrame(
        {
            "time_s": time, "alpha_deg": alpha, "gamma_deg": 0.0, "Fz_N": 1500.0 + rng.normal(0.0, 2.0, len(alpha)),
            "Fy_N": Fy.round(3), "Mz_Nm": rng.normal(0.0, 0.3, len(alpha)).round(4), "p_kPa": 250.0, "V_mps": 6.0,
        }
    )  # fmt: skip


def test_samples_that_are_left_out_are_in_no_mean_and_divide_no_rest(project):
    table, usual = series(), {}
    for spoilt in (0.0, 200.0):  # within the plateau at 0 deg
        table.loc[900:1039, "Fy_N"] += spoilt
        project.add("series.csv", table)
        project.config["sweep"] = project.config["sweep"][: len(project.tables)]
        found = points.read(excluding(project, ("series.csv", "902-1041")))
        usual[spoilt] = found.points.Fy
        entries = [row for row in found.left_out if row.file == "series.csv"]
        assert (entries[0].by, entries[0].lines, entries[0].count) == ("hand", "902-1041", 140)
        assert all(row.by == "rule" and row.why for row in entries[1:])
    assert np.array_equal(usual[0.0], usual[200.0])
    assert np.sum(found.points.file == found.points.files.index("series.csv")) == 5
    assert found.excluded is None  # samples are no points


def test_an_unreadable_line_of_a_recording_is_left_out_as_if_it_were_deleted(project):
    project.add("series.csv", series())
    settings = excluding(project, ("series.csv", "902-1041"))
    lines = project.text("series.csv").splitlines()
    lines[949] = lines[949].replace(",", ",?", 1)
    project.overwrite("series.csv", "\n".join(lines) + "\n")
    found = points.read(settings)
    deleted = points.read(without(project, "series.csv", range(900, 1040)))
    assert np.array_equal(found.points.Fy, deleted.points.Fy)


def test_every_sample_of_a_recording_is_averaged_or_listed_once(project):
    table = series()
    table.loc[300, "Fy_N"] += 3000.0  # a spike on a plateau
    table.loc[620:640, "Fz_N"] = 0.0  # lifted off
    project.add("series.csv", table)
    found = points.read(config.load(project.write()))
    entries = [row for row in found.left_out if row.file == "series.csv"]
    listed = [
        line for row in entries for a, b in config.lines.line_ranges(row.lines) for line in range(a, b + 1)
    ]
    assert len(listed) == len(set(listed)) == sum(row.count for row in entries)
    assert {"spike", "no-load", "steady-state"} <= {row.rule for row in entries}
    spike = next(row for row in entries if row.rule == "spike")
    assert spike.lines == "302"
    assert {622, 642} <= set(listed)
    assert len(listed) < len(table) / 2


def test_a_labelled_point_whose_samples_are_all_driven_gives_no_point(project):
    table = series().assign(point=np.repeat(np.arange(5), 400), kappa=0.0)
    table.loc[400:799, "kappa"] = 0.1
    table.loc[800:809, "kappa"] = 0.1
    project.add("series.csv", table)
    found = points.read(config.load(project.write()))
    rows = found.points.file == found.points.files.index("series.csv")
    assert np.degrees(found.points.alpha[rows]) == pytest.approx([-4.0, 0.0, 2.0, 4.0])
    driven = [row for row in found.left_out if row.rule == "driven-or-braked"]
    assert [(row.lines, row.count) for row in driven] == [("402-811", 410)]


def test_means_along_a_moving_sweep_on_a_disc_are_listed(project):
    n = 1500
    time, rng = np.arange(n) / 50.0, np.random.default_rng(3)
    table = series().iloc[:n].assign(time_s=time, alpha_deg=6.0 * np.sin(2.0 * np.pi * time / 30.0))
    table["Fy_N"] = -300.0 * table["alpha_deg"] - 330.0 + rng.normal(0.0, 3.0, n)
    project.add("sweep.csv", table)
    settings = config.load(project.write())
    (entry,) = points.read(settings).left_out
    assert (entry.file, entry.rule, entry.count) == ("sweep.csv", "steady-state", 300)
    assert "only mffit diagnose uses them" in entry.why
    assert points.read(settings, continuous=True).left_out == ()


def test_a_block_of_a_moving_sweep_with_few_sound_samples_is_listed(project):
    """Means are over 0.1 s, here five samples; three spikes leave too few of their block."""
    project.config["rig"] = {"type": "flat-track", "axes": "iso"}
    project.config["rolling_radius"] = []
    n = 1500
    time, rng = np.arange(n) / 50.0, np.random.default_rng(3)
    alpha = 6.0 * np.sin(2.0 * np.pi * time / 30.0)
    table = pd.DataFrame(
        {
            "time_s": time, "alpha_deg": alpha, "gamma_deg": 0.0, "Fz_N": 1500.0 + rng.normal(0.0, 2.0, n),
            "Fy_N": -300.0 * alpha + rng.normal(0.0, 3.0, n), "Mz_Nm": rng.normal(0.0, 0.3, n), "p_kPa": 250.0, "V_mps": 6.0,
        }
    )  # fmt: skip
    project.tables, project.config["sweep"] = {}, []
    project.add("sweep.csv", table)
    sound = points.read(config.load(project.write()))
    assert sound.left_out == ()
    for row, channel in ((500, "Mz_Nm"), (502, "Fy_N"), (504, "Fz_N")):
        table.loc[row, channel] += 900.0
    project.write()
    found = points.read(config.load(project.folder / "tyre.toml"))
    assert len(found.points) == len(sound.points) - 1
    listed = sorted((row.rule, row.lines) for row in found.left_out)
    assert listed == [("spike", "502"), ("spike", "504"), ("spike", "506"), ("steady-state", "503, 505")]


def test_a_spike_is_not_in_the_mean_of_its_plateau(project):
    project.add("series.csv", series())
    settings = config.load(project.write())

    def means():
        seen = points.read(settings).points
        return seen.Fy[seen.file == seen.files.index("series.csv")]

    sound = means()
    project.tables["series.csv"].loc[[300, 1130], "Fy_N"] += 5000.0
    project.write()
    assert means() == pytest.approx(sound, abs=0.5)


@pytest.mark.parametrize(
    ("entries", "words"),
    [
        ([("sideslip_1500.csv", "99")], "line 99 is beyond the end of the file; the readings of .* are in lines 2-14"),
        ([("sideslip_1500.csv", "1-3")], "line 1 is above the first reading"),
        ([("sideslip_1500.csv", "10-15")], "line 15 is beyond the end"),
    ],
)  # fmt: skip
def test_lines_without_a_reading_are_refused(project, entries, words):
    with pytest.raises(InputError, match=words) as error:
        points.read(excluding(project, *entries))
    assert error.value.key == "fit.exclude[1].lines"
    assert error.value.line is not None


def test_a_blank_line_holds_no_reading(project):
    settings = excluding(project, ("camber_1500.csv", "5"))
    lines = project.text("camber_1500.csv").splitlines()
    project.overwrite("camber_1500.csv", "\n".join([*lines[:4], "", *lines[4:]]))
    with pytest.raises(InputError, match="line 5 holds no reading"):
        points.read(settings)


def test_a_whole_file_may_be_excluded_but_not_all(project):
    all_lines = [(name, f"2-{len(table) + 1}") for name, table in project.tables.items()]
    settings = excluding(project, all_lines[0])
    assert all_lines[0][0] not in points.read(settings).points.files
    with pytest.raises(InputError, match="leaves out every reading") as error:
        points.read(excluding(project, *all_lines))
    assert error.value.key == "fit.exclude"


@pytest.mark.parametrize("rig", [{}, {"force_frame": "C"}, {"moments": "wheel-centre"}, {"axes": "sae"}])
def test_excluded_points_are_converted_as_all_others(project, rig):
    project.config["rig"] |= rig
    if "axes" in rig:
        project.each(alpha_deg=-1.0, Fy_N=-1.0, Mz_Nm=-1.0)
    for table in project.tables.values():
        table["Mx_Nm"], table["My_Nm"] = 10.0, -5.0
    whole = points.read(config.load(project.write())).points
    rows = (whole.file == whole.files.index("camber_1500.csv")) & np.isin(whole.line, [3, 4])
    found = points.read(excluding(project, ("camber_1500.csv", "3-4"))).excluded
    assert found is not None
    for channel in ("alpha", "gamma", "Fz", "Fy", "Mz", "Mx", "phi_t"):
        assert getattr(found, channel) == pytest.approx(getattr(whole, channel)[rows]), channel
