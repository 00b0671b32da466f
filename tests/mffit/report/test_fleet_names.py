"""The picture of a fleet, and its first sentence."""

from __future__ import annotations

import math
from types import SimpleNamespace

import pytest

from mffit.fleet import Fleet, Row
from mffit.fleet.record import scatter_of
from mffit.quantities import COMPARED
from mffit.report.fleet import headline, numbers_of_all
from tir import Quantity


def test_every_number_has_a_panel_with_a_line_for_each_tyre():
    """A forest plot: named tyres from top to bottom, and no empty panel for what no tyre has."""
    names = [f"motorcycle-190-55-{k}" for k in range(4)]
    numbers = {"file": [Quantity(0.1, 0.05, "-"), None, None, None]} | {
        key: [Quantity(1.0 + k, 0.1, "-") for k in range(4)] for key in list(COMPARED)[:2]
    }
    found = SimpleNamespace(
        rows=[SimpleNamespace(specimen=SimpleNamespace(name=name)) for name in names],
        numbers=lambda key: numbers.get(key, [None] * 4),
        estimates={"file": "as its file carries it"},
    )
    epsilon, *others = numbers_of_all(found).panels
    assert all(list(panel.y.words.values()) == names for panel in (epsilon, *others))
    assert len(others) == 2
    assert epsilon.series[0].x.tolist() == [0.1]
    assert others[0].series[0].half_x.tolist() == [0.1] * 4
    found.estimates = {}
    assert len(numbers_of_all(found).panels) == 2


def test_two_builds_that_chance_sets_apart_do_not_differ():
    """Their distance over its uncertainty is 1.6: such and more has a chance of 11 %."""
    u = 1.0
    near = scatter_of([Quantity(0.0, u, "-"), Quantity(1.6 * math.sqrt(2.0) * u, u, "-")])
    assert near.chance == pytest.approx(0.11, abs=0.005)
    assert near.sd > near.u
    assert not near.differ
    assert scatter_of([Quantity(0.0, u, "-"), Quantity(4.0 * math.sqrt(2.0) * u, u, "-")]).differ


def test_the_page_says_first_in_which_numbers_the_tyres_differ():
    numbers = [
        {"C_alpha_N_per_rad": Quantity(20e3 + 1e3 * k, 100.0, "N/rad"), "mu_y": Quantity(1.1 + 0.01 * k, 0.05, "-")}
        for k in range(3)
    ]  # fmt: skip
    sizes = ("A", "A", "B")
    rows = [
        Row(SimpleNamespace(epsilon_gamma=None, epsilon_direct=None, size="", conditions=(1.0, 1.0)), 0, one)
        for one in numbers
    ]
    assert headline(Fleet(tuple(rows), (), ())) == (
        "The tyres differ by more than their uncertainty in cornering stiffness; they agree within their uncertainty in peak "
        "side force per load of the lesser side."
    )
    assert headline(Fleet((rows[0],), (), ())) == "No number is known of two tyres."
    for row, size in zip(rows, sizes, strict=True):
        row.specimen.size = size
    assert headline(Fleet(tuple(rows), (), ())) == (
        "Tyres of 2 kinds (size, nominal load or pressure) are compared within a kind: they differ by more than their "
        "uncertainty in cornering stiffness; they agree within their uncertainty in peak side force per load of the lesser side."
    )
    assert headline(Fleet(tuple(rows[1:]), (), ())).startswith("No two tyres are of one kind")
