"""Whatever moves by more than it scatters is a sweep, at any rate and in any pattern; what rests is a plateau."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
import scipy.signal

from mffit import build, points
from mffit import config as configuration
from mffit.points.steady import SteadySettings, moves, stretches
from mffit.points.stretch import PLATEAU, SWEEP
from mffit.report import verdict

LOAD = 900.0
B, C, D = 9.0, 1.4, 1.6


def sine(slip, stiffness: float = B, peak: float = D):
    """A force over the load, rising with a slip [-] or falling with an angle [rad]."""
    return peak * np.sin(C * np.arctan(stiffness * slip))


def at_rate(corners, rate: float) -> np.ndarray:
    """Values over time, from corners ``(time [s], value)``."""
    when, what = np.transpose(corners)
    return np.interp(np.arange(round(when[-1] * rate)) / rate, when, what)


def recording(rate: float, alpha_deg=0.0, kappa=0.0, *, scatter: float = 0.01, seed: int = 4) -> pd.DataFrame:
    """A tyre on a straight path that follows its angles at once; each channel with the noise of its sensor."""
    alpha_deg, kappa = np.broadcast_arrays(alpha_deg, kappa)
    random, n = np.random.default_rng(seed), len(alpha_deg)
    noise = random.standard_normal((6, n))
    return pd.DataFrame(
        {
            "time_s": np.arange(n) / rate,
            "alpha_deg": alpha_deg + scatter * noise[0],
            "gamma_deg": 0.005 * noise[1],
            "Fz_N": LOAD + 4.0 * noise[2],
            "kappa": kappa + 5e-4 * noise[3],
            "Fx_N": LOAD * sine(kappa) + 4.0 * noise[4],
            "Fy_N": -LOAD * sine(np.radians(alpha_deg)) + 4.0 * noise[5],
            "p_kPa": 120.0,
            "V_mps": 10.0,
        }
    )


@pytest.fixture
def read(tmp_path):
    def reading(*tables: pd.DataFrame) -> points.loading.Reading:
        names = [f"{k}.csv" for k in range(len(tables))]
        for name, table in zip(names, tables, strict=True):
            table.to_csv(tmp_path / name, index=False)
        tyre = {"name": "x", "unloaded_radius": 0.25, "nominal_load": LOAD, "nominal_pressure": 120.0}
        content = {"tyre": tyre, "rig": {"type": "flat-track"}, "sweep": [{"file": name} for name in names]}
        return points.read(configuration.load(content, folder=tmp_path))

    return reading


def of_kind(found, kind: str) -> list:
    return [note for note in found.stretches if note.kind == kind and not note.dropped]


def triangle(seconds: float, rate: float, top: float) -> np.ndarray:
    return at_rate([(0.0, 0.0), (0.5 * seconds, top), (seconds, 0.0)], rate)


def sawtooth(seconds: float, rate: float, top: float) -> np.ndarray:
    """Up slowly and back at once, four times."""
    teeth = [((k + x) * seconds / 4.0, y) for k in range(4) for x, y in ((0.0, 0.0), (0.98, top))]
    return at_rate([*teeth, (seconds, 0.0)], rate)


def wave(seconds: float, rate: float, top: float) -> np.ndarray:
    """Slow about its turning points."""
    return top * np.sin(2.0 * np.pi * np.arange(round(seconds * rate)) / rate / seconds)


@pytest.mark.parametrize("pattern", [triangle, sawtooth, wave])
@pytest.mark.parametrize(("seconds", "rate"), [(6.0, 50.0), (60.0, 20.0), (1500.0, 1.0)])
@pytest.mark.parametrize(("setting", "top"), [("alpha_deg", 5.0), ("kappa", -0.09)])
def test_a_setting_that_moves_is_a_sweep_at_any_rate(read, pattern, seconds, rate, setting, top):
    """From 1.7 deg/s down to 0.007 deg/s at one sample a second."""
    found = read(recording(rate, **{setting: pattern(seconds, rate, top)}))
    sweeps = of_kind(found, SWEEP)
    assert {note.swept for note in sweeps} == {setting}
    if pattern is not wave:  # which rests at its turning points if it is slow
        assert not of_kind(found, PLATEAU)
    values = found.points.table[setting]
    assert np.ptp(values) > 0.85 * (2.0 if pattern is wave else 1.0) * abs(top)
    assert sum(note.end_s - note.begin_s for note in sweeps) > 0.7 * seconds
    force, truth = (
        (found.points.Fy, -LOAD * sine(found.points.alpha))
        if setting == "alpha_deg"
        else (found.points.Fx, LOAD * sine(found.points.kappa))
    )
    assert np.sqrt(np.mean((force - truth) ** 2)) < 8.0


@pytest.mark.parametrize("scatter", [0.01, 0.3, 2.0])
def test_noise_of_a_held_setting_is_no_sweep(read, scatter):
    """The plateau of a rig whose sensor is noisy, a minute long."""
    found = read(recording(50.0, alpha_deg=np.full(3000, 3.0), scatter=scatter))
    (plateau,) = of_kind(found, PLATEAU)
    assert plateau.end_s - plateau.begin_s > 59.0
    assert not of_kind(found, SWEEP)


def test_a_slow_ramp_between_long_rests_leaves_both_plateaus(read):
    """0.1 deg/s over 6 deg: what is marked before and behind takes less time than a step of 0.15 deg."""
    alpha = at_rate([(0.0, 0.0), (40.0, 0.0), (100.0, 6.0), (140.0, 6.0)], 20.0)
    found = read(recording(20.0, alpha_deg=alpha))
    before, after = of_kind(found, PLATEAU)
    (sweep,) = of_kind(found, SWEEP)
    assert 37.0 < before.end_s <= 41.5
    assert 98.5 <= after.begin_s < 103.0
    assert sweep.alpha_from_deg < 0.3
    assert sweep.alpha_to_deg > 5.7


@pytest.mark.parametrize("stop", [1.0, 2.0, 3.0])
def test_a_ramp_with_stops_keeps_all_its_readings(read, stop):
    """A stop every 2 deg, at 0.5 deg/s: stops are plateaus if they last, and part of the sweep if they do not."""
    corners, time = [(0.0, -8.0)], 0.0
    for angle in np.arange(-8.0, 8.0, 2.0):
        corners += [(time + stop, angle), (time + stop + 4.0, angle + 2.0)]
        time += stop + 4.0
    found = read(recording(50.0, alpha_deg=at_rate(corners, 50.0)))
    kept = of_kind(found, SWEEP) + of_kind(found, PLATEAU)
    assert sum(note.end_s - note.begin_s for note in kept) > 0.85 * time
    assert not [
        note for note in found.stretches if "samples after" in note.dropped or "steady" in note.dropped
    ]


@pytest.mark.parametrize(
    "angles", [np.arange(-8.0, 9.0, 1.0), np.r_[0.0, -2.0, 2.0, -4.0, 4.0, -8.0, 8.0, 0.0]]
)
def test_a_staircase_of_short_holds_gives_a_plateau_for_each(read, angles):
    """Three seconds each: comparisons over half a second leave less than half of it at rest."""
    alpha = np.repeat(angles, 150).astype(float)
    alpha[1:] = np.where(alpha[1:] != alpha[:-1], 0.5 * (alpha[1:] + alpha[:-1]), alpha[1:])
    found = read(recording(50.0, alpha_deg=alpha))
    plateaus = [note for note in of_kind(found, PLATEAU) if not note.dropped]
    assert [round(note.alpha_to_deg) for note in plateaus] == angles.tolist()
    assert not of_kind(found, SWEEP)


@pytest.mark.parametrize("seconds", [3.0, 4.0])
def test_a_staircase_to_either_side_whose_steps_settle_slowly_gives_a_plateau_for_each(read, seconds):
    """Set-points +1, -1, +2, -2 ... deg are reached with a lag of 0.3 s, which takes half of a hold."""
    angles = [side * angle for angle in range(1, 13) for side in (1, -1)]
    demand = np.repeat(angles, round(50.0 * seconds)).astype(float)
    keeps = np.exp(-1.0 / 50.0 / 0.3)
    alpha = scipy.signal.lfilter([1.0 - keeps], [1.0, -keeps], demand)
    found = read(recording(50.0, alpha_deg=alpha))
    plateaus = [note for note in of_kind(found, PLATEAU) if not note.dropped]
    assert [round(note.alpha_to_deg) for note in plateaus] == angles
    assert not of_kind(found, SWEEP)


def between_rests(one: np.ndarray, rate: float) -> np.ndarray:
    """Six times one movement, each after three seconds at rest where it begins."""
    return np.tile(np.r_[np.full(round(3.0 * rate), one[0]), one], 6)


@pytest.mark.parametrize("setting", ["alpha_deg", "kappa"])
@pytest.mark.parametrize("seconds", [1.0, 1.5])
@pytest.mark.parametrize("shape", ["triangle", "sine", "one side", "sawtooth"])
def test_a_fast_movement_that_turns_back_between_rests_is_a_sweep(read, shape, seconds, setting):
    rate, top = 100.0, 10.0 if setting == "alpha_deg" else 0.1
    phase = np.arange(round(seconds * rate)) / (seconds * rate)
    one = {
        "triangle": 1.0 - np.abs((4.0 * phase + 1.0) % 4.0 - 2.0),
        "sine": np.sin(2.0 * np.pi * phase),
        "one side": 1.0 - np.abs(2.0 * phase - 1.0),
        "sawtooth": 2.0 * phase - 1.0,
    }[shape]
    found = read(recording(rate, **{setting: between_rests(top * one, rate)}))
    swept = of_kind(found, SWEEP)
    assert len(swept) >= 4
    assert {note.swept for note in swept} == {setting}
    assert len([note for note in of_kind(found, PLATEAU) if not note.dropped]) == 6
    reached = found.points.condition(setting)
    assert np.ptp(reached) > 0.8 * np.ptp(top * one)
    assert not found.doubts


@pytest.mark.parametrize("seconds", [0.2, 1.0])
def test_a_fast_move_to_the_next_set_point_and_a_short_bump_are_no_sweeps(read, seconds):
    bump = np.interp(np.linspace(0.0, 1.0, 20), [0.0, 0.5, 1.0], [0.0, 6.0, 0.0])  # 2 m of rolling
    ramp = np.linspace(-6.0, 6.0, round(100.0 * seconds))
    rest = np.zeros(300)
    alpha = np.tile(np.r_[rest - 6.0, ramp, rest + 6.0, ramp[::-1]], 3)
    assert not of_kind(read(recording(100.0, alpha_deg=alpha)), SWEEP)
    assert not of_kind(read(recording(100.0, alpha_deg=between_rests(bump, 100.0))), SWEEP)


def test_a_move_in_a_staircase_is_no_sweep_and_a_movement_over_its_range_is():
    """Steps of 2 deg from -8 to 8 deg, and all the way back in 8 s."""
    angles = np.arange(-8.0, 9.0, 2.0)
    corners = [(10.0 * k + x, a) for k, a in enumerate(angles) for x in (0.0, 7.5)]
    corners += [(corners[-1][0] + 8.0, -8.0), (corners[-1][0] + 18.0, -8.0)]
    alpha = np.radians(at_rate(corners, 50.0))
    one = np.ones(len(alpha))
    settings = SteadySettings(
        np.arange(len(alpha)) / 50.0, alpha, 0 * one, LOAD * one, 1e5 * one, 9.0 * one, 0 * one
    )
    found = stretches(settings)
    (sweep,) = (s for s in found if s.kind == SWEEP)
    assert sweep.end - sweep.begin == pytest.approx(8.0 * 50.0, abs=60)
    assert len([s for s in found if s.kind == PLATEAU]) == len(angles) + 1
    assert not np.any(moves(settings)["gamma"])


def braked_with_the_speed(fall: float) -> pd.DataFrame:
    """Eight brakings between rests, in each of which a share of the speed goes and comes back every second."""
    corners = [
        (6.0 * k + x, s) for k in range(8) for x, s in ((0.0, 0.0), (3.0, 0.0), (4.4, -0.1), (5.9, 0.0))
    ]
    kappa = at_rate(corners, 50.0)
    table = recording(50.0, kappa=kappa)
    table["V_mps"] *= 1.0 - fall * (kappa < -0.001) * (np.arange(len(kappa)) // 25 % 2)
    return table


def test_a_setting_whose_sweeps_are_all_lost_is_in_doubt(read):
    """The speed jumps by two thirds while the wheel is braked, so that no sweep of slip is held."""
    (doubt,) = read(braked_with_the_speed(0.67)).doubts
    assert doubt.startswith("kappa moves from -0.09")
    assert "load, pressure or speed changes" in doubt
    assert not read(braked_with_the_speed(0.05)).doubts


def test_a_build_without_the_sweeps_of_its_recording_is_not_sound(tmp_path):
    up = at_rate([(0.0, -8.0), (8.0, 8.0), (16.0, -8.0)], 20.0)
    recording(20.0, alpha_deg=up).to_csv(tmp_path / "a.csv", index=False)
    braked_with_the_speed(0.67).to_csv(tmp_path / "b.csv", index=False)
    tyre = {"name": "x", "unloaded_radius": 0.25, "nominal_load": LOAD, "nominal_pressure": 120.0}
    content = {"tyre": tyre, "rig": {"type": "flat-track"}, "sweep": [{"file": "a.csv"}, {"file": "b.csv"}]}
    result = build(configuration.load(content, folder=tmp_path))
    assert result.trust.doubts[0] == next(w for w in result.warnings if w.startswith("kappa moves"))
    assert verdict.judged(result) != "sound"


UP_AND_DOWN = at_rate([(0.0, -8.0), (8.0, 8.0), (16.0, -8.0)], 50.0)


@pytest.mark.parametrize("column", ["alpha_deg", "gamma_deg", "Fz_N", "Fy_N", "kappa", "p_kPa", "V_mps"])
def test_a_gap_in_which_no_rest_hides_cuts_no_sweep_and_adds_no_reading(read, column):
    """A cell is empty every second, and once all cells for 1.5 s."""
    table = recording(50.0, alpha_deg=UP_AND_DOWN)
    gaps = (np.arange(len(table)) % 50 == 7) | (
        (np.arange(len(table)) >= 300) & (np.arange(len(table)) < 375)
    )
    found = read(table.assign(**{column: table[column].mask(gaps)}))
    (sweep,) = of_kind(found, SWEEP)
    assert sweep.end_s - sweep.begin_s > 15.0
    interpolated = column in ("p_kPa", "V_mps")  # what is held may be logged more slowly
    assert np.any((found.points.time > 6.05) & (found.points.time < 7.35)) == interpolated
    np.testing.assert_allclose(found.points.Fy, -LOAD * sine(found.points.alpha), atol=30.0)
    assert not found.doubts


def test_a_longer_gap_cuts_the_sweep(read):
    table = recording(50.0, alpha_deg=UP_AND_DOWN)
    gap = (np.arange(len(table)) >= 250) & (np.arange(len(table)) < 375)
    assert len(of_kind(read(table.assign(Fy_N=table["Fy_N"].mask(gap))), SWEEP)) == 2


def test_sweeps_of_which_most_is_left_out_are_in_doubt(read):
    """The force is missing for 2.6 s of every 4.8, and 2 s of rest of a sweep begin with its first metres."""
    table = recording(50.0, alpha_deg=np.tile(UP_AND_DOWN, 4))
    (doubt,) = read(table.assign(Fy_N=table["Fy_N"].mask(np.arange(len(table)) % 240 < 130))).doubts
    assert "26 s of 63 s of recorded sweeps (mostly because: no reading of Fy)" in doubt


def drifting(table: pd.DataFrame, column: str, by: float) -> pd.DataFrame:
    return table.assign(**{column: table[column] + by * np.linspace(0.0, 1.0, len(table))})


@pytest.mark.parametrize(("seconds", "rate"), [(8.0, 50.0), (400.0, 5.0)])
def test_a_held_setting_that_drifts_ends_no_sweep(read, seconds, rate):
    """Camber by 0.6 deg and pressure by a tenth over three sweeps, at 1.2 and at 0.025 deg/s."""
    alpha = np.tile(triangle(seconds, rate, 5.0), 3)
    table = drifting(drifting(recording(rate, alpha_deg=alpha), "gamma_deg", 0.6), "p_kPa", 12.0)
    found = read(table)
    sweeps = of_kind(found, SWEEP)
    assert {note.swept for note in sweeps} == {"alpha_deg"}
    assert sum(note.end_s - note.begin_s for note in sweeps) > 0.9 * 3.0 * seconds


def test_a_held_setting_that_drifts_ends_no_plateau(read):
    """Nine plateaus of ten seconds; camber drifts by 0.6 deg from the first to the last."""
    corners = [(12.0 * k + x, a) for k, a in enumerate(np.arange(-4.0, 5.0)) for x in (0.0, 10.0)]
    table = drifting(recording(20.0, alpha_deg=at_rate(corners, 20.0)), "gamma_deg", 0.6)
    assert len(of_kind(read(table), PLATEAU)) == 9


def test_a_slow_camber_sweep_is_one_of_camber_although_sideslip_drifts(read):
    table = recording(5.0, alpha_deg=np.zeros(2000))
    table["gamma_deg"] += triangle(400.0, 5.0, 20.0)
    table["Fy_N"] -= 0.8 * LOAD * np.sin(np.radians(triangle(400.0, 5.0, 20.0)))
    (sweep,) = of_kind(read(drifting(table, "alpha_deg", 0.5)), SWEEP)
    assert sweep.swept == "gamma_deg"


@pytest.mark.parametrize("scatter", [0.01, 0.4])
def test_noise_of_an_angle_does_not_shorten_its_averages(read, scatter):
    """A turn of the wheel to a point, 15.5 samples; with 0.4 deg of noise each, the mean angle is known to 0.1 deg."""
    alpha = triangle(20.0, 100.0, 8.0)
    found = read(recording(100.0, alpha_deg=alpha, scatter=scatter)).points
    assert np.mean(np.diff(found.time[:40])) == pytest.approx(2.0 * np.pi * 0.25 / 10.0, abs=0.002)
    truth = np.interp(found.time, np.arange(len(alpha)) / 100.0, alpha)
    assert np.std(np.degrees(found.alpha) - truth) < 0.02 + 0.4 * scatter


def test_a_load_that_moves_at_a_held_angle_is_a_sweep_of_the_load(read):
    """400 N to 1600 N and back in 40 s: the mean of all of it is a point of no load."""
    table = recording(20.0, alpha_deg=np.full(800, 3.0))
    load = at_rate([(0.0, 400.0), (20.0, 1600.0), (40.0, 400.0)], 20.0)
    table = table.assign(Fz_N=load, Fy_N=-load * sine(np.radians(3.0)))
    found = read(table)
    (sweep,) = of_kind(found, SWEEP)
    assert sweep.swept == "Fz_N"
    assert not of_kind(found, PLATEAU)
    assert np.ptp(found.points.Fz) > 1150.0
    np.testing.assert_allclose(found.points.Fy, -found.points.Fz * sine(found.points.alpha), rtol=0.01)


@pytest.mark.parametrize("cycle", [6.0, 12.0, 20.0])
def test_a_load_profile_under_held_angles_is_a_sweep_of_the_load(read, cycle):
    """A cosine of load between 600 and 1800 N at each of four angles, and none of its turns is a set-point."""
    t = np.arange(0.0, 160.0, 0.05)
    alpha = np.select([t < 40.0, t < 80.0, t < 120.0], [-3.0, -1.0, 1.0], 3.0)
    load = 1200.0 - 600.0 * np.cos(2.0 * np.pi * (t % 40.0) / cycle)
    table = recording(20.0, alpha_deg=alpha)
    table = table.assign(Fz_N=load, Fy_N=-load * sine(np.radians(alpha)))
    found = read(table)
    assert {s.swept for s in of_kind(found, SWEEP)} == {"Fz_N"}
    assert sum(s.end_s - s.begin_s for s in of_kind(found, SWEEP)) > 0.9 * t[-1]


@pytest.mark.parametrize("cycle", [6.0, 12.0, 20.0])
def test_a_load_profile_does_not_cut_the_sweep_of_an_angle(read, cycle):
    alpha = at_rate([(0.0, -8.0), (23.0, 8.0), (46.0, -8.0)], 20.0)
    load = 1200.0 - 600.0 * np.cos(2.0 * np.pi * np.arange(len(alpha)) / 20.0 / cycle)
    table = recording(20.0, alpha_deg=alpha)
    found = read(table.assign(Fz_N=load, Fy_N=-load * sine(np.radians(alpha))))
    (sweep,) = of_kind(found, SWEEP)
    assert sweep.swept == "alpha_deg"
    assert sweep.end_s - sweep.begin_s > 45.0
    np.testing.assert_allclose(
        found.points.Fy, -found.points.Fz * sine(found.points.alpha), rtol=0.03, atol=10.0
    )


def test_a_load_that_rises_again_and_again_rests_nowhere(read):
    """A sawtooth of 10 s: neither its jumps nor what lies between two of them is a plateau that never settles."""
    t = np.arange(0.0, 60.0, 0.01)
    table = recording(100.0, alpha_deg=np.full(len(t), 3.0))
    found = read(
        table.assign(
            Fz_N=200.0 + 1400.0 * (t / 10.0 % 1.0) + np.random.default_rng(8).normal(0.0, 5.0, len(t))
        )
    )
    assert {note.kind for note in found.stretches} == {SWEEP}
    assert not any("steady" in sentence for sentence in found.warnings)


@pytest.mark.parametrize("speed", [0.9, 10.0])
def test_a_run_for_the_spring_rate_gives_its_points(read, speed):
    """The load goes up and down at walking pace, before sweeps of sideslip at a held load."""
    still = recording(20.0, alpha_deg=np.zeros(400))
    still = still.assign(Fz_N=200.0 + 70.0 * (10.0 - np.abs(np.arange(400) / 20.0 - 10.0)), V_mps=speed)
    swept = recording(20.0, alpha_deg=np.tile(triangle(20.0, 20.0, 8.0), 2))
    table = pd.concat([still, swept.assign(time_s=swept.time_s + 25.0)], ignore_index=True)
    found = read(table)
    assert {note.swept for note in of_kind(found, SWEEP)} == {"Fz_N", "alpha_deg"}
    (rising,) = [note for note in of_kind(found, SWEEP) if note.swept == "Fz_N"]
    assert rising.end_s - rising.begin_s > 15.0
    assert not [one for one in found.left_out if one.rule == "standstill"]


def test_a_load_that_wanders_by_a_tenth_is_held(read):
    table = recording(20.0, alpha_deg=np.full(800, 3.0))
    table["Fz_N"] *= 1.0 + 0.1 * np.sin(np.arange(800) / 100.0)
    assert len(of_kind(read(table), PLATEAU)) == 1
