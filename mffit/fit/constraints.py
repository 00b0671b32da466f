"""Physical limits that the fitted model keeps over the whole range it is written for, not only at the data."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tir.equations import aligning, lateral, normalise, stiffness

MARGIN = 0.02


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


def violations(p, envelope: Envelope) -> np.ndarray:
    """How far each limit is broken on a grid over the envelope, dimensionless, 0 where it is kept; shape (k,)."""
    rows = limits(p, envelope)
    return np.maximum(np.concatenate([np.broadcast_to(row, envelope.size) for row in rows]), 0.0)


def limits(p, envelope: Envelope) -> list[Any]:
    """Each limit on a grid over the envelope, dimensionless: above 0 where it is broken; rows (envelope.size,).

    Limits: mu_y > 0, cornering stiffness < 0, E_y <= 1 on both sides of the curve, B_t > 0, E_t <= 1 on both sides,
    trail at zero slip not negative, shape factor of the pressure terms > 0.
    """
    Fz, gamma, pressure = (axis.ravel() for axis in _grid(envelope))
    q = normalise.inputs(p, Fz, Fz, 0.0, 0.0, gamma, 0.0, pressure, False, False)
    rows = []
    mu_y = stiffness.lateral_friction(p, q, gamma)
    rows.append(0.1 - mu_y)
    K_ya = stiffness.cornering_stiffness(p, q, gamma) / Fz
    rows.append((K_ya + 0.5) / 5.0)
    B_t = aligning.slope_factor(p, q)
    for side in (-1.0, 1.0):
        rows.append(lateral.curvature(p, q, gamma, side) - 1.0)
        rows.append(aligning.curvature(p, q, B_t, side * envelope.alpha) - 1.0)
    rows.append((0.3 - B_t) / 10.0)
    rows.append((0.0005 - aligning.trail_at_zero(p, q)) / 0.1)
    return [row + MARGIN for row in rows]


def _grid(envelope: Envelope) -> list[np.ndarray]:
    Fz = np.linspace(*envelope.Fz, 3)
    gamma = np.linspace(-envelope.gamma, envelope.gamma, 5) if envelope.gamma > 0 else np.zeros(1)
    pressure = (
        np.linspace(*envelope.pressure, 2)
        if envelope.pressure[1] > envelope.pressure[0]
        else np.array(envelope.pressure[:1])
    )
    return list(np.meshgrid(Fz, gamma, pressure))
