"""Samples, plateaus and sweeps are left out just beyond their limits and not just within them; sentences say where."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from mffit.points.choice import ROLLING_IN, chosen, settled
from mffit.points.faulty import Fault, faults
from mffit.points.remarks import dropped, faulty, note
from mffit.points.steady import SteadySettings, moves
from mffit.points.stretch import PLATEAU, SWEEP, Stretch

RATE = 50.0
N = 500


class Series(SimpleNamespace):
    """Samples of a time series."""

    def __len__(self) -> int:
        return len(self.alpha)


def recording(n: int = N, **channels) -> Series:
    """A sound recording at rest: 1500 N, 300 N of side force, noise on every channel of force."""
    rng = np.random.default_rng(2)
    one = np.ones(n)
    sound = {
        "file": "run.csv",
        "time": np.arange(n) / RATE,
        "line": np.arange(n) + 2,
        "alpha": 0.03 * one,
        "gamma": 0.1 * one,
        "kappa": 0.0 * one,
        "Fx": np.broadcast_to(np.nan, n),
        "Fz": 1500.0 + 5.0 * rng.standard_normal(n),
        "Fy": -300.0 + 3.0 * rng.standard_normal(n),
        "Mz": 9.0 + 0.3 * rng.standard_normal(n),
        "p": 250e3 * one,
        "V": 5.0 * one,
        "T": np.broadcast_to(25.0, n),
        "direction": np.ones(n, int),
        "point": None,
        "table": pd.DataFrame(index=range(n)),
    }
    return Series(**sound | channels)


def spoiled(name: str, rows, value: float, n: int = N) -> Series:
    """The recording with some samples of a channel set to a value."""
    series = recording(n)
    changed = np.array(getattr(series, name))
    changed[rows] = value
    return recording(n, **{name: changed})


def reasons(series: Series) -> list[str]:
    return [fault.reason for fault in faults(series)]


def test_sound_samples_have_no_fault():
    assert reasons(recording()) == []


@pytest.mark.parametrize("channel", ["alpha", "gamma", "Fz", "Fy"])
def test_a_missing_reading_is_a_fault_of_its_sample(channel):
    (fault,) = (f for f in faults(spoiled(channel, [7], np.nan)) if "no reading" in f.reason)
    assert fault.reason == f"no reading of {channel}"
    assert list(np.flatnonzero(fault.which)) == [7]
    assert not fault.ends_stretch


def test_readings_missing_for_so_long_that_a_rest_may_be_hidden_end_the_stretch():
    whole = recording()
    rate = 1.0 / np.median(np.diff(whole.time))
    (fault,) = (
        f for f in faults(spoiled("Fy", slice(7, 8 + round(2.0 * rate)), np.nan)) if "no reading" in f.reason
    )
    assert fault.ends_stretch


def test_a_tenth_of_the_usual_load_is_no_load():
    usual = float(np.median(recording().Fz))
    rows = slice(100, 110)
    assert "no load on the tyre" in reasons(spoiled("Fz", rows, 0.099 * usual))
    assert "no load on the tyre" not in reasons(spoiled("Fz", rows, 0.101 * usual))


@pytest.mark.parametrize(("kappa", "found"), [(0.021, True), (-0.021, True), (0.019, False), (-0.019, False)])
def test_two_per_cent_of_slip_is_driven_or_braked(kappa, found):
    slip = np.where(np.arange(N) == 3, kappa, 0.0)
    assert bool(reasons(recording(kappa=slip))) == found
    assert not reasons(recording(kappa=slip, Fx=np.ones(N)))


@pytest.mark.parametrize(
    ("channel", "size"),
    [("Fy", 0.15 * 1500.0), ("Mz", 0.03 * 1500.0), ("Fz", 0.15 * 1500.0)],
)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_spike_is_a_share_of_the_load_away_from_its_neighbours(channel, size, sign):
    level = float(np.median(getattr(recording(), channel)))
    noise = 4.0 * float(np.std(getattr(recording(), channel)))
    assert f"spikes of {channel}" in reasons(spoiled(channel, [40], level + sign * (size + noise)))
    assert f"spikes of {channel}" not in reasons(spoiled(channel, [40], level + sign * (size - noise)))
    (fault,) = faults(spoiled(channel, [40], level + sign * (size + noise)))
    assert list(np.flatnonzero(fault.which)) == [40]
    assert not fault.ends_stretch


def test_a_spike_is_twelve_times_the_noise():
    """With 60 N of noise a sixth of the load is still noise."""
    rng = np.random.default_rng(3)
    Fy = -300.0 + 60.0 * rng.standard_normal(N)
    for size, found in ((6.0 * 60.0, False), (14.0 * 60.0, True)):
        spiky = Fy.copy()
        spiky[40] = -300.0 + size
        assert bool(reasons(recording(Fy=spiky))) == found


@pytest.mark.parametrize(("length", "found"), [(4, True), (2, False)])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_few_samples_at_the_end_of_a_fine_range_are_clipped(length, found, side):
    """Of 500 samples of which hardly one in a hundred repeats, three in a row are chance once in a thousand recordings."""
    end = -300.0 + side * 20.0
    series = spoiled("Fy", slice(200, 200 + length), end)
    assert ("Fy clipped" in reasons(series)) == found
    assert "Fy stuck" not in reasons(series)


@pytest.mark.parametrize(("length", "found"), [(25, True), (24, False)])
def test_half_a_second_of_one_value_is_stuck(length, found):
    """25 samples at 50 Hz."""
    series = spoiled("Mz", slice(200, 200 + length), 9.01)
    assert ("Mz stuck" in reasons(series)) == found
    if found:
        (fault,) = faults(series)
        assert np.sum(fault.which) >= length - 1
        assert fault.ends_stretch


@pytest.mark.parametrize(("share", "found"), [(0.85, True), (0.4, False)])
def test_a_channel_of_coarse_resolution_is_not_stuck(share, found):
    """A channel that mostly repeats its last sample says nothing by repeating it longer."""
    rng = np.random.default_rng(8)
    fresh = np.cumsum(np.where(rng.random(N) < share, rng.uniform(0.1, 0.2, N), 0.0))
    Mz = 9.0 + 0.02 * (fresh % 7.0)
    Mz[200:240] = Mz[200]
    assert ("Mz stuck" in reasons(recording(Mz=Mz))) == found


@pytest.mark.parametrize("repeats", [0.1, 0.3])
def test_sound_channels_of_any_resolution_are_hardly_ever_stuck_or_clipped(repeats):
    """Noise that is rounded: the chance of a run is that of its repeats, so one recording in a thousand is conspicuous."""
    rng = np.random.default_rng(5)
    step = repeats * 2.0 * np.sqrt(np.pi)  # two normal numbers, rounded, are equal with about this chance
    slow = np.arange(N) / 2.0  # half a second is one sample
    rounded = (step * np.round(rng.standard_normal((100, N)) / step) for _ in range(3))
    found = [
        reasons(recording(Fy=-300.0 + Fy, Mz=9.0 + Mz, Fz=1500.0 + Fz, time=slow))
        for Fy, Mz, Fz in zip(*rounded, strict=True)
    ]
    assert sum(map(bool, found)) <= 2


@pytest.mark.parametrize(("moved", "found"), [(40.0, True), (10.0, False)])
def test_a_still_angle_is_stuck_only_while_the_force_moves(moved, found):
    """3 N of noise: a range of 12 times that is 36 N, whatever its memory."""
    rng = np.random.default_rng(9)
    alpha = 0.03 + 1e-4 * rng.standard_normal(N)
    alpha[100:150] = 0.03
    series = recording(alpha=alpha)
    Fy = np.array(series.Fy)
    Fy[100:150] = -300.0 + moved * np.linspace(0.0, 1.0, 50)
    assert ("alpha stuck while Fy moves" in reasons(recording(alpha=alpha, Fy=Fy))) == found


def test_left_out_samples_and_points_are_named_with_line_and_number():
    which = np.isin(np.arange(N), [10, 11, 30])
    (said,) = faulty(recording(), [Fault(which, "spikes of Fy", False)])
    assert said == "run.csv:12: spikes of Fy here and 2 more; left out"
    (said,) = faulty(recording(), [Fault(np.arange(N) == 10, "spikes of Fy", False)])
    assert said == "run.csv:12: spikes of Fy here; left out"


@pytest.mark.parametrize(("number", "more"), [(3, ""), (4, " and 1 more")])
@pytest.mark.parametrize(("kind", "what"), [(PLATEAU, "steady stretches"), (SWEEP, "sweeps")])
def test_three_dropped_stretches_are_named(number, more, kind, what):
    lost = [Stretch(50 * k, 50 * k + 40, "only 1.0 s steady", kind) for k in range(number)]
    (said,) = dropped(recording(), [*lost, Stretch(300, 400, "", kind)])
    assert said.startswith(
        f"run.csv: {number} of {number + 1} {what} are left out: at 0.0 s only 1.0 s steady; at 1.0 s"
    )
    assert said.endswith(f"at 2.0 s only 1.0 s steady{more}")


def test_the_row_of_a_stretch_is_in_a_users_units():
    series = recording(
        alpha=np.radians(np.linspace(-4.0, 5.0, N)),
        gamma=np.full(N, np.radians(10.0)),
        T=np.full(N, 41.0),
        Fz=np.full(N, 1500.0),
    )
    row = note(series, Stretch(50, 300, "", SWEEP), "run:a", 12)
    assert (row.begin_s, row.end_s, row.first_line, row.last_line) == (1.0, pytest.approx(5.98), 52, 301)
    low, high = np.degrees(series.alpha[[50, 299]])
    assert (row.alpha_from_deg, row.alpha_to_deg) == (pytest.approx(low), pytest.approx(high))
    assert row.gamma_deg == pytest.approx(10.0)
    assert (row.Fz_N, row.p_kPa, row.T_degC, row.points) == (1500.0, 250.0, 41.0, 12)
    assert (row.file, row.sweep, row.kind, row.dropped) == ("run.csv", "run:a", "sweep", "")


def settings(n: int, rate: float = RATE, V: float = 5.0) -> SteadySettings:
    one = np.ones(n)
    return SteadySettings(
        np.arange(n) / rate, 0.0 * one, 0.0 * one, 1500.0 * one, 250e3 * one, V * one, 0.0 * one
    )


@pytest.mark.parametrize(("seconds", "kept"), [(0.45, True), (0.35, False)])
def test_a_plateau_rolls_as_far_after_its_transient_as_in_it(seconds, kept):
    """At 5 m/s the transient takes 0.4 s; the first stretch of a recording has none."""
    rng = np.random.default_rng(1)
    for begin, transient in ((0, 0.0), (100, 0.4)):
        end = begin + round((seconds + transient) * RATE)
        x = rng.standard_normal(end)
        found = settled(Stretch(begin, end), settings(end), [(x, 30.0, "N")])
        assert (found.dropped == "") == kept
        if kept:
            assert found.begin == begin + round(transient * RATE)
        else:
            assert found.dropped.startswith("only 0.3 s steady")


def test_a_plateau_needs_eight_samples():
    x = np.random.default_rng(1).standard_normal(8)
    assert settled(Stretch(0, 8), settings(8, rate=2.0), [(x, 30.0, "N")]).dropped == ""
    assert (
        settled(Stretch(0, 7), settings(8, rate=2.0), [(x, 30.0, "N")]).dropped
        == "only 7 samples after the transient"
    )


def test_a_transient_is_found_in_few_samples_too():
    x = np.random.default_rng(1).standard_normal(9)
    x[0] += 50.0
    found = settled(Stretch(0, 9), settings(9, rate=2.0), [(x, 30.0, "N")])
    assert (found.begin, found.dropped) == (1, "")


@pytest.mark.parametrize(
    ("change", "dropped"), [(31.0, "still drifting by 31 N"), (29.0, ""), (-31.0, "still drifting by -31 N")]
)
def test_a_drift_is_dropped_from_its_harmless_size_on(change, dropped):
    """At most half of a record is cut off as a transient; the change over the rest counts."""
    noise = 0.01 * np.random.default_rng(1).standard_normal(500)
    x = noise + np.where(np.arange(500) < 250, 1000.0, change * (np.arange(500) - 250) / 249.0)
    found = settled(Stretch(0, 500), settings(500), [(noise, 30.0, "N"), (x, 30.0, "N")])
    assert found.dropped == dropped
    if not dropped:
        assert found.begin == 250


@pytest.mark.parametrize(("change", "dropped"), [(4.0, False), (30.0, True)])
def test_a_drift_is_told_from_its_noise(change, dropped):
    """500 samples of 10 N: the change along a line is known to 1.5 N; half of it may be cut off as a transient."""
    noise = 10.0 * np.random.default_rng(6).standard_normal(500)
    found = settled(
        Stretch(0, 500), settings(500), [(noise + change * np.linspace(-0.5, 0.5, 500), 1.0, "N")]
    )
    assert bool(found.dropped) == dropped


@pytest.mark.parametrize(("size", "begin"), [(3.0, 0), (13.0, 50)])
def test_a_transient_is_told_from_its_noise(size, begin):
    """The first 50 of 500 samples of 10 N are known to 1.5 N against the second half."""
    x = 10.0 * np.random.default_rng(6).standard_normal(500)
    x[:50] += size
    assert settled(Stretch(0, 500), settings(500), [(x, 1e3, "N")]).begin == begin


def test_noise_of_a_setting_is_no_move_however_large():
    """Means of half a second of 1 deg of noise differ by more than the step of a set-point."""
    rng = np.random.default_rng(6)
    noisy = settings(2000)._replace(alpha=np.radians(rng.standard_normal(2000)))
    assert not np.any(moves(noisy)["alpha"])


def swept(n: int = 2000, T=None, Fz=None) -> Series:
    """Five sweeps of sideslip at 50 Hz, eight seconds each; the load is set for each."""
    time = np.arange(n) / RATE
    alpha = np.radians(6.0 * np.sin(2.0 * np.pi * time / 8.0))
    more = {} if T is None else {"T": T}
    return recording(n, alpha=alpha, Fz=np.full(n, 1500.0) if Fz is None else Fz, Fy=-3e4 * alpha, **more)


LOADS = np.repeat([1000.0, 1200.0, 1450.0, 1750.0, 2100.0], 400)


def test_the_first_metres_behind_a_change_are_a_stretch_of_their_own():
    found = chosen(swept(Fz=LOADS), [], None)
    rolling = [s for s in found if s.dropped == ROLLING_IN]
    assert ROLLING_IN == "the first 2 m of rolling behind a gap or a change"
    assert len(rolling) == 4
    assert all(s.end - s.begin in (20, 21) for s in rolling)  # 0.4 s at 5 m/s


def test_a_load_that_wanders_by_half_leaves_its_sweep_whole():
    n = 2000
    Fz = 1500.0 * (
        1.0 + 0.27 * np.sin(200.0 * np.pi * np.arange(n) / n)
    )  # each half second: no change of the setting
    (found,) = (s for s in chosen(swept(Fz=Fz), [], None) if s.kind == SWEEP)
    assert not found.dropped


def test_a_series_of_faulty_samples_only_is_one_dropped_stretch_of_all_of_them():
    sweep = swept(500)
    always = Fault(np.full(500, True), "the wheel slips", ends_stretch=True)
    (found,) = chosen(sweep, [always], None)
    assert (found.begin, found.end, found.dropped) == (0, 500, "the wheel slips")
