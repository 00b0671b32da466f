"""Physical limits that the fitted model keeps over the whole tested range, not only at the points."""

from collections.abc import Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from mffit.fit import constants
from tir.constants import SIDESLIP_BEYOND_PEAK
from tir.derivatives import Traced, gradient, plain
from tir.equations import aligning, lateral, longitudinal, normalise, stiffness, turn_slip
from tir.equations.elementary import cos, magic_angle
from tir.outputs import outputs_of


class Envelope(NamedTuple):
    """The ranges over which the limits must hold."""

    Fz: tuple[float, float]  #: [N]
    gamma: float  #: largest |camber| [rad]
    alpha: float  #: largest |sideslip| [rad]
    pressure: tuple[float, float]  #: [Pa]
    kappa: float = 0.0  #: largest |longitudinal slip|; 0 if none was run, which switches off the limits on forces under slip

    @property
    def size(self) -> int:
        """Number of conditions at which the limits are tested."""
        return grid(self)[0].size


def characteristics(p: Any, Fz: np.ndarray, gamma: np.ndarray, pressure: np.ndarray) -> list[np.ndarray]:
    """Friction and stiffness over load [-], lateral and, if the file has them, longitudinal."""
    q = normalise.inputs(p, normalise.OperatingCondition(Fz, gamma=gamma, pressure=pressure))
    found = (
        stiffness.lateral_friction(p, q, gamma),
        stiffness.cornering_stiffness(p, q, gamma) / Fz,
        stiffness.longitudinal_friction(p, q),
        stiffness.longitudinal_slip_stiffness(p, q) / Fz,
    )
    return [np.broadcast_to(x, Fz.shape) for x in found if np.any(x)]


def violations(p: Any, envelope: Envelope) -> np.ndarray:
    """Violation (k,) of each limit at each condition of the envelope, dimensionless; 0 where the limit is kept."""
    return np.asarray(np.maximum(limits(p, envelope)[0], 0.0))


def limits(p: Any, envelope: Envelope, by: Sequence[Traced] = ()) -> tuple[np.ndarray, np.ndarray]:
    """Every limit at every condition and slip of the envelope (k,), positive where violated, and its derivatives (k, m).

    ``p`` has the file's values as attributes, plain or traced; ``by`` are the m traced values to differentiate by.
    """
    n = envelope.size
    found = [
        (np.broadcast_to(plain(row), size), np.broadcast_to(gradient(row, by), (size, len(by))))
        for row in _rows(p, envelope)
        for size in [max(n, np.size(plain(row)))]
    ]
    found.append(_dents(p, envelope, by))
    return np.concatenate([value for value, _ in found]), np.concatenate([slope for _, slope in found])


def _rows(p: Any, envelope: Envelope) -> list[Any]:
    """Each limit at the conditions of the envelope (n,), dimensionless: positive where it is violated.

    Limits: mu_y > 0, cornering stiffness < 0, load of its peak > 0 (at 0 the stiffness changes sign abruptly, which stops a
    search), E_y <= 1 on both sides of the curve, B_t > 0, E_t <= 1 on both sides, trail at zero slip not negative. If
    longitudinal slip was run, the limits of :func:`_longitudinal` and :func:`_under_slip` follow.
    """
    Fz, gamma, pressure = grid(envelope)
    q = normalise.inputs(p, normalise.OperatingCondition(Fz, gamma=gamma, pressure=pressure))
    B_t = aligning.slope_factor(p, q)
    rows = [
        constants.LEAST_FRICTION - stiffness.lateral_friction(p, q, gamma),
        (stiffness.cornering_stiffness(p, q, gamma) / Fz + constants.LEAST_STIFFNESS) / 5.0,
        -stiffness.peak_load(p, q, gamma),
    ]
    for side in (-1.0, 1.0):
        rows.append(lateral.curvature(p, q, gamma, side) - 1.0)
        rows.append(aligning.curvature(p, q, B_t, side * envelope.alpha) - 1.0)
    rows.append((constants.LEAST_SLOPE_FACTOR - B_t) / 10.0)
    rows.append((constants.LEAST_TRAIL - aligning.trail_at_zero(p, q)) / 0.1)
    if envelope.kappa > 0.0:
        rows += _longitudinal(p, q)
        rows += _under_slip(p, envelope, Fz, gamma, pressure)
    return [row + constants.LIMIT_MARGIN for row in rows]


def _longitudinal(p: Any, q: normalise.Inputs) -> list[Any]:
    """Limits of the pure longitudinal force: mu_x > 0, slip stiffness > 0, E_x <= 1 driven and braked."""
    K_xk = stiffness.longitudinal_slip_stiffness(p, q)
    rows = [
        constants.LEAST_FRICTION - stiffness.longitudinal_friction(p, q),
        (constants.LEAST_STIFFNESS - K_xk / q.Fz) / 5.0,
    ]
    return rows + [longitudinal.curvature(p, q, side) - 1.0 for side in (-1.0, 1.0)]


def _under_slip(p: Any, envelope: Envelope, *conditions: np.ndarray) -> list[Any]:
    """Limits at the largest longitudinal slips and sideslips of either sign.

    Fx has the sign of kappa; the weights G_xa and G_yk lie between 0 and a little above 1, their slope factors are positive, and
    their curvature factors are at most 1.
    """
    k, a = constants.BEYOND_TESTED * envelope.kappa, max(SIDESLIP_BEYOND_PEAK.rad, envelope.alpha)
    q = _with_slips(p, conditions, [(k, 0.0), (-k, 0.0)])
    K_xk, mu_x = stiffness.longitudinal_slip_stiffness(p, q), stiffness.longitudinal_friction(p, q)
    force = np.sign(q.kappa) * longitudinal.pure(p, q, turn_slip.NO_SPIN, K_xk, mu_x)
    rows = [constants.LEAST_FRICTION - force / q.Fz]
    corners = [(side * k, other * a) for side in (-1.0, 1.0) for other in (-1.0, 1.0)]
    for weight, factors, ends in (
        (longitudinal.combined_weight, longitudinal.weight_factors, [(0.0, -a), (0.0, a)]),
        (lateral.combined_weight, lateral.weight_factors, [(-k, 0.0), (k, 0.0)]),
    ):
        G = weight(p, _with_slips(p, conditions, [*corners, *ends]))
        of = factors(p, _with_slips(p, conditions, [(0.0, 0.0)]))
        over_peak = cos(magic_angle(of.B, of.C, of.E, of.S_H))  # weights are 1 at zero slip
        rows += [-G, 1.0 / constants.LARGEST_WEIGHT - over_peak]
        rows += [(constants.LEAST_SLOPE_FACTOR - of.B) / 10.0, of.E - 1.0]
    return rows


def _dents(p: Any, envelope: Envelope, by: Sequence[Traced]) -> tuple[np.ndarray, np.ndarray]:
    """Concavity of the curve of Fy over Fx along longitudinal slip, both over load: positive where the ellipse has a dent.

    Evaluated from three neighbouring slips of the upright wheel, on a grid of loads, sideslips of either sign and slips: (k,) and
    (k, m) as of :func:`limits`.
    """
    if not (envelope.kappa > 0.0 and envelope.alpha > 0.0):
        return np.zeros(0), np.zeros((0, len(by)))
    sideslips = envelope.alpha * np.array([-1.0, -0.5, 0.5, 1.0])
    slips = (
        float(constants.BEYOND_TESTED) * envelope.kappa * np.linspace(-1.0, 1.0, constants.STEPS_OF_A_GRID)
    )
    grid = np.meshgrid(np.linspace(*envelope.Fz, constants.LOADS_OF_A_GRID), sideslips, slips)
    Fz, alpha, kappa = (axis.ravel() for axis in grid)
    at = {"Fz": Fz, "alpha": alpha, "pressure": 0.5 * sum(envelope.pressure), "Vx": p.LONGVL}
    forces = outputs_of(("Fx", "Fy"), p, {**at, "kappa": kappa})
    rises = []
    for force, unit in zip(forces, (Fz, -np.sign(alpha) * Fz), strict=True):
        both = np.column_stack([plain(force), gradient(force, by)]) / unit[:, None]
        rise = np.diff(both.reshape(*grid[0].shape, -1), axis=2)
        rises += [rise[:, :, side].reshape(-1, 1 + len(by)) for side in (slice(-1), slice(1, None))]
    (x, dx), (next_x, dnext_x), (y, dy), (next_y, dnext_y) = ((r[:, :1], r[:, 1:]) for r in rises)
    slope = x * dnext_y + next_y * dx - y * dnext_x - next_x * dy
    return (x * next_y - y * next_x)[:, 0] - constants.LARGEST_DENT, slope


def _with_slips(
    p: Any, conditions: Sequence[np.ndarray], slips: Sequence[tuple[float, float]]
) -> normalise.Inputs:
    """Inputs of every condition (load, camber and pressure, (n,) each) at every pair of longitudinal slip and sideslip [rad]."""
    Fz, gamma, pressure = (np.tile(x, len(slips)) for x in conditions)
    kappa, alpha = (np.repeat(x, len(conditions[0])) for x in zip(*slips, strict=True))
    return normalise.inputs(p, normalise.OperatingCondition(Fz, alpha, gamma, kappa, pressure=pressure))


@lru_cache(maxsize=8)
def grid(envelope: Envelope) -> tuple[np.ndarray, ...]:
    """Load, camber and pressure (n,) of the conditions at which the limits are tested."""
    axes = np.meshgrid(
        np.linspace(*envelope.Fz, constants.LOADS_OF_A_GRID),
        np.linspace(-envelope.gamma, envelope.gamma, constants.CAMBERS_OF_A_GRID if envelope.gamma > 0 else 1)
        + 0.0,
        np.unique(envelope.pressure),
    )
    found = tuple(axis.ravel() for axis in axes)
    for axis in found:
        axis.setflags(write=False)
    return found
