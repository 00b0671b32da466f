"""Products of cosines over conditions: smooth curves, the shorter the waves the smaller.

The discrete cosine transform over the settings of each condition nearly diagonalises their covariance (Ahmed, Natarajan and Rao
1974, IEEE Transactions on Computers C-23, 90), here a Matern covariance of order 5/2.
"""

from __future__ import annotations

import numpy as np

from mffit.diagnosis import constants
from mffit.linearised.inputs import Input
from mffit.linearised.smooth import matern

LEAST = 1e-12
"""Smallest share of a cosine in the variance over one condition; rounding may leave less than none."""


def cosines(inputs: tuple[Input, ...], at: np.ndarray) -> np.ndarray:
    """Functions (n, m) of conditions (n, d), the constant first; each has the size that curves of unit variance give it.

    The length of the curves along every condition is its spacing.
    """
    size, functions = np.ones(1), np.ones((len(at), 1))
    for one, x in zip(inputs, at.T, strict=True):
        steps = round(one.width / one.spacing) * (1 if one.is_held else 2)
        settings = np.linspace(one.lower, one.upper, steps + 1)
        alike = matern(np.abs(settings[:, None] - settings), one.spacing)
        waves = _waves(one, settings, steps) / (steps + 1)
        share = np.maximum(np.einsum("ik,ij,jk->k", waves, alike, waves, optimize=True), LEAST)
        size = np.outer(size, share).ravel()
        functions = (functions[:, :, None] * _waves(one, x, steps)[:, None]).reshape(len(at), -1)
        # conditions of equal grids have functions of equal size, which rounding must not order
        largest = np.argsort(-np.log(size).round(9), kind="stable")[: constants.CURVES]
        size, functions = size[largest], functions[:, largest]
    return np.asarray(functions * np.sqrt(size))


def _waves(one: Input, values: np.ndarray, steps: int) -> np.ndarray:
    """Cosines (n, steps + 1) of one condition, of unit mean square over its settings."""
    order = np.arange(steps + 1)
    # they run half a step beyond the ends
    place = (np.clip(values, one.lower, one.upper) - one.lower) / one.width * steps + 0.5
    waves = np.cos(np.pi / (steps + 1) * place[:, None] * order)
    return np.asarray(waves * np.where(order > 0, np.sqrt(2.0), 1.0))
