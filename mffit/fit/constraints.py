"""Physical limits that the fitted model keeps over the whole range of the file, not only at the points."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from mffit.fit import constants
from tir.derivatives import Traced, gradient, plain
from tir.equations import aligning, lateral, normalise, stiffness


class Envelope(NamedTuple):
    """The ranges over which the limits must hold."""

    Fz: tuple[float, float]  #: [N]
    gamma: float  #: largest |camber| [rad]
    alpha: float  #: largest |sideslip| [rad]
    pressure: tuple[float, float]  #: [Pa]

    @property
    def size(self) -> int:
        """Number of conditions at which the limits are tested."""
        return _grid(self)[0].size


def violations(p: Any, envelope: Envelope) -> np.ndarray:
    """Violation (k,) of each limit at each condition of the envelope, dimensionless; 0 where the limit is kept."""
    return np.maximum(limits(p, envelope)[0], 0.0)


def limits(p: Any, envelope: Envelope, by: Sequence[Traced] = ()) -> tuple[np.ndarray, np.ndarray]:
    """Every limit at every condition of the envelope (k,), above 0 where broken, and its derivatives (k, m).

    ``p`` has the file's values as attributes, plain or traced; ``by`` are the m traced values to differentiate by.
    """
    rows, n = _rows(p, envelope), envelope.size
    value = np.concatenate([np.broadcast_to(plain(row), n) for row in rows])
    slope = np.concatenate([np.broadcast_to(gradient(row, by), (n, len(by))) for row in rows])
    return value, slope


def _rows(p: Any, envelope: Envelope) -> list[Any]:
    """Each limit at the conditions of the envelope (n,), dimensionless: above 0 where it is broken.

    Limits: mu_y > 0, cornering stiffness < 0, E_y <= 1 on both sides of the curve, B_t > 0, E_t <= 1 on both sides,
    trail at zero slip not negative.
    """
    Fz, gamma, pressure = (axis.ravel() for axis in _grid(envelope))
    q = normalise.inputs(p, Fz, Fz, 0.0, 0.0, gamma, 0.0, pressure, False, False)
    B_t = aligning.slope_factor(p, q)
    rows = [
        constants.LEAST_FRICTION - stiffness.lateral_friction(p, q, gamma),
        (stiffness.cornering_stiffness(p, q, gamma) / Fz + constants.LEAST_CORNERING_STIFFNESS) / 5.0,
    ]
    for side in (-1.0, 1.0):
        rows.append(lateral.curvature(p, q, gamma, side) - 1.0)
        rows.append(aligning.curvature(p, q, B_t, side * envelope.alpha) - 1.0)
    rows.append((constants.LEAST_TRAIL_SLOPE_FACTOR - B_t) / 10.0)
    rows.append((constants.LEAST_TRAIL - aligning.trail_at_zero(p, q)) / 0.1)
    return [row + constants.LIMIT_MARGIN for row in rows]


def _grid(envelope: Envelope) -> list[np.ndarray]:
    """Load, camber and pressure of the conditions at which the limits are tested."""
    loads, cambers, pressures = (int(n) for n in constants.LIMIT_GRID)
    low, high = envelope.pressure
    return list(
        np.meshgrid(
            np.linspace(*envelope.Fz, loads),
            np.linspace(-envelope.gamma, envelope.gamma, cambers if envelope.gamma > 0 else 1) + 0.0,
            np.linspace(low, high, pressures if high > low else 1),
        )
    )
