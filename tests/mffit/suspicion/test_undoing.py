"""A known mistake explains a sweep if, undone, it leaves little of every error and makes no new one."""

from __future__ import annotations

from mffit.points import Points, make_points
from mffit.suspicion.rereadings import MISTAKES, Away, Mistake, explaining

REVERSED, OTHER = MISTAKES[0], MISTAKES[1]
TOLERATED = {"Fy": 0.1, "Mz": 0.1}


def sweep(number: int) -> Points:
    return make_points(0.0, 0.0, 1000.0, p=2e5, V=10.0, phi_t=0.0, line=number)


def found(after: dict[Mistake, dict[str, Away]], gross: dict[str, float]):
    candidates = [(mistake, sweep(k)) for k, mistake in enumerate(after)]
    states = list(after.values())
    return explaining(candidates, gross, lambda points: states[int(points.line[0])], TOLERATED)


def test_the_mistake_that_leaves_least_is_found():
    after = {REVERSED: {"Fy": Away(30.0, 0.05)}, OTHER: {"Fy": Away(10.0, 0.02)}}
    best = found(after, {"Fy": 100.0})
    assert (best.mistake, best.left) == (OTHER, 0.02)


def test_a_mistake_that_leaves_more_than_a_third_explains_nothing():
    assert found({REVERSED: {"Fy": Away(34.0, 0.05)}}, {"Fy": 100.0}) is None
    assert found({REVERSED: {"Fy": Away(33.0, 0.05)}}, {"Fy": 100.0}).mistake is REVERSED


def test_a_mistake_that_spoils_another_channel_explains_nothing():
    after = {REVERSED: {"Fy": Away(1.0, 0.01), "Mz": Away(1.0, 0.3)}}
    assert found(after, {"Fy": 100.0}) is None


def test_a_mistake_that_leaves_an_error_as_large_as_the_readings_explains_nothing():
    assert found({REVERSED: {"Fy": Away(1.0, 0.01, matched=False)}}, {"Fy": 100.0}) is None


def test_every_error_of_the_sweep_must_be_explained():
    after = {REVERSED: {"Fy": Away(1.0, 0.01), "Mz": Away(9.0, 0.09)}}
    assert found(after, {"Fy": 100.0, "Mz": 10.0}) is None
