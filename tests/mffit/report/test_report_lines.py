"""The model's line passes through the model's readings at the points."""

from __future__ import annotations

import numpy as np
import pytest
from report_toys import TRUE, made_points, programme

import tir
from mffit.report.curves import curves, model_lines
from mffit.rig import Simulation


@pytest.fixture(scope="module")
def drawn():
    points = made_points(programme())
    tyre = tir.read(TRUE)
    found = curves(points)
    return (
        points,
        found,
        model_lines(Simulation.of(tyre), points, found),
        Simulation.of(tyre).readings(points),
    )


def test_line_meets_the_model_at_both_ends_of_every_curve(drawn):
    points, found, lines, model = drawn
    for curve in found:
        line, ends = lines[curve], curve.index[[0, -1]]
        assert line.x[[0, -1]] == pytest.approx(np.degrees(getattr(points, curve.over)[ends]))
        assert line.raw["Fy"][[0, -1]] == pytest.approx(model.Fy[ends])
        assert line.raw["Mz"][[0, -1]] == pytest.approx(model.Mz[ends])


def test_even_part_of_a_pure_sweep_is_the_mean_of_its_two_branches(drawn):
    _, found, lines, _ = drawn
    for curve in (c for c in found if c.held == 0.0):
        line = lines[curve]
        for name in ("Fy", "Mz"):
            assert line.even[name] == pytest.approx(0.5 * (line.raw[name] + line.raw[name][::-1]), abs=1e-9)


def test_no_curves_need_no_model(drawn):
    assert model_lines(None, drawn[0], []) == {}
