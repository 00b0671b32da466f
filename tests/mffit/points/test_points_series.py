"""Time series become the points at which they rested, with warnings about what was left out."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest
from disc_project import moment, side_force
from scipy.signal import lfilter

from mffit import config as configuration
from mffit import points
from mffit.config.models import FitTable
from mffit.errors import InputError
from mffit.points.steady import SteadySettings, moves, stretches

RATE = 20.0
SIGMA = 0.4  # relaxation length [m]
V = 6.0
STATIONS = np.array([-6.0, -4.0, -2.0, -1.0, 0.0, 1.0, 2.0, 4.0, 6.0])


def series(
    stations: np.ndarray = STATIONS,
    *,
    hold: float | np.ndarray = 30.0,
    rate: float = RATE,
    steering: float = 2.0,
    encoder_deg: float = 0.0,
    noise: float = 25.0,
    correlation_s: float = 0.5,
    settle_s: float = SIGMA / V,
    seed: int = 2,
    Fz: float = 1500.0,
) -> pd.DataFrame:
    """A rig that steers from station to station and holds; the force follows with a lag of ``settle_s``."""
    travel = np.abs(np.diff(stations)) / steering
    hold = np.broadcast_to(hold, len(stations))
    arrivals = np.r_[0.0, np.cumsum(travel + hold[:-1])]
    corners = np.column_stack([arrivals, arrivals + hold]).ravel()
    time = np.arange(int(corners[-1] * rate) + 1) / rate
    alpha = np.interp(time, corners, np.repeat(stations, 2))
    forgets = math.exp(-1.0 / (settle_s * rate))
    follows, _ = lfilter([1 - forgets], [1, -forgets], np.radians(alpha), zi=[forgets * np.radians(alpha[0])])
    generator = np.random.default_rng(seed)
    remembers = math.exp(-1.0 / (correlation_s * rate))
    fresh = generator.standard_normal((2, len(time))) * math.sqrt(1 - remembers**2)
    drift = lfilter([1.0], [1.0, -remembers], fresh)
    return pd.DataFrame(
        {
            "time_s": np.round(time, 4),
            "alpha_deg": alpha + encoder_deg * generator.standard_normal(len(time)),
            "gamma_deg": 0.0,
            "Fz_N": Fz * (1 + 0.01 * generator.standard_normal(len(time))),
            "Fy_N": side_force(follows, 0.0, Fz) + noise * drift[0],
            "Mz_Nm": moment(follows, 0.0, Fz) + noise / 10 * drift[1],
            "p_kPa": 250.0,
            "V_mps": V,
        }
    )


def load(project, **options):
    return points.read(configuration.load(project.write()), **options)[:2]


def of_file(found: points.Points, name: str) -> points.Points:
    return found.select(found.file == found.files.index(name))


def test_a_series_gives_the_points_it_rested_at(project):
    """Within 3.5 standard errors of the truth each, which one in two thousand exceeds."""
    project.add("series.csv", series())
    found, warnings = load(project)
    assert warnings == ()
    part = of_file(found, "series.csv")
    np.testing.assert_allclose(np.degrees(part.alpha), STATIONS, atol=1e-6)
    assert not np.any(part.continuous)
    truth = side_force(np.radians(STATIONS), 0.0, 1500.0)
    assert np.all(np.abs(part.Fy - truth) < 3.5 * part.u_Fy)
    # 25 N with a correlation time of 0.5 s over some 29 s: 25 sqrt(2 x 0.5 / 29) = 4.6 N
    assert np.median(part.u_Fy) == pytest.approx(4.6, rel=0.3)
    assert "time_s" not in part.table
    np.testing.assert_array_equal(part.table["u_Fy_N"], part.u_Fy)


def test_the_points_of_many_series_are_covered_by_their_errors(project):
    """95 % intervals of 180 plateaus; binomial scatter is 1.6 %."""
    for k in range(20):
        project.add(f"series{k}.csv", series(hold=20.0, seed=100 + k))
    found, _ = load(project)
    truth = side_force(np.radians(STATIONS), 0.0, 1500.0)
    inside = [
        np.abs(of_file(found, f"series{k}.csv").Fy - truth) < 1.96 * of_file(found, f"series{k}.csv").u_Fy
        for k in range(20)
    ]
    assert 0.89 <= np.mean(inside) <= 0.99


LONG_AND_SHORT = np.array([4.0, 45.0, 2.5, 45.0, 2.5, 20.0, 3.0, 2.5, 2.5])
"""Rests [s] of which the longest are most of the time: without one of them, a staircase would look like a movement."""


@pytest.mark.parametrize(
    ("seed", "how"),
    [
        (0, {}),
        (1, {"settle_s": 2.0}),
        (0, {"settle_s": 1.0, "encoder_deg": 0.05}),
        (2, {"hold": LONG_AND_SHORT, "steering": 0.5}),
    ],
)
def test_any_point_can_be_left_out_alone_by_its_lines(project, how, seed):
    """However long each rest was: all other points stay as they were, to the last digit."""
    name, holds = "series.csv", np.random.default_rng(seed).uniform(5.0, 60.0, len(STATIONS))
    project.add(name, series(**{"hold": holds, "seed": seed, **how}))
    config = configuration.load(project.write())
    own = of_file(points.read(config).points, name)
    assert (
        len(own) >= len(STATIONS) - 2
    )  # two rests of 5 and 7 s are shorter than forces need that settle in 2 s
    assert np.all(own.line[1:] > own.last_line[:-1])
    for k in (*range(0, len(own), 3), len(own) - 1):
        lines = f"{own.line[k]}-{own.last_line[k]}"
        less = config.model_copy(
            update={"fit": FitTable(exclude=({"file": name, "lines": lines, "why": "x"},))}
        )
        left = of_file(points.read(less).points, name)
        for channel in ("line", "last_line", "alpha", "Fy", "Mz"):
            np.testing.assert_array_equal(getattr(left, channel), np.delete(getattr(own, channel), k))


def test_a_rest_without_some_of_its_lines_is_one_point(project):
    """A glitch of the encoder among them does not divide it, and the force that is left out does not count."""
    table = series()
    held = np.flatnonzero(table["alpha_deg"] == STATIONS[4])
    spoilt = held[len(held) // 2 :][:20]
    table.loc[spoilt[:5], "alpha_deg"] += 3.0
    table.loc[spoilt, "Fy_N"] += 900.0
    project.add("series.csv", table)
    config = configuration.load(project.write())
    out = ({"file": "series.csv", "lines": f"{spoilt[0] + 2}-{spoilt[-1] + 2}", "why": "x"},)
    found = points.read(config.model_copy(update={"fit": FitTable(exclude=out)})).points
    own = of_file(found, "series.csv")
    np.testing.assert_allclose(np.degrees(own.alpha), STATIONS, atol=1e-6)
    truth = side_force(np.radians(STATIONS), 0.0, 1500.0)
    assert np.all(np.abs(own.Fy - truth) < 3.5 * own.u_Fy)


@pytest.mark.parametrize("encoder_deg", [0.01, 0.05])
def test_a_noisy_encoder_does_not_hide_the_plateaus(project, encoder_deg):
    project.add("series.csv", series(encoder_deg=encoder_deg))
    found, _ = load(project)
    part = of_file(found, "series.csv")
    np.testing.assert_allclose(np.degrees(part.alpha), STATIONS, atol=0.02)


def test_a_slow_transient_is_dropped(project):
    """A lag of 1.5 s, thirty times the tyre's: without the first seconds the mean is within its error."""
    project.add("series.csv", series(settle_s=1.5, noise=10.0))
    found, _ = load(project)
    part = of_file(found, "series.csv")
    truth = side_force(np.radians(STATIONS), 0.0, 1500.0)
    assert np.all(np.abs(part.Fy - truth) < np.maximum(5 * part.u_Fy, 8.0))


def test_a_stretch_that_keeps_drifting_is_dropped_with_its_reason(project):
    table = series(noise=5.0)
    late = table["time_s"] > table["time_s"].max() - 30.0
    table.loc[late, "Fy_N"] += 10.0 * (table.loc[late, "time_s"] - table.loc[late, "time_s"].min())
    project.add("series.csv", table)
    found, warnings = load(project)
    assert len(of_file(found, "series.csv")) == len(STATIONS) - 1
    assert any("series.csv" in w and "still drifting" in w and "1 of 9" in w for w in warnings)


def test_a_short_hold_is_dropped_with_its_reason(project):
    table = series()
    held = table["alpha_deg"] == -1.0
    table = table[~held | (table["time_s"] < table.loc[held, "time_s"].min() + 1.6)]
    project.add("series.csv", table.assign(V_mps=2.0))  # 1.6 s are 3.2 m
    found, warnings = load(project)
    assert len(of_file(found, "series.csv")) == len(STATIONS) - 1
    assert any("1 of 9" in w and "s steady" in w for w in warnings)


def test_a_hold_of_five_turns_of_the_wheel_is_a_point(project):
    """Steps of 3 s at 20 m/s, as of a machine that steps its slip or its load and needs a second and a half for each step."""
    table = series(hold=3.0, rate=100.0, steering=20.0, correlation_s=0.02, settle_s=SIGMA / 20.0)
    project.add("series.csv", table.assign(V_mps=20.0))
    found, _ = load(project)
    of_series = of_file(found, "series.csv")
    assert np.degrees(of_series.alpha) == pytest.approx(STATIONS, abs=1e-6)
    truth = side_force(of_series.alpha, 0.0, 1500.0)
    assert np.max(np.abs(of_series.Fy - truth)) < 4.0 * 25.0 * math.sqrt(2 * 0.02 / 1.2)


def test_the_point_column_names_the_stretches(project):
    table = series()
    number = pd.Series(np.searchsorted(STATIONS, table["alpha_deg"] - 1e-9) + 1, dtype=object)
    number[~np.isin(table["alpha_deg"], STATIONS)] = ""
    project.add("series.csv", table.assign(point=number))
    found, _ = load(project)
    np.testing.assert_allclose(np.degrees(of_file(found, "series.csv").alpha), STATIONS, atol=1e-6)


def test_steps_of_load_alone_make_new_stretches():
    n = 600
    time = np.arange(2 * n) / RATE
    Fz = np.r_[np.full(n, 900.0), np.full(n, 1500.0)]
    still = np.zeros(2 * n)
    settings = SteadySettings(time, still, still, Fz, np.full(2 * n, 250e3), np.full(2 * n, V), still)
    found = [stretch for stretch in stretches(settings) if not stretch.dropped]
    assert len(found) == 2
    assert np.logical_or.reduce(list(moves(settings).values()))[n]
    assert found[0].end <= n <= found[1].begin


def test_a_sweep_that_never_rests_is_kept_for_the_diagnosis_only(project):
    up = series(np.array([-8.0, 8.0, -8.0]), hold=1.0, steering=2.0, noise=2.0)
    project.add("moving.csv", up)
    steady, warnings = load(project)
    assert "moving.csv" not in {steady.files[k] for k in np.unique(steady.file)}
    assert any("moving.csv" in w and "keeps moving" in w for w in warnings)
    everything, _ = load(project, continuous=True)
    part = of_file(everything, "moving.csv")
    assert np.all(part.continuous)
    assert np.all(np.diff(part.time) > 0.0)
    assert np.median(np.diff(part.time)) == pytest.approx(0.1, rel=0.01)


@pytest.mark.parametrize("rows", [[0], [3], [80], [157], [60, 61, 62, 63, 64, 65]])
def test_means_of_a_moving_sweep_can_be_left_out_alone(project, rows):
    """The wheel has rolled on through the lines that are left out: what follows them neither settles nor is too short.

    A turn of the wheel is no whole number of samples, and follows from the speeds of the whole sweep.
    """
    table = series(np.array([-8.0, 8.0, -8.0]), hold=1.0, steering=2.0, noise=2.0, rate=100.0)
    table["V_mps"] *= np.linspace(1.6, 2.4, len(table))
    project.add("moving.csv", table)
    config = configuration.load(project.write())
    own = of_file(points.read(config, continuous=True).points, "moving.csv")
    assert len(own) > 80
    rows = [row % len(own) for row in rows]
    lines = f"{own.line[rows[0]]}-{own.last_line[rows[-1]]}"
    out = FitTable(exclude=({"file": "moving.csv", "lines": lines, "why": "x"},))
    left = of_file(points.read(config.model_copy(update={"fit": out}), continuous=True).points, "moving.csv")
    for channel in ("line", "last_line", "alpha", "Fy"):
        np.testing.assert_array_equal(getattr(left, channel), np.delete(getattr(own, channel), rows))


def test_a_creeping_sweep_is_not_taken_for_a_plateau(project):
    """0.05 deg/s changes by less than a set-point's step within any second."""
    project.add("creep.csv", series(np.array([-6.0, 6.0]), hold=1.0, steering=0.05, noise=2.0))
    _, warnings = load(project)
    assert any("keeps moving" in w for w in warnings)


def test_a_recording_without_steady_stretches_is_refused_with_the_remedy(project):
    project.tables.clear()
    project.config["sweep"].clear()
    project.add("moving.csv", series(np.array([-8.0, 8.0]), hold=0.5))
    with pytest.raises(InputError, match="hold every set-point"):
        load(project)


def test_time_that_does_not_rise_is_refused_with_the_line(project):
    table = series()
    table.loc[7, "time_s"] = 0.0
    project.add("series.csv", table)
    with pytest.raises(InputError) as caught:
        load(project)
    assert (caught.value.line, caught.value.column) == (9, "time_s")


def test_every_run_of_a_series_has_its_own_clock(project):
    project.add("series.csv", pd.concat([series().assign(run="a"), series(seed=5).assign(run="b")]))
    found, _ = load(project)
    part = of_file(found, "series.csv")
    assert len(part) == 2 * len(STATIONS)
    assert {part.sweep_names[k] for k in part.sweep} == {"series:a", "series:b"}


@pytest.mark.parametrize("digits", [2, 1])
def test_a_rounded_time_gives_the_points_of_the_true_one(project, digits):
    """Recorders write 0.01 or 0.1 s: samples that share a time are spread evenly up to the next."""
    table = series(rate=250.0, hold=8.0) if digits == 2 else series()
    project.add("series.csv", table)
    true = of_file(load(project)[0], "series.csv")
    project.tables["series.csv"] = table.assign(time_s=np.floor(table["time_s"] * 10**digits) / 10**digits)
    found, warnings = load(project)
    part = of_file(found, "series.csv")
    assert any("samples have the time of the one before" in sentence for sentence in warnings)
    assert len(part) == len(true)
    np.testing.assert_allclose(part.Fy, true.Fy, atol=2.0)


def test_one_time_for_all_rows_is_told_from_rows_out_of_order(project):
    project.add("series.csv", series().assign(time_s=3.0))
    with pytest.raises(InputError, match="the same in all rows"):
        load(project)
