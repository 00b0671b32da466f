"""Friction and stiffness of the upright wheel on a straight path, and coefficients solved from measured values of these."""

from collections.abc import Callable, Collection, Mapping, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np

from mffit.least_squares import FreeNumber, of_model, solve
from tir.equations import normalise, stiffness
from tir.equations.normalise import Inputs
from tir.parameters import BY_NAME


def sideways(values: Mapping[str, Any], loads: np.ndarray, pressure: Any) -> tuple[Any, Any]:
    """Friction and cornering stiffness (n,) of the upright wheel at loads (n,) [N] and pressures [Pa], on a straight path."""
    p, q = upright(values, loads, pressure)
    return stiffness.lateral_friction(p, q, 0.0), stiffness.cornering_stiffness(p, q, 0.0)


def upright(values: Mapping[str, Any], loads: Any, pressure: Any) -> tuple[SimpleNamespace, Inputs]:
    """Coefficients and normalised inputs of the upright wheel without slip, for the equations."""
    p = SimpleNamespace(**values)
    return p, normalise.inputs(p, normalise.OperatingCondition(loads, pressure=pressure))


def nearest(
    values: Mapping[str, Any],
    names: Sequence[str],
    of: Callable[[Mapping[str, Any]], Any],
    measured: np.ndarray,
    held: Collection[str] = (),
) -> dict[str, float]:
    """The coefficients with which a characteristic ``of`` the tyre (n,) fits measured values (n,) best.

    At most n coefficients change, the first of ``names``; those ``held`` by hand do not.
    """
    free = [name for name in names if name not in held][: len(measured)]
    numbers = [FreeNumber(n, BY_NAME[n].inside(float(values[n])), *BY_NAME[n].bounds) for n in free]
    u = 1e-4 * float(np.max(np.abs(measured), initial=0.0)) or 1.0
    problem = of_model(lambda numbers: of({**values, **numbers}), free, measured, u)
    return solve(problem, numbers, tolerance=1e-12).values
