"""What the rig's own uncertainties, common to all points, do to the fitted coefficients."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from mffit.fit.problem import Problem
from mffit.rig import RigFaults, readings


@dataclass(frozen=True, slots=True)
class CommonError:
    """A rig error that all points share: a fault of one standard uncertainty, or a held number's."""

    source: str
    fault: RigFaults | None = None
    held: tuple[str, float] | None = None  #: (coefficient, standard uncertainty)


def common_errors(config: Any, measured: Any) -> tuple[CommonError, ...]:
    """Load-cell offset, camber and sideslip alignment, path radius and the held PECP1, from the configuration."""
    rig = config.rig
    if rig.type != "rotating-disk" or measured.epsilon_gamma is None:
        return ()
    radius = rig.radius + (measured.R.u if measured.R else 0.0)
    slip = rig.u_slip_alignment_N / max(abs(measured.C_alpha.value), 1.0) if measured.C_alpha else 0.0
    out = [
        CommonError("load-cell offset", RigFaults(F0_N=rig.u_loadcell_offset_N)),
        CommonError("camber alignment", RigFaults(gamma_0_deg=rig.u_camber_alignment_deg)),
        CommonError("sideslip alignment", RigFaults(alpha_0_deg=math.degrees(slip))),
        CommonError("path radius", RigFaults(path_radius_m=radius)),
    ]
    if config.spin.pecp1 == "direct":
        out.append(CommonError("eps_gamma", held=("PECP1", measured.epsilon_gamma.u)))
    return tuple(out)


def systematic_covariance(
    problem: Problem, values: Mapping[str, float], jacobian: np.ndarray, errors: Sequence[CommonError]
) -> np.ndarray:
    """Covariance (k, k) of the coefficients that the common errors cause, to first order.

    Parameters
    ----------
    problem : as solved, with its weights
    values : the solution
    jacobian : (m, k) of the whole residual at the solution
    errors : the common errors, each at one standard uncertainty
    """
    gain = np.linalg.pinv(jacobian)
    total = np.zeros((jacobian.shape[1],) * 2)
    for error in errors:
        shift = gain @ _residual_shift(problem, values, error, len(jacobian))
        total += np.outer(shift, shift)
    return total


def _residual_shift(problem: Problem, values, error: CommonError, rows: int) -> np.ndarray:
    """Change of the residual (m,) by an error of one standard uncertainty; ties to base values do not move."""
    out = np.zeros(rows)
    n = len(problem.points)
    if error.held is not None:
        name, u = error.held
        fixed = {**problem.fixed, name: float(problem.fixed[name]) + u}
        out[: 2 * n] = replace(problem, fixed=fixed).data_residual(values) - problem.data_residual(values)
        return out
    assert error.fault is not None
    p = problem.parameters(values)
    for start, points, sigma in (
        (0, problem.points, problem.sigma_Fy),
        (n, problem.points, problem.sigma_Mz),
    ):
        channel = 0 if start == 0 else 1
        faulty = readings(p, points, error.fault, turn_slip=problem.turn_slip)[channel]
        sound = readings(p, points, turn_slip=problem.turn_slip)[channel]
        out[start : start + n] = np.where(np.isfinite(sigma), (faulty - sound) / sigma, 0.0)
    if problem.tie is not None:
        zero, _, weight = problem.tie
        faulty = readings(p, zero, error.fault, turn_slip=problem.turn_slip).Fy.mean()
        out[-1] = (faulty - readings(p, zero, turn_slip=problem.turn_slip).Fy.mean()) * weight
    return out
