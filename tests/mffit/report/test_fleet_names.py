"""Pictures of a fleet name the tyres where the names fit side by side."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from mffit.fleet import Fleet, Row
from mffit.report.fleet import epsilon_of_all, headline, numbers_of_all
from tir import Quantity

LONG = [f"motorcycle-190-55-{k}" for k in range(4)]


@pytest.mark.parametrize(
    ("picture", "names", "written"),
    [
        (epsilon_of_all, LONG, LONG),
        (numbers_of_all, LONG, ["1", "2", "3", "4"]),
        (numbers_of_all, ["front", "rear"], ["front", "rear"]),
    ],
)
def test_tyres_are_named_if_the_names_fit(picture, names, written):
    found = SimpleNamespace(
        rows=[SimpleNamespace(specimen=SimpleNamespace(name=name)) for name in names],
        numbers=lambda key: [Quantity(1.0, 0.1, "-")] * len(names),
        estimates={"file": "as its file carries it"},
    )
    panel = picture(found).rows[0][0]
    assert list(panel.x.words.values()) == written


def test_the_page_says_first_in_which_numbers_the_tyres_differ():
    numbers = [
        {"C_alpha_N_per_rad": Quantity(20e3 + 1e3 * k, 100.0, "N/rad"), "mu_y": Quantity(1.1 + 0.01 * k, 0.05, "-")}
        for k in range(3)
    ]  # fmt: skip
    rows = [Row(SimpleNamespace(epsilon_gamma=None, epsilon_direct=None), 0, one) for one in numbers]
    assert headline(Fleet(tuple(rows), (), ())) == (
        "The tyres scatter by more than their uncertainty in cornering stiffness; they agree within their uncertainty in peak "
        "side force per load."
    )
    assert headline(Fleet((rows[0],), (), ())) == "No number is known of two tyres."
