"""What a fit leaves of drawn readings, with known parts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_rigs import truth

from mffit.linearised import LinearisedChannel, LinearisedFit, Uncertain, linearised
from mffit.points import Points, make_points
from mffit.rig import Simulation
from mffit.scatter import rms

NOISE, OFFSET, MISSED = 5.0, 20.0, 60.0
RUNS, EACH = 24, 21
NUMBERS = (Uncertain("PDY1", 0.0, 0.1), Uncertain("PKY1", 0.0, 3.0))


def simulation() -> Simulation:
    return Simulation.of(truth(), turn_slip=False)


def bow(alpha: np.ndarray, load: np.ndarray) -> np.ndarray:
    """What the formula misses (n,) in the drawn readings, of unit size."""
    return np.asarray(np.sqrt(2.0) * np.sin(40.0 * alpha + load / 700.0))


def drawn(missed: float = MISSED, each: int = EACH) -> Points:
    """Sideslip sweeps at four loads and three cambers, twice each: the tyre, a smooth miss, an offset of every run, noise."""
    random = np.random.default_rng(8)
    loads = np.repeat(np.tile([800.0, 1200.0, 1600.0, 2200.0], 6), each)
    camber = np.repeat(np.repeat([-0.3, 0.0, 0.3], 8), each)
    alpha = np.tile(np.linspace(-0.12, 0.12, each), RUNS)
    sweep = np.repeat(np.arange(RUNS), each)
    points = make_points(
        alpha,
        camber,
        loads,
        p=250e3,
        V=10.0,
        phi_t=0.0,
        sweep=sweep,
        sweep_names=[f"r{k}" for k in range(RUNS)],
    )
    smooth = missed * bow(alpha, loads)
    scatter = OFFSET * random.standard_normal(RUNS)[sweep] + NOISE * random.standard_normal(len(alpha))
    return points.replace(Fy=simulation().readings(points)["Fy"] + smooth + scatter)


def left(points: Points, near: LinearisedFit | None = None) -> LinearisedChannel:
    sigma = {"Fy": np.full(len(points), NOISE)}
    return linearised(points, simulation(), sigma, NUMBERS, near=near).channels["Fy"]


@pytest.fixture(scope="module")
def found() -> LinearisedChannel:
    return left(drawn())


def test_each_part_is_found_in_its_size(found):
    assert found.size == pytest.approx(MISSED, rel=0.15)
    assert found.components.offset == pytest.approx(OFFSET, rel=0.35)
    assert found.noise == pytest.approx(NOISE, rel=0.15)


def test_scales_of_runs_do_not_describe_how_little_a_tyre_follows_a_wandering_load():
    """If all runs read less than the formula, and the model error makes up for it, only the wandering is left smaller.

    Also a search that begins with large scales finds none, as none are drawn, and the drawn model error.
    """
    steady = drawn(each=121)
    wander = 1.0 + 0.02 * np.random.default_rng(9).standard_normal(len(steady))
    points = steady.replace(Fz=steady.Fz * wander)
    first = left(points)
    begin = replace(first, components=replace(first.components, scale=0.03))
    found = left(points, LinearisedFit(NUMBERS, {"Fy": begin}))
    assert found.components.scale < 0.003  # a tenth of where it begins
    error = found.missed_at_readings - MISSED * bow(steady.alpha, steady.Fz)
    assert rms(error) < OFFSET  # which a few runs at a setting leave in their mean


def bend(points: Points) -> np.ndarray:
    """A force (n,) that no formula has, with two waves in the range of sideslip; it grows with the load, as noise does not."""
    fading = np.exp(-((points.alpha / 0.05) ** 2) - (points.kappa / 0.03) ** 2)
    return np.asarray(6.0 * MISSED * points.Fz / 2200.0 * np.sin(75.0 * points.alpha) * fading)


def test_the_estimate_lies_between_the_file_and_dense_readings():
    """Also in a test of many conditions: sweeps of sideslip and of slip at two pressures, which warm the tyre.

    The readings of each moving sweep lie closer than a tenth of a wave.
    """
    random, runs = np.random.default_rng(7), []
    swing = 0.2 * np.sin(np.linspace(0.0, 2.0 * np.pi, 120))
    for Fz in (1200.0, 2200.0):
        for p in (200e3, 250e3):
            runs += [(swing, 0.0, gamma, Fz, p) for gamma in (-0.07, 0.0, 0.07)]
            runs += [(alpha, swing, 0.0, Fz, p) for alpha in (-0.07, 0.0, 0.07)]
    alpha, kappa, gamma, Fz, p = (
        np.concatenate([np.broadcast_to(run[i], 120) for run in runs]) for i in range(5)
    )
    sweep = np.repeat(np.arange(len(runs)), 120)
    points = make_points(
        alpha,
        gamma,
        Fz,
        kappa=kappa,
        p=p,
        V=10.0,
        T=40.0 + 10.0 * np.tile(np.linspace(0.0, 1.0, 120), len(runs)) + random.normal(0.0, 1.0, len(sweep)),
        phi_t=0.0,
        sweep=sweep,
        sweep_names=[f"r{k}" for k in range(len(runs))],
    )
    true = bend(points)
    read = simulation().readings(points)["Fy"] + true + NOISE * random.standard_normal(len(sweep))
    channel = left(points.replace(Fy=read))
    rows = np.flatnonzero(np.abs(true) > 3.0 * NOISE)
    share = channel.missed_at_readings[rows] / true[rows]
    assert len(rows) > 300
    assert np.percentile(share, 5.0) > 0.5
    assert np.percentile(share, 95.0) < 1.5
    assert channel.noise == pytest.approx(NOISE, rel=0.2)


def test_where_the_tyre_is_of_the_formula_nothing_is_missed():
    none = left(drawn(missed=0.0))
    assert none.size < 0.3 * NOISE
    assert none.components.offset == pytest.approx(OFFSET, rel=0.35)
    assert none.noise == pytest.approx(NOISE, rel=0.15)


def test_left_out_runs_lie_as_far_off_as_stated(found):
    runs = found.model.left_out(found.variances, found.model.groups)
    assert len(runs) == RUNS
    squares = [one.chi2(one.error) / EACH for one in runs]
    assert np.mean(squares) == pytest.approx(1.0, abs=0.2)
    usual = np.sqrt(np.mean([np.mean((found.unit[one.rows] * one.error) ** 2) for one in runs]))
    assert usual == pytest.approx(np.hypot(OFFSET, NOISE), rel=0.35)


def test_a_similar_fit_may_reject_every_reading_in_which_a_condition_varies():
    """The search then starts anew, and finds the noise of what is left."""
    points = drawn()
    upright = {"Fy": np.where(points.gamma == 0.0, NOISE, np.nan)}
    near = linearised(points, simulation(), {"Fy": np.full(len(points), NOISE)}, NUMBERS)
    again = linearised(points, simulation(), upright, NUMBERS, near=near).channels["Fy"]
    assert [one.name for one in again.smooth.inputs] == ["alpha", "Fz"]
    assert again.noise == pytest.approx(NOISE, rel=0.2)


def test_a_wheel_that_rolls_backwards_misses_what_one_turned_on_its_rim_misses_forwards():
    """Half a turn of the axes makes one of the other: camber and side force are reversed."""
    ahead = drawn()
    turned = np.where(ahead.sweep % 5 == 0, -1, 1)
    ahead = ahead.replace(mount=turned)
    behind = ahead.replace(mount=1, direction=turned, gamma=turned * ahead.gamma, Fy=turned * ahead.Fy)
    one, other = left(ahead), left(behind)
    assert one.size > 0.8 * MISSED
    assert other.missed_at_readings == pytest.approx(turned * one.missed_at_readings, abs=0.01 * MISSED)


def test_a_noise_beyond_the_stated_one_is_proven(found):
    assert found.proof_of_noise < 3.0
    points = drawn()
    half = linearised(points, simulation(), {"Fy": np.full(len(points), 0.5 * NOISE)}, NUMBERS).channels["Fy"]
    assert half.components.noise == pytest.approx(2.0, rel=0.15)
    alone = len(points) * (0.5 * (2.0**2 - 1.0) - np.log(2.0))  # if nothing else could explain it
    assert 0.3 * alone < half.proof_of_noise < alone


@pytest.mark.parametrize(("common", "least", "most"), [(True, -1e3, 3.0), (False, 100.0, 1e3)])
def test_what_all_sweeps_have_in_common_at_close_settings_is_no_noise(common, least, most):
    """A miss from setting to setting is model error if all runs have it; as noise it has another sign in each run."""
    points = drawn(missed=0.0)
    random = np.random.default_rng(5)
    sign = np.ones(RUNS) if common else random.choice([-1.0, 1.0], RUNS)
    wave = 2.0 * NOISE * np.tile((-1.0) ** np.arange(EACH), RUNS)
    channel = left(points.replace(Fy=points.Fy + sign[points.sweep] * wave))
    assert (channel.components.noise > 1.8) is not common
    assert least < channel.proof_of_noise < most


def test_a_constant_alone_proves_no_model_error_whatever_the_noise_of_each_reading():
    points = drawn(missed=0.0)
    noise = np.where(np.arange(len(points)) % 3, NOISE, 3.0 * NOISE)
    shifted = points.replace(Fy=points.Fy + 20.0 * OFFSET, u_Fy=noise)
    channel = linearised(shifted, simulation(), {"Fy": noise}, NUMBERS).channels["Fy"]
    assert channel.size == pytest.approx(20.0 * OFFSET, rel=0.05)
    assert not channel.is_proven


def test_a_single_reading_shows_a_constant_at_most():
    one = drawn().select(np.array([10]))
    channel = left(one)
    assert channel.size <= np.abs(one.Fy - simulation().readings(one).Fy)[0]
    assert channel.smooth.inputs == ()
    assert np.all(np.isfinite(channel.posterior.root))


def zero_of_Fy(points: Points, fitted: float) -> tuple[float, float]:
    """The zero of Fy beside the miss, where a fit has some value [N] and 10 N were declared, and its uncertainty."""
    numbers = (*NUMBERS, Uncertain("F0_N", -fitted, 10.0))
    rig = simulation().with_numbers({"F0_N": fitted})
    change, u = linearised(points, rig, {"Fy": np.full(len(points), NOISE)}, numbers).zeros["F0_N"]
    return fitted + change, u


@pytest.mark.parametrize("fitted", [0.0, 30.0])
def test_a_zero_takes_up_no_constant_that_the_formula_may_miss(fitted):
    """35 N at all readings are a third of the miss and three and a half declared uncertainties: they are the miss."""
    points = drawn()
    zero, u = zero_of_Fy(points.replace(Fy=points.Fy + 35.0), fitted)
    assert abs(zero) < 15.0
    assert 5.0 < u <= 10.0


def test_a_zero_is_found_where_the_tyre_is_of_the_formula():
    """To the mean of the offsets that the 24 runs have of their own."""
    points = drawn(missed=0.0)
    zero, u = zero_of_Fy(points.replace(Fy=points.Fy + 15.0), 0.0)
    assert u == pytest.approx(OFFSET / np.sqrt(RUNS), rel=0.4)
    assert zero == pytest.approx(15.0, abs=3.0 * u)


def test_a_miss_that_changes_from_setting_to_setting_has_no_shorter_length_than_their_distance():
    """Loads 800 to 2200 N in three steps, alternately 180 N too high and too low; sideslip is swept over 0.24 rad.

    It is so large that offsets of the runs, of which all those at one load would be alike, are no explanation.
    """
    points = drawn(missed=0.0)
    signs = np.where(np.isin(points.Fz, (800.0, 1600.0)), 1.0, -1.0)
    found = left(points.replace(Fy=points.Fy + 3.0 * MISSED * signs))
    lengths = dict(zip((one.name for one in found.smooth.inputs), found.components.lengths, strict=True))
    assert lengths["Fz"] == pytest.approx(1400.0 / 3.0, rel=1e-6)
    assert lengths["alpha"] > 0.24 / 12.0


@pytest.mark.parametrize("at_largest", [1.0, 0.0, -1.0])
def test_a_run_at_a_load_of_its_own_may_miss_otherwise_than_the_others(at_largest):
    """Three smaller loads miss alike; they cannot tell what is missed at another one, which may be the reverse."""
    points = drawn(missed=0.0)
    largest = points.Fz > 2000.0
    shape = MISSED * np.sqrt(2.0) * np.sin(40.0 * points.alpha) * np.where(largest, at_largest, 1.0)
    one = points.sweep == points.sweep[largest][0]
    points = points.replace(Fy=points.Fy + shape).select(np.flatnonzero(~largest | one))
    rows = np.flatnonzero(points.Fz > 2000.0)
    sigma = {"Fy": np.full(len(points), NOISE)}
    channel = linearised(points, simulation(), sigma, NUMBERS, without=rows).channels["Fy"]
    (found,) = channel.by_others(np.flatnonzero(np.isin(channel.rows, rows)))
    assert found.error @ np.linalg.solve(found.covariance, found.error) / EACH < 2.5
    assert np.sqrt(np.mean(np.diag(found.covariance))) > MISSED


def test_the_hysteresis_of_slip_is_not_taken_for_an_effect_of_temperature():
    """Each run warms by 4 K on its way there and back, and begins at a temperature of its own."""
    random = np.random.default_rng(3)
    way = np.r_[np.linspace(-0.12, 0.12, 12), np.linspace(0.12, -0.12, 12)]
    n = len(way) * RUNS
    T = (
        50.0
        + np.repeat(12.0 * random.random(RUNS), len(way))
        + np.tile(np.linspace(0.0, 4.0, len(way)), RUNS)
    )
    points = make_points(
        np.zeros(n),
        0.0,
        np.repeat(np.tile([800.0, 1200.0, 1600.0, 2200.0], 6), len(way)),
        kappa=np.tile(way, RUNS),
        T=T,
        phi_t=0.0,
        p=250e3,
        V=10.0,
        sweep=np.repeat(np.arange(RUNS), len(way)),
        sweep_names=[f"r{k}" for k in range(RUNS)],
    )
    half = np.tile(np.repeat([1.0, -1.0], 12), RUNS) * 30.0 * np.cos(points.kappa / 0.12)
    points = points.replace(
        Fx=simulation().readings(points, ["Fx"])["Fx"] + half + NOISE * random.standard_normal(n)
    )
    sigma = {"Fx": np.full(n, NOISE)}
    found = linearised(points, simulation(), sigma, (Uncertain("PDX1", 0.0, 0.1),)).channels["Fx"]
    assert next(iter(found.missed_over)) == "sense"
    assert found.missed_over["T"] < 5.0
    assert found.missed_at_readings == pytest.approx(half, abs=3.0 * NOISE)
