"""What the simulation currently assumes: the tyre, the rig's faults, the switches; and how a number in it is changed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from mffit.diagnosis.lag import lagged_points
from mffit.points import Points
from mffit.rig import RigFaults, readings

FAULT_FIELDS = frozenset(field.name for field in fields(RigFaults))


@dataclass(frozen=True, slots=True)
class State:
    """Everything that decides what the simulation says."""

    values: Mapping[str, Any]  #: every value of the property file
    faults: RigFaults
    turn_slip: bool
    star: bool
    relaxation_m: float = 0.0

    def number(self, name: str, points: Points) -> float:
        """Current value of a coefficient, a rig fault or a switch."""
        if name == "turn_slip":
            return float(self.turn_slip)
        if name == "relaxation_m":
            return self.relaxation_m
        if name == "path_radius_m":
            declared = 1.0 / max(float(np.max(np.abs(points.phi_t))), 1e-12)
            return declared if np.isnan(self.faults.path_radius_m) else self.faults.path_radius_m
        if name in FAULT_FIELDS:
            return float(getattr(self.faults, name))
        return float(self.values[name])

    def with_numbers(self, numbers: Mapping[str, float]) -> State:
        """A state with some numbers replaced."""
        faults = {name: value for name, value in numbers.items() if name in FAULT_FIELDS}
        values = {
            n: v
            for n, v in numbers.items()
            if n not in FAULT_FIELDS and n not in ("turn_slip", "relaxation_m")
        }
        return replace(
            self,
            values={**self.values, **values} if values else self.values,
            faults=replace(self.faults, **faults) if faults else self.faults,
            turn_slip=bool(numbers.get("turn_slip", self.turn_slip)),
            relaxation_m=float(numbers.get("relaxation_m", self.relaxation_m)),
        )

    def predict(self, points: Points) -> np.ndarray:
        """Readings (2n,): Fy [N], then Mz [Nm]."""
        if self.relaxation_m:
            points = lagged_points(points, self.relaxation_m)
        out = readings(
            SimpleNamespace(**self.values), points, self.faults, turn_slip=self.turn_slip, star=self.star
        )
        return np.concatenate([out.Fy, out.Mz])
