"""Friction and slip stiffnesses of the upright wheel on a straight path, traced by the coefficients."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np

from tir.equations import normalise, stiffness
from tir.equations.normalise import Inputs


def sideways(values: Mapping[str, Any], loads: np.ndarray, pressure: Any) -> tuple[Any, Any]:
    """Friction and cornering stiffness (n,) of the upright wheel at loads (n,) [N] and pressures [Pa], on a straight path."""
    p, q = upright(values, loads, pressure)
    return stiffness.lateral_friction(p, q, 0.0), stiffness.cornering_stiffness(p, q, 0.0)


def upright(values: Mapping[str, Any], loads: Any, pressure: Any) -> tuple[SimpleNamespace, Inputs]:
    """Coefficients and normalised inputs of the upright wheel without slip, for the equations."""
    p = SimpleNamespace(**values)
    return p, normalise.inputs(p, loads, loads, 0.0, 0.0, 0.0, 0.0, pressure, False, False)
