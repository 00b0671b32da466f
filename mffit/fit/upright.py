"""Friction and cornering stiffness of the upright wheel on a straight path, traced by the coefficients."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np

from tir.equations import normalise, stiffness


def sideways(values: Mapping[str, Any], loads: np.ndarray, pressure: Any) -> tuple[Any, Any]:
    """Friction and cornering stiffness (n,) of the upright wheel at loads (n,) [N] and pressures [Pa], on a straight path."""
    p = SimpleNamespace(**values)
    q = normalise.inputs(p, loads, loads, 0.0, 0.0, 0.0, 0.0, pressure, False, False)
    return stiffness.lateral_friction(p, q, 0.0), stiffness.cornering_stiffness(p, q, 0.0)
