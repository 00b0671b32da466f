"""Pictures of a fleet name the tyres where the names fit side by side."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from mffit.report.fleet import epsilon_of_all, numbers_of_all
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
    )
    panel = picture(found).rows[0][0]
    assert list(panel.x.words.values()) == written
