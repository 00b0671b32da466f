"""Named numbers against explicit normal distributions, and their uncertainty against campaigns that are run again."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from mffit.fit.told import Told, numbers_told
from mffit.numbers import Numbers, from_json, to_json

NAMES = ("PKY1", "PDY1", "F0_N", "PECP1")
SPREAD = np.array([3.0, math.inf, 5.0, 0.2])


def drawn(seed: int, held: frozenset[str] = frozenset()) -> tuple[Numbers, np.ndarray]:
    """Numbers of twelve linear readings, and the slopes of these."""
    random = np.random.default_rng(seed)
    slopes = random.standard_normal((12, len(NAMES))) * [1.0, 2.0, 0.3, 4.0]
    values = random.standard_normal(len(NAMES))
    zero = np.zeros(len(NAMES))
    return Numbers(NAMES, values, slopes.T @ slopes, zero, values, SPREAD, held), slopes


@pytest.mark.parametrize("seed", range(3))
def test_an_error_of_a_held_number_moves_the_others_as_a_new_fit_would(seed):
    """The best values of the free numbers with the held one off by its uncertainty, by least squares."""
    numbers, slopes = drawn(seed, frozenset(["PECP1"]))
    free, u = [0, 1, 2], SPREAD[3]
    prior = np.diag(SPREAD[free] ** -2.0)
    moved = np.linalg.solve(
        slopes[:, free].T @ slopes[:, free] + prior, slopes[:, free].T @ (slopes[:, 3] * -u)
    )
    own = np.linalg.inv(slopes[:, free].T @ slopes[:, free] + prior)
    assert numbers.covariance[np.ix_(free, free)] == pytest.approx(own + np.outer(moved, moved))
    assert numbers.covariance[free, 3] == pytest.approx(moved * u)
    assert numbers.stderr["PECP1"] == pytest.approx(u)
    assert numbers.moved_by()["PECP1"] == pytest.approx([*moved, u])


def test_a_prior_mean_moves_the_values_as_a_new_fit_would():
    numbers, slopes = drawn(4)
    information = slopes.T @ slopes + np.diag(SPREAD**-2.0)
    for name, i in (("PKY1", 0), ("F0_N", 2)):
        pull = np.zeros(4)
        pull[i] = SPREAD[i] ** -2.0 * SPREAD[i]
        assert numbers.moved_by()[name] == pytest.approx(np.linalg.solve(information, pull))
    assert "PDY1" not in numbers.moved_by()  # it has no prior


def test_known_and_unasked_numbers_condition_and_marginalise():
    numbers, _ = drawn(5)
    whole = numbers.covariance
    assert numbers.root @ numbers.root.T == pytest.approx(whole)
    kept, out = [0, 1, 3], 2
    assert numbers.without(["F0_N"]).covariance == pytest.approx(whole[np.ix_(kept, kept)])
    across = np.outer(whole[kept, out], whole[out, kept]) / whole[out, out]
    assert numbers.given(["F0_N"]).covariance == pytest.approx(whole[np.ix_(kept, kept)] - across)


def test_quantities_are_as_uncertain_as_draws_of_the_numbers():
    numbers, _ = drawn(6)
    slopes = np.array([[1.0, -2.0], [0.5, 3.0]])
    draws = np.random.default_rng(1).multivariate_normal(np.zeros(4), numbers.covariance, 300_000)[:, [1, 3]]
    assert numbers.spread_of(slopes, ("PDY1", "PECP1")) == pytest.approx(
        np.std(draws @ slopes.T, axis=0), rel=0.01
    )
    assert numbers.spread_of(slopes[:, :1], ("RCX1",)) == pytest.approx([0.0, 0.0])  # exactly known


def test_information_is_read_back_as_it_was():
    numbers = drawn(7, frozenset(["PECP1"]))[0]
    again = from_json(json.loads(json.dumps(to_json(numbers))))
    assert (again.names, again.held) == (numbers.names, numbers.held)
    assert np.array_equal(again.covariance, numbers.covariance)


SWEEPS, READINGS, NOISE, OFFSET, BEND = 14, 25, 0.3, 0.2, 2.0


def campaign(random: np.random.Generator, *, bend: float) -> tuple[np.ndarray, list[Told]]:
    """A line fitted to a parabola over sweeps of drawn ranges with offsets of their own; what every sweep tells.

    The weights of the fit are those of the noise.
    """
    ends = random.uniform(-1.0, 1.0, (SWEEPS, 2))
    sweeps = [np.linspace(low, high, READINGS) for low, high in ends]
    columns = [np.column_stack([np.ones(READINGS), x]) / NOISE for x in sweeps]
    tyre = [1.0 + 2.0 * x + bend * x**2 for x in sweeps]
    read = [y + OFFSET * random.standard_normal() + NOISE * random.standard_normal(READINGS) for y in tyre]
    fitted, *_ = np.linalg.lstsq(np.concatenate(columns), np.concatenate(read) / NOISE, rcond=None)
    told = []
    for x, y, data in zip(columns, tyre, read, strict=True):
        own = x.T @ np.full(READINGS, OFFSET / NOISE)
        missed, residual = y / NOISE - x @ fitted, data / NOISE - x @ fitted
        told.append(Told(x.T @ x, x.T @ x + np.outer(own, own), x.T @ missed, x.T @ residual))
    return fitted, told


@pytest.mark.parametrize("bend", [0.0, BEND])
def test_numbers_are_as_uncertain_as_campaigns_differ(bend):
    """400 campaigns: the scatter of their estimates is what each of them states, with and without what the line misses."""
    random = np.random.default_rng(8)
    found, stated = [], []
    for _ in range(400):
        fitted, told = campaign(random, bend=bend)
        priors = Numbers.beforehand(("a", "b"), fitted, fitted, np.full(2, math.inf), frozenset())
        found.append(fitted)
        stated.append(np.diag(numbers_told(told, priors).covariance))
    ratio = np.sqrt(np.median(stated, axis=0)) / np.std(found, axis=0)
    assert np.all((ratio > 0.85) & (ratio < 1.3)), ratio
    fitted, told = campaign(np.random.default_rng(9), bend=bend)
    priors = Numbers.beforehand(("a", "b"), fitted, fitted, np.full(2, math.inf), frozenset())
    plain = numbers_told([missing_nothing(one) for one in told], priors)
    if bend:  # noise and offsets alone state far too little
        assert numbers_told(told, priors).stderr["b"] > 1.5 * plain.stderr["b"]


def missing_nothing(one: Told) -> Told:
    """A sweep of a line that misses nothing."""
    return one._replace(missed=np.zeros_like(one.missed))


def test_readings_that_tell_less_than_a_prior_leave_it():
    """Scatter of a score that exceeds its information by far: the number keeps its prior, and no more than that."""
    told = [Told(np.eye(1), 100.0 * np.eye(1), np.zeros(1), np.zeros(1))]
    priors = Numbers.beforehand(("a",), np.zeros(1), np.zeros(1), np.array([2.0]), frozenset())
    assert numbers_told(told, priors).stderr["a"] == pytest.approx(2.0)


@pytest.mark.parametrize("scatter", [1.0, 4.0])
def test_the_score_of_a_held_number_says_what_the_readings_would_make_of_it(scatter):
    """A joint estimate frees it: without a prior it goes to the solution of least squares, however much the readings scatter."""
    random = np.random.default_rng(2)
    slopes, truth = random.standard_normal((40, 2)), np.array([1.5, -0.4])
    read = slopes @ truth
    at = np.array(
        [float(slopes[:, 0] @ read / (slopes[:, 0] @ slopes[:, 0])), 0.0]
    )  # the second is held at 0
    whole = slopes.T @ slopes
    told = [Told(whole, scatter * whole, np.zeros(2), slopes.T @ (read - slopes @ at))]
    priors = Numbers.beforehand(("a", "b"), at, at, np.array([math.inf, 0.1]), frozenset(["b"]))
    numbers = numbers_told(told, priors)
    freed = replace(numbers, held=frozenset(), spread=np.full(2, math.inf))
    best = freed.values + np.linalg.solve(freed.information, freed.score)
    assert best == pytest.approx(truth, rel=1e-6)


def test_an_error_of_a_held_number_moves_the_others_as_the_weights_of_the_fit_do():
    """The weights of a fit are those of independent noise, whatever scatter its readings turn out to have."""
    random = np.random.default_rng(3)
    sweeps = [random.standard_normal((12, 3)) for _ in range(6)]
    told = []
    for slopes in sweeps:
        own = slopes.sum(axis=0)  # of an offset of the run
        missed = slopes.T @ random.standard_normal(12)
        told.append(Told(slopes.T @ slopes, slopes.T @ slopes + 9.0 * np.outer(own, own), missed, missed))
    priors = Numbers.beforehand(
        ("a", "b", "held"), np.zeros(3), np.zeros(3), np.array([math.inf, math.inf, 0.1]), frozenset(["held"])
    )
    slopes = np.concatenate(sweeps)
    refitted, *_ = np.linalg.lstsq(
        slopes[:, :2], -0.1 * slopes[:, 2], rcond=None
    )  # the held number is off by 0.1
    moved = numbers_told(told, priors).moved_by()["held"]
    assert moved == pytest.approx([*refitted, 0.1])
