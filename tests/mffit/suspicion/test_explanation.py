"""A doubtful sweep looks like the one number that is off, with its size and sign as the rig would show it."""

from __future__ import annotations

import numpy as np
import pytest

import tir
from mffit.linearised.mixed import LeftOutReadings
from mffit.points import make_points
from mffit.rig import Simulation
from mffit.suspicion.rereadings import explanation

ISO = dict.fromkeys(("alpha", "gamma", "Fz", "Fy", "Mz"), 1.0)
SAE = ISO | {"alpha": -1.0, "Fy": -1.0, "gamma": -1.0, "Mz": -1.0}


@pytest.fixture(scope="module")
def simulation():
    return Simulation.of(tir.read("samples/front-120-70/true.tir"))


@pytest.fixture(scope="module")
def sweep():
    """Sideslip at two cambers."""
    alpha, gamma = np.meshgrid(
        np.radians([-7.0, -4.0, -2.0, -1.0, 0.5, 1.5, 3.0, 6.0]), np.radians([2.0, 25.0])
    )
    return make_points(alpha.ravel(), gamma.ravel(), 1400.0, p=250e3, V=6.0, phi_t=0.0)


def off(error, variance) -> LeftOutReadings:
    """Readings that are off their prediction, each with its own scatter."""
    return LeftOutReadings(np.arange(len(error)), error, np.diag(np.broadcast_to(variance, len(error))))


def said(simulation, points, Fy, Mz, signs=ISO) -> str:
    """What explains the readings of a sweep, beside the simulation of its labels."""
    out = simulation.readings(points)
    errors = {
        "Fy": off(Fy - out.Fy, 36.0),
        "Mz": off(Mz - out.Mz, 0.36),
    }
    return explanation(points.replace(Fy=Fy, Mz=Mz), errors, simulation, signs)


def run_at(simulation, points, **true):
    """The readings of points that were run at other settings than their labels say."""
    out = simulation.readings(points.replace(**true))
    return out.Fy, out.Mz


@pytest.mark.parametrize("signs", [ISO, SAE], ids=["iso", "sae"])
@pytest.mark.parametrize(
    ("change", "number", "words", "turns"),
    [
        (lambda p, r: (r.Fy + 40.0, r.Mz), 40.0, "a zero offset of {} N in Fy_N", True),
        (lambda p, r: (r.Fy, r.Mz - 3.0), -3.0, "a zero offset of {} Nm in Mz_Nm", True),
        (lambda p, r: (1.12 * r.Fy, r.Mz), 1.12, "a gain of {} in Fy_N", False),
        (lambda p, r: (r.Fy, 0.8 * r.Mz), 0.8, "a gain of {} in Mz_Nm", False),
    ],
)
def test_an_error_of_a_channel_is_named_with_its_size(simulation, sweep, change, number, words, turns, signs):
    found = said(simulation, sweep, *change(sweep, simulation.readings(sweep)), signs)
    beginning, _, end = words.partition("{}")
    assert found.startswith(beginning)
    assert found.endswith(end)
    stated = signs["Fy"] * number if turns else number
    assert float(found.removeprefix(beginning).removesuffix(end)) == pytest.approx(
        stated, abs=5e-3 * abs(stated)
    )


@pytest.mark.parametrize("signs", [ISO, SAE], ids=["iso", "sae"])
@pytest.mark.parametrize(
    ("true", "words", "turns"),
    [
        (lambda p: {"alpha": p.alpha + np.radians(0.2)}, "a sideslip axis that is {} deg out|0.2", True),
        (lambda p: {"gamma": p.gamma - np.radians(1.0)}, "a camber axis that is {} deg out|-1", True),
        (lambda p: {"Fz": 1.05 * p.Fz}, "a load that was {} % off|5", False),
        (lambda p: {"p": 0.9 * p.p}, "a pressure that was {} % off|-10", False),
    ],
)
def test_a_setting_that_was_off_is_named_with_its_size(simulation, sweep, true, words, turns, signs):
    words, _, number = words.partition("|")
    found = said(simulation, sweep, *run_at(simulation, sweep, **true(sweep)), signs)
    stated = float(number) * (signs["alpha"] if turns else 1.0)
    beginning, _, end = words.partition("{}")
    assert found.startswith(beginning)
    assert found.endswith(end)
    # To first order: the curves bend within the change.
    assert float(found.removeprefix(beginning).removesuffix(end)) == pytest.approx(stated, rel=0.15)


def test_a_known_mistake_is_named_where_it_explains_more_than_one_number(simulation, sweep):
    out = simulation.readings(sweep)
    assert said(simulation, sweep, out.Fy, -out.Mz) == "its moment reversed"
    mirrored = sweep.replace(alpha=-sweep.alpha)
    assert (
        said(simulation, sweep, *run_at(simulation, sweep, alpha=mirrored.alpha)) == "its sideslip reversed"
    )


def test_another_unit_is_named_only_if_the_readings_in_it_agree_in_size(simulation, sweep):
    """A model that other wrong sweeps drew towards zero is near any moment over 1000."""
    out = simulation.readings(sweep)
    assert said(simulation, sweep, out.Fy, -2.5 * out.Mz) == "its moment reversed"


def test_two_thirds_of_the_error_must_be_explained(simulation, sweep):
    """An offset, beside an error that alternates from point to point and is like nothing known."""
    out = simulation.readings(sweep)
    noise = np.tile([1.0, -1.0, -1.0, 1.0], 4)
    for share, explained in ((0.69, True), (0.64, False)):
        Fy = out.Fy + 30.0 * (np.sqrt(share) + np.sqrt(1.0 - share) * noise)
        assert bool(said(simulation, sweep, Fy, out.Mz)) == explained


def test_a_channel_that_was_not_measured_is_left_out(simulation, sweep):
    out = simulation.readings(sweep)
    errors = {"Fy": off(np.full(16, 40.0), 36.0)}
    points = sweep.replace(Fy=out.Fy + 40.0)
    assert explanation(points, errors, simulation, ISO) == "a zero offset of +40.0 N in Fy_N"
    some = points.replace(Fy=np.where(np.arange(16) == 3, np.nan, points.Fy))
    errors = {"Fy": off(np.full(15, 40.0), 36.0)}
    assert explanation(some, errors, simulation, ISO) == "a zero offset of +40.0 N in Fy_N"


def test_the_scatter_of_every_point_counts(simulation, sweep):
    """A point of large uncertainty may be anywhere."""
    out = simulation.readings(sweep)
    error = np.where(np.arange(16) == 5, -500.0, 40.0)
    errors = {"Fy": off(error, np.where(np.arange(16) == 5, 1e8, 36.0))}
    assert (
        explanation(sweep.replace(Fy=out.Fy), errors, simulation, ISO) == "a zero offset of +40.0 N in Fy_N"
    )


def first_order(simulation, points, name, step, size):
    """Readings that change with a setting as their slope at the labels says, by ``size`` of its unit."""
    here, there = simulation.readings(points), simulation.readings(points.replace(**{name: step(points)}))
    return [getattr(here, c) + size * (getattr(there, c) - getattr(here, c)) for c in ("Fy", "Mz")]


def test_what_no_rig_can_have_is_no_suggestion(simulation, sweep):
    """A gain below zero, a load that was -226 % off, an axis that is 9 deg out: the formula of each fits exactly."""
    out = simulation.readings(sweep)
    assert said(simulation, sweep, -1.3 * out.Fy, out.Mz) == "its side force reversed"
    load = first_order(simulation, sweep, "Fz", lambda p: 1.0001 * p.Fz, -22600.0)
    assert "load" not in said(simulation, sweep, *load)
    axis = first_order(simulation, sweep, "alpha", lambda p: p.alpha + np.radians(0.001), 9000.0)
    assert "axis" not in said(simulation, sweep, *axis)
    sound = first_order(simulation, sweep, "Fz", lambda p: 1.0001 * p.Fz, -4000.0)
    assert said(simulation, sweep, *sound).startswith("a load that was -40")
