"""Least squares of the new file's forces to the old ones, with curvature factors held to 1, as MF 5.2 holds them."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from mffit.conversion import constants
from mffit.conversion.grid import Conditions, Reach, cambers, loads
from mffit.fit.constants import STAGE_TOLERANCE
from mffit.fit.written.normal import CAMBER_FORCE, CAMBER_MOMENT
from mffit.least_squares import FreeNumber, of_model, solve
from tir.derivatives import Traced, gradient, plain
from tir.equations import aligning, lateral, longitudinal, normalise
from tir.outputs import outputs_of

SIDES = (-1.0, 1.0)


class CurvatureFactor(NamedTuple):
    """A curvature factor E of one curve."""

    channel: str  #: the force or moment that it bends
    names: tuple[str, ...]  #: its coefficients without those of camber
    at_loads: Callable[[SimpleNamespace, normalise.Inputs, float], list[Any]]
    """E before limits, to the largest sideslip."""


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
    q = normalise.inputs(p, normalise.OperatingCondition(Fz, gamma=gamma))
    rows = [row - 1.0 for factor in factors for row in factor.at_loads(p, q, reach.alpha)]
    value = np.concatenate([np.broadcast_to(plain(row), Fz.shape) for row in rows])
    if not by:
        return value, np.zeros((value.size, 0))
    return value, np.concatenate([np.broadcast_to(gradient(row, by), (Fz.size, len(by))) for row in rows])


def held(p: SimpleNamespace, reach: Reach) -> dict[str, float]:
    """The curvature factors that exceed 1 somewhere in the range, with camber or without: largest E, by key without number."""
    largest = {
        factor.names[0][:-1]: 1.0 + float(np.max(excess(p, [factor], reach, camber=cambers(reach))[0]))
        for factor in FACTORS
    }
    return {key: E for key, E in largest.items() if E > 1.0}


FREE: Mapping[str, Sequence[str]] = {"Fx": (), "Fy": CAMBER_FORCE, "Mz": CAMBER_MOMENT}
"""By channel, what is fitted in every file: the coefficients of camber. All others mean the same in both formulae, so that the
upright wheel keeps its forces."""
UNBOUNDED = (-np.inf, np.inf)
"""Bound of a converted coefficient: exact forces determine it, and its factor may be tiny in the old file."""


class Fit(NamedTuple):
    """Coefficients to be fitted to a force of the other formula."""

    names: Sequence[str]
    force: Callable[[Mapping[str, Any]], Any]  #: (n,), from all coefficients by name, plain or traced
    goal: np.ndarray  #: (n,) of the other formula
    u: np.ndarray  #: (n,) uncertainty of each

    def solved(
        self,
        values: Mapping[str, Any],
        bounds: Callable[[str], tuple[float, float]] = lambda name: UNBOUNDED,
        limits: Callable[[Mapping[str, Any]], tuple[np.ndarray, np.ndarray]] | None = None,
    ) -> Mapping[str, float]:
        """The coefficients that come nearest, from those in ``values``, which has all others; ``limits`` as in `of_model`."""
        problem = of_model(
            lambda numbers: self.force({**values, **numbers}), self.names, self.goal, self.u, limits
        )
        numbers = [FreeNumber(name, float(values[name]), *bounds(name)) for name in self.names]
        # Near enough: the misfit is within two per cent of the least. Below, terms of which the forces need one (QSX4 and QSX8 of
        # PAC2002) run away together for hundreds of steps.
        return solve(problem, numbers, tolerance=float(STAGE_TOLERANCE)).values


def refit(
    values: Mapping[str, Any], at: Conditions, goal: Mapping[str, np.ndarray], reach: Reach
) -> dict[str, float]:
    """The coefficients with which the new formulae come nearest to the old forces: those of camber, and of too large curvature.

    The side force comes before the aligning moment, into which it enters.
    """
    found: dict[str, float] = {}
    p = SimpleNamespace(**values)
    curved = [factor for factor in FACTORS if np.max(excess(p, [factor], reach)[0]) > 0.0]
    for channel, by_camber in FREE.items():
        if not np.any(goal[channel]):  # the old file has no such force, and its coefficients are 0
            continue
        limited = [factor for factor in curved if factor.channel == channel]
        names = (*by_camber, *(name for factor in limited for name in factor.names))
        if names:
            fit = Fit(names, partial(force_62, channel, at), goal[channel], at.u(goal[channel]))
            others = {**values, **found}
            limits = partial(_held_to_one, limited, reach, others) if limited else None
            found.update(fit.solved(others, limits=limits))
    return found


def force_62(channel: str, at: Conditions, values: Mapping[str, Any]) -> Any:
    """A force of MF 6.2, without turn slip."""
    return outputs_of((channel,), SimpleNamespace(**values), at._asdict())[0]


def _held_to_one(
    factors: Sequence[CurvatureFactor], reach: Reach, values: Mapping[str, Any], numbers: Mapping[str, Any]
) -> tuple[np.ndarray, np.ndarray]:
    """Residuals, positive where a curvature factor exceeds 1, and their derivatives by the numbers that are traced."""
    by = [x for x in numbers.values() if isinstance(x, Traced)]
    over, slope = excess(SimpleNamespace(**{**values, **numbers}), factors, reach, by)
    weight = float(constants.WEIGHT_OF_CURVATURE_LIMIT)
    return weight * (over + float(constants.CURVATURE_MARGIN)), weight * slope
