"""How well a model agrees with its points, by formulae of another kind."""

from __future__ import annotations

import numpy as np
import pytest
from small_rigs import LEAN, LOADS, SLIP, disc, simulated, truth

from mffit import config as configuration
from mffit.fit.agreement import agreement, with_odd_part
from mffit.parts import split
from mffit.points import read


def test_a_regression_line_explains_the_square_of_the_correlation():
    random = np.random.default_rng(2)
    x = random.uniform(-3.0, 5.0, 60)
    y = 40.0 * x + 50.0 * random.standard_normal(60)
    found = agreement(np.polyval(np.polyfit(x, y, 1), x), y)
    assert found.r2 == pytest.approx(np.corrcoef(x, y)[0, 1] ** 2)
    assert found.rmse == pytest.approx(np.std(y) * np.sqrt(1.0 - found.r2))
    assert found.nrmse == pytest.approx(found.rmse / (y.max() - y.min()))


def test_only_points_with_a_reading_and_a_model_count():
    found = agreement(np.array([1.0, 2.0, np.nan, 5.0]), np.array([1.0, 4.0, 3.0, np.nan]))
    assert (found.n, found.max_abs) == (2, 2.0)
    assert np.isnan(agreement(np.zeros(3), np.ones(3)).r2)  # nothing varies, so nothing can be explained


def test_the_odd_part_is_compared_where_the_wheel_rolls_forwards(tmp_path):
    """Rolling backwards, the slip part of Fy has the other sign, and a file for turn slip off does not know it."""
    simulated(disc(), tmp_path)
    points = read(configuration.load(tmp_path / "tyre.toml")).points
    found = with_odd_part(truth().values, points, split(points))
    forwards = len(LOADS) * (len(SLIP) + len(LEAN) + 3) + 14  # zeros, and the coupled sweep
    assert (found["Fy"].n, found["Mz"].n) == (forwards, forwards)
    assert found["Fy"].r2 > 0.95
