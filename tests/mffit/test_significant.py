"""Size and scatter of numbers."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import false_discovery_control, norm

from mffit.constants import PREDICTION_FALSE_ALARM
from mffit.scatter import significant


@pytest.mark.parametrize("shift", [0.0, 3.0, 40.0])
def test_differences_are_significant_at_the_rate_of_false_discoveries(shift):
    """As scipy adjusts the probabilities of chance."""
    z = np.random.default_rng(4).normal(size=300) + shift * (np.arange(300) < 40)
    chance = np.clip(2.0 * norm.sf(np.abs(z)), 1e-300, 1.0)
    assert np.array_equal(significant(z), false_discovery_control(chance) < PREDICTION_FALSE_ALARM)


def test_nothing_is_significant_without_differences():
    assert significant(np.zeros(0)).shape == (0,)
