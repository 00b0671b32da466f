"""The record of a fleet: every specimen's numbers, what each rig's tyres say together, what later builds may use of it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from mffit.fleet.hierarchy import Hierarchy
from mffit.fleet.specimen import Specimen
from tir import Quantity

STRAINED = 4.0
"""Standard deviations from which on the rig of one tyre is not that of the others."""
FAR = 3.0
"""Standard deviations of the declaration from which on the common rig is not the declared one."""


@dataclass(frozen=True, slots=True)
class Row:
    """One specimen; eps_gamma three ways, None where it was not measured."""

    specimen: Specimen
    rig: int  #: which of the fleet's rigs
    numbers: Mapping[str, Quantity]  #: stiffnesses and peaks of the fitted model
    alone: Quantity | None = None  #: eps_gamma, joint estimate of its own build
    together: Quantity | None = None  #: eps_gamma, joint estimate of all tyres of its rig
    strain: Mapping[str, float] = field(default_factory=dict)

    @property
    def direct(self) -> Quantity | None:
        """eps_gamma by the direct method."""
        return self.specimen.epsilon_gamma


@dataclass(frozen=True, slots=True)
class Scatter:
    """How one number differs from tyre to tyre, beside what is known of each."""

    mean: float
    sd: float  #: between the tyres
    u: float  #: rms of the stated standard uncertainties
    tyres: int

    @property
    def beyond(self) -> float:
        """Scatter that the uncertainties do not explain."""
        return math.sqrt(max(self.sd**2 - self.u**2, 0.0))


@dataclass(frozen=True, slots=True)
class Fleet:
    """All specimens, rig by rig."""

    rows: tuple[Row, ...]
    rigs: tuple[Hierarchy | None, ...]  #: None where no points of its builds say anything
    notes: tuple[str, ...]

    def numbers(self, key: str) -> list[Quantity | None]:
        """One number of every specimen; ``direct``, ``alone`` and ``together`` are eps_gamma."""
        if key in EPSILON:
            return [getattr(row, key) for row in self.rows]
        return [row.numbers.get(key) for row in self.rows]

    def scatter(self, key: str) -> Scatter | None:
        """Of one number over all specimens that have it; None of fewer than two."""
        found = [q for q in self.numbers(key) if q is not None]
        return scatter_of(found) if len(found) > 1 else None


EPSILON = {
    "direct": "direct method",
    "alone": "joint estimate of its own build",
    "together": "joint estimate of all tyres",
}
"""The three estimates of eps_gamma and what they are."""


def scatter_of(found: Sequence[Quantity]) -> Scatter:
    """Mean, scatter and typical uncertainty of two numbers or more."""
    values, u = np.array([q.value for q in found]), np.array([q.u for q in found])
    return Scatter(float(values.mean()), float(values.std(ddof=1)), float(np.sqrt(np.mean(u**2))), len(found))


def with_estimate(row: Row, together: Quantity | None, strain: Mapping[str, float]) -> Row:
    """The row with what all tyres of its rig say of it."""
    return replace(row, together=together, strain=strain)
