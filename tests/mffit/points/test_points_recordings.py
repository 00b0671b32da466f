"""Recordings of a flat belt become sweeps: the lag is measured, and everything left out is named."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from disc_project import side_force
from flat_belt import CAMBERS, LOADS, RATE, recording, write_mat73

from mffit import config as configuration
from mffit import points
from mffit.errors import InputError
from mffit.pipeline.inputs import read_points
from mffit.points.stretch import MOVE, SWEEP
from mffit.recordings import sniff

COLUMNS = {
    "time_s": "ET", "alpha_deg": "SA", "gamma_deg": "IA", "Fz_N": "FZ", "Fy_N": "FY", "Mz_Nm": "MZ", "p_kPa": "P", "V_mps": "V",
    "T_degC": "TSTC", "kappa": "SL",
}  # fmt: skip


@pytest.fixture(scope="module")
def read(tmp_path_factory):
    def reading(
        table: pd.DataFrame, axes: str = "calspan", *, judged: bool = True, **keys
    ) -> points.loading.Reading:
        file = write_mat73(table, tmp_path_factory.mktemp("run") / "run.mat")
        reader = read_points if judged else points.read
        return reader(
            configuration.load(
                {
                    "tyre": {
                        "name": "x",
                        "unloaded_radius": 0.2,
                        "nominal_load": 1500.0,
                        "nominal_pressure": 83.0,
                    },
                    "rig": {"type": "flat-track", "axes": axes},
                    "columns": COLUMNS,
                    "sweep": [{"file": str(file)}],
                }
            ),
            **keys,
        )

    return reading


@pytest.fixture(scope="module")
def whole(read):
    """The recording without a fault."""
    return read(recording())


def kept(found) -> list:
    return [note for note in found.stretches if note.kind == SWEEP and not note.dropped]


@pytest.mark.parametrize("gaps", [True, False])
def test_every_condition_is_a_sweep_of_its_own(read, whole, gaps):
    found = read(recording(gaps=True)) if gaps else whole
    sweeps = kept(found)
    conditions = [(p, gamma, load) for p in (83.0, 97.0) for gamma in CAMBERS for load in LOADS]
    assert len(sweeps) == len(conditions)
    for note, (p, gamma, load) in zip(sweeps, conditions, strict=True):
        assert note.Fz_N == pytest.approx(load, rel=0.01)
        assert note.gamma_deg == pytest.approx(gamma, abs=0.05)
        assert note.p_kPa == pytest.approx(p, abs=0.2)
        assert note.alpha_from_deg < -8.5
        assert note.alpha_to_deg > 8.5
    labels = {found.points.sweep_names[k] for k in np.unique(found.points.sweep)}
    assert {note.sweep for note in sweeps} <= labels
    assert not np.any(found.points.continuous)


def test_every_sample_is_in_one_stretch_and_dropped_ones_have_a_reason(whole):
    notes = whole.stretches
    covered = np.zeros(len(recording()), dtype=int)
    for note in notes:
        covered[note.first_line - 1 : note.last_line] += 1
        assert bool(note.dropped) != bool(note.points), note
    # A plateau begins behind its transient, which is no stretch of its own.
    assert covered.max() == 1
    assert covered.mean() > 0.9


def test_points_lie_on_the_tyre(whole):
    """Means of ten samples of 10 N scatter by 3.2 N; the curve bends by less than 3 N over a third of a degree."""
    found = whole.points
    truth = side_force(found.alpha, found.gamma, found.Fz, side=0.0)
    assert np.sqrt(np.mean((found.Fy - truth) ** 2)) < 8.0
    line = found.line[1:] - found.line[:-1]
    assert np.all(line[np.diff(found.sweep) == 0] > 0)


@pytest.mark.parametrize("continuous", [True, False])
def test_the_angle_stays_as_read(read, continuous):
    """The lag of the force behind it is a number of the fit, or an effect of a diagnosis."""
    found = read(recording(sigma=0.5), continuous=continuous).points
    np.testing.assert_allclose(-found.table["alpha_deg"], np.degrees(found.alpha), atol=1e-9)
    assert np.mean(np.isfinite(found.time)) > 0.9
    assert np.any(found.continuous) == continuous


def test_spread_does_not_join_the_loads(read):
    """A load that wanders by a tenth within its sweeps does not make one level of three."""
    table = recording()
    table["FZ"] *= 1.0 + 0.1 * np.sin(np.arange(len(table)) / RATE / 2.0)
    found = read(table)
    loads = [note.Fz_N for note in kept(found)]
    assert len(loads) == 18
    assert points.levels.count(np.array(loads), points.levels.LOAD) == 3


def spoilt(change) -> pd.DataFrame:
    table = recording()
    change(table)
    return table


def stuck(table):
    table.loc[2000:2200, "FY"] = table["FY"][2000]


def clipped(table):
    table["FY"] = table["FY"].clip(upper=1800.0)


def hard_clipped(table):
    """A third of all samples: a channel that is mostly at its ends does not pass for one of few digits."""
    table["FY"] = table["FY"].clip(-900.0, 900.0)


def stuck_angle(table):
    table.loc[2000:2200, "SA"] = table["SA"][2000]


def spiky(table):
    table.loc[[700, 900, 2600], "FY"] += 4000.0


def off_the_belt(table):
    table.loc[3000:3400, "FZ"] = 3.0 * np.random.default_rng(2).standard_normal(401)


def silent(table):
    table.loc[4000:4100, "FY"] = np.nan


def driven(table):
    table.loc[5000:5300, "SL"] = 0.08


def impossible(table):
    table.loc[[100, 101], "FZ"] = -9e9


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (stuck, "Fy stuck"),
        (clipped, "Fy clipped"),
        (stuck_angle, "alpha stuck while Fy moves"),
        (spiky, "spikes of Fy"),
        (off_the_belt, "no load"),
        (silent, "no reading of Fy"),
        (driven, "driven or braked"),
        (impossible, "no reading"),
    ],
)
def test_faulty_samples_are_left_out_with_a_reason(read, whole, change, said):
    found = read(spoilt(change))
    sentences = " ".join([*found.warnings, *(note.dropped for note in found.stretches)])
    assert said in sentences
    truth = side_force(found.points.alpha, found.points.gamma, found.points.Fz, side=0.0)
    assert np.max(np.abs(found.points.Fy - truth)) < 80.0
    assert 0.5 * len(whole.points) < len(found.points) < 1.02 * len(whole.points)


def test_more_clipping_leaves_fewer_points(read, whole):
    found = read(spoilt(hard_clipped))
    assert any("Fy clipped" in warning for warning in found.warnings)
    assert len(found.points) < 0.6 * len(whole.points)
    truth = side_force(found.points.alpha, found.points.gamma, found.points.Fz, side=0.0)
    assert np.sqrt(np.mean((found.points.Fy - truth) ** 2)) < 60.0


def test_driven_rows_without_time_are_left_out_too(read):
    """And nobody is advised to leave out the time because the wheel was driven throughout."""
    table = spoilt(driven).drop(columns="ET")
    found = read(table)
    assert len(found.points) == len(table) - 301
    assert any("and 300 more" in warning and "driven or braked" in warning for warning in found.warnings)
    table["SL"] = 0.08
    with pytest.raises(InputError, match="no point left: all are driven or braked"):
        read(table)


@pytest.mark.parametrize("axes", ["iso", "adapted-sae"])
def test_a_wrong_declaration_is_caught(read, axes):
    with pytest.raises(InputError, match='"sae"'):
        read(recording(), axes=axes)


@pytest.mark.parametrize("column", ["SA", "FY", "IA"])
def test_a_reversed_channel_is_caught(read, column):
    table = recording()
    table[column] *= -1.0
    with pytest.raises(InputError, match="which no tyre does"):
        read(table)


def test_a_sample_that_is_written_twice_changes_no_point(read):
    table = recording(gaps=True)
    doubled = pd.concat([table.iloc[:800], table.iloc[799:800], table.iloc[800:]], ignore_index=True)
    found, once = read(doubled), read(table)
    assert any("1 of" in warning and "time of the one before" in warning for warning in found.warnings)
    assert len(found.points) == len(once.points)
    np.testing.assert_allclose(found.points.Fy, once.points.Fy, atol=30.0)


def test_a_recording_that_is_driven_throughout_is_refused_with_the_reason(read):
    table = recording()
    table["SL"] = 0.1
    with pytest.raises(InputError, match="driven or braked"):
        read(table)


def test_moves_between_plateaus_are_not_taken_for_sweeps(read):
    """A staircase of set-points with moves of 4 deg between them."""
    time = np.arange(8000) / RATE
    stations = np.repeat([0.0, 4.0, 8.0, 4.0, 0.0, -4.0, -8.0, -4.0], 2)
    corners = np.sort(np.r_[np.arange(8) * 10.0, np.arange(8) * 10.0 + 8.0])
    alpha = np.interp(time, corners, stations)
    table = recording().iloc[: len(time)].copy()
    random = np.random.default_rng(3)
    table["SA"], table["IA"], table["P"] = -alpha, 0.0, 83.0
    table["FZ"] = -1500.0 + 5.0 * random.standard_normal(len(time))
    table["FY"] = -side_force(np.radians(alpha), 0.0, 1500.0, side=0.0) + 5.0 * random.standard_normal(
        len(time)
    )
    found = read(table, judged=False)
    assert not kept(found)
    assert len(found.points) == 8
    assert {note.dropped for note in found.stretches if note.kind == MOVE} == {"moves between set-points"}


def test_points_of_a_recording_know_when_they_were_taken(read, whole):
    """From the first sample on, in order, as far apart as the samples that they average; for every effect of time."""
    t = whole.points.t
    assert np.all(np.isfinite(t))
    assert 0.0 <= t.min() < 16.0
    assert t.max() == pytest.approx(18 * 15.0, abs=1.0)
    for note in kept(whole):
        of_sweep = t[whole.points.sweep == whole.points.sweep_names.index(note.sweep)]
        assert note.begin_s - 31.5 <= of_sweep.min() < of_sweep.max() <= note.end_s - 31.5
        assert np.all(np.diff(of_sweep) > 0.0)
    again = read(recording().assign(ET=lambda table: table["ET"] + 1.7e9))
    np.testing.assert_allclose(again.points.t, t, atol=1e-5)


def test_clocks_that_each_begin_anew_are_no_common_time(tmp_path):
    table = recording(loads=(1500.0,), cambers=(0.0, 2.0), pressures=(83.0,))
    later = table.assign(ET=table["ET"] + 100.0)

    def times(*tables):
        for k, one in enumerate(tables):
            one.to_csv(tmp_path / f"{k}.csv", index=False)
        content = {
            "tyre": {"name": "x", "unloaded_radius": 0.2, "nominal_load": 1500.0, "nominal_pressure": 83.0},
            "rig": {"type": "flat-track", "axes": "sae"},
            "columns": {**COLUMNS, "V_mps": {"column": "V", "unit": "km/h"}},
            "sweep": [{"file": f"{k}.csv"} for k in range(len(tables))],
        }
        return points.read(configuration.load(content, folder=tmp_path)).points.t

    assert np.all(np.isfinite(times(table, later)))
    assert np.ptp(times(table, later)) > 100.0
    assert not np.any(np.isfinite(times(table, table)))


def stood(table: pd.DataFrame, seconds: float) -> pd.DataFrame:
    """The recording behind a standstill, in which the zero of the speed is below nothing and the tyre is not yet inflated."""
    n = round(seconds * RATE)
    first = pd.concat([table.iloc[:1]] * n, ignore_index=True)
    random = np.random.default_rng(7)
    first = first.assign(V=-0.04 + 0.01 * random.standard_normal(n), P=0.2, SL=-1.0, FY=0.0, FZ=-2.0, MZ=0.0)
    late = table.assign(ET=table["ET"] + seconds)
    return pd.concat([first.assign(ET=table["ET"][0] + np.arange(n) / RATE), late], ignore_index=True)


@pytest.mark.parametrize("seconds", [0.5, 4.0, 400.0])
def test_standstill_is_left_out_before_anything_is_judged(read, tmp_path, seconds):
    """Half a second, a tenth of a minute, and most of the recording."""
    table = recording(loads=(600.0, 1500.0), cambers=(0.0, 2.0), pressures=(83.0,))
    plain, behind = read(table), read(stood(table, seconds))
    assert np.array_equal(behind.points.Fy, plain.points.Fy)
    assert not [sentence for sentence in behind.warnings if "P" in sentence or "V" in sentence]
    (left,) = [one for one in behind.left_out if one.rule == "standstill"]
    assert (left.count, left.why) == (round(seconds * RATE), "the wheel stands")
    found = sniff([write_mat73(stood(table, seconds), tmp_path / "a.mat")])
    assert {"V_mps", "p_kPa"} <= found.recordings[0].guesses.keys()
    assert f"{round(seconds * RATE)} of" in " ".join(found.recordings[0].remarks)
    np.testing.assert_allclose([level.value for level in found.conditions["pressure"]], [83e3], rtol=0.01)
