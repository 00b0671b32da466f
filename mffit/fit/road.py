"""Conditions on a straight path over the ranges of a file, and how much each counts."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

OUTSIDE, CORNER = 0.02, 0.5
SLIP, LEAN = np.radians(4.0), np.radians(25.0)


class Road(NamedTuple):
    """Conditions, arrays (n,)."""

    Fz: np.ndarray  #: [N]
    alpha: np.ndarray  #: [rad]
    gamma: np.ndarray  #: [rad]
    pressure: np.ndarray  #: [Pa]


def road_grid(
    tested: Mapping[str, float], written: Mapping[str, float], nominal_load: float, *, dense: bool = True
) -> Road:
    """Conditions over the written ranges: denser inside the tested ones, other pressures at one load."""
    sides, inner, outer = (11, 13, 3) if dense else (7, 7, 1)
    gamma = np.linspace(-written["CAMMAX"], written["CAMMAX"], sides)
    inside = np.linspace(-tested["ALPMAX"], tested["ALPMAX"], inner)
    beyond = np.linspace(tested["ALPMAX"], written["ALPMAX"], outer + 1)[1:]
    alpha = np.unique(np.concatenate([-beyond, inside, beyond]))
    main = 0.5 * (tested["PRESMIN"] + tested["PRESMAX"])
    loads = np.unique(
        [
            written["FZMIN"],
            *np.linspace(tested["FZMIN"], tested["FZMAX"], 4 if dense else 2),
            written["FZMAX"],
        ]
    )
    middle = float(np.clip(nominal_load, tested["FZMIN"], tested["FZMAX"]))
    cases = [(load, main) for load in loads]
    cases += [(middle, pressure) for pressure in sorted({written["PRESMIN"], written["PRESMAX"]} - {main})]
    at = [np.meshgrid([load], alpha, gamma, [pressure], indexing="ij") for load, pressure in cases]
    return Road(*(np.concatenate([axes[i].ravel() for axes in at]) for i in range(4)))


def camber_lines(written: Mapping[str, float]) -> tuple[Road, int]:
    """Camber alone, over the whole range, at three loads; and the conditions of each."""
    n = 17
    Fz, gamma = np.meshgrid(
        np.linspace(written["FZMIN"], written["FZMAX"], 3),
        np.linspace(-written["CAMMAX"], written["CAMMAX"], n),
        indexing="ij",
    )
    pressure = np.full(Fz.size, 0.5 * (written["PRESMIN"] + written["PRESMAX"]))
    return Road(Fz.ravel(), np.zeros(Fz.size), gamma.ravel(), pressure), n


def weights(road: Road, tested: Mapping[str, float]) -> np.ndarray:
    """Weight (n,) of each condition: what a vehicle visits counts more than the corners of the ranges.

    A wheel leans far with little sideslip and slips far with little lean; both at once is a fall. Inside the tested
    ranges the weight is ``1/2 + 1/2 / (1 + (alpha/4 deg * gamma/25 deg)**2)``: 1 along both axes, nearly 1/2 in the
    corner of 8 deg of sideslip and 50 deg of camber. Conditions that only the written ranges hold count a fiftieth:
    enough to keep the file plausible there, too little to cost newtons where there are data.
    """
    both = (road.alpha / SLIP * road.gamma / LEAN) ** 2
    return np.where(inside(road, tested), 1.0, OUTSIDE) * (CORNER + (1.0 - CORNER) / (1.0 + both))


def inside(road: Road, tested: Mapping[str, float]) -> np.ndarray:
    """Which conditions (n,) lie inside the tested ranges."""
    within = np.abs(road.alpha) <= tested["ALPMAX"] + 1e-9
    within &= np.abs(road.gamma) <= tested["CAMMAX"] + 1e-9
    within &= (road.Fz >= 0.999 * tested["FZMIN"]) & (road.Fz <= 1.001 * tested["FZMAX"])
    return (
        within & (road.pressure >= 0.999 * tested["PRESMIN"]) & (road.pressure <= 1.001 * tested["PRESMAX"])
    )
