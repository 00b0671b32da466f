"""Curvature factors that exceed 1: MF 5.2 holds them there, and many readers of MF 6.2 do not."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from mffit.conversion.grid import Reach, cambers, loads
from tir.derivatives import Traced, gradient, plain
from tir.equations import aligning, lateral, longitudinal, normalise

SIDES = (-1.0, 1.0)


class CurvatureFactor(NamedTuple):
    """A curvature factor E of one curve."""

    channel: str  #: the force or moment that it bends
    names: tuple[str, ...]  #: its coefficients without those of camber
    at_loads: Callable[
        [SimpleNamespace, normalise.Inputs, float], list[Any]
    ]  #: E before limits, to the largest sideslip


FACTORS = (
    CurvatureFactor(
        "Fx",
        ("PEX1", "PEX2", "PEX3", "PEX4"),
        lambda p, q, _: [longitudinal.curvature(p, q, side) for side in SIDES],
    ),
    CurvatureFactor("Fx", ("REX1", "REX2"), lambda p, q, _: [longitudinal.weight_factors(p, q).E]),
    CurvatureFactor(
        "Fy",
        ("PEY1", "PEY2", "PEY3"),
        lambda p, q, _: [lateral.curvature(p, q, q.gamma, side) for side in SIDES],
    ),
    CurvatureFactor("Fy", ("REY1", "REY2"), lambda p, q, _: [lateral.weight_factors(p, q).E]),
    CurvatureFactor(
        "Mz",
        ("QEZ1", "QEZ2", "QEZ3", "QEZ4"),
        lambda p, q, alpha: [
            aligning.curvature(p, q, aligning.slope_factor(p, q), side * alpha) for side in SIDES
        ],
    ),
)


def excess(
    p: SimpleNamespace,
    factors: Sequence[CurvatureFactor],
    reach: Reach,
    by: Sequence[Traced] = (),
    camber: np.ndarray | float = 0.0,
) -> tuple[np.ndarray, np.ndarray]:
    """E - 1 (k,) of the factors over load, side and cambers, above 0 where they exceed the limit, and its derivatives (k, m).

    ``p`` has the coefficients as attributes, plain or traced; ``by`` are the m traced ones.
    """
    Fz, gamma = (axis.ravel() for axis in np.meshgrid(loads(reach), camber))
    q = normalise.inputs(p, Fz, Fz, 0.0, 0.0, gamma, 0.0, p.INFLPRES, False, False)
    rows = [row - 1.0 for factor in factors for row in factor.at_loads(p, q, reach.alpha)]
    value = np.concatenate([np.broadcast_to(plain(row), Fz.shape) for row in rows])
    if not by:
        return value, np.zeros((value.size, 0))
    return value, np.concatenate([np.broadcast_to(gradient(row, by), (Fz.size, len(by))) for row in rows])


def exceeding(p: SimpleNamespace, reach: Reach) -> list[CurvatureFactor]:
    """The curvature factors of the upright wheel that exceed 1 somewhere in the range."""
    return [factor for factor in FACTORS if np.max(excess(p, [factor], reach)[0]) > 0.0]


def held(p: SimpleNamespace, reach: Reach) -> dict[str, float]:
    """The curvature factors that exceed 1 somewhere in the range, with camber or without: largest E, by key without number."""
    largest = {
        factor.names[0][:-1]: 1.0 + float(np.max(excess(p, [factor], reach, camber=cambers(reach))[0]))
        for factor in FACTORS
    }
    return {key: E for key, E in largest.items() if E > 1.0}
