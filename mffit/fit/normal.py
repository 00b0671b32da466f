"""The derived files: one for simulations without turn slip, and one that serves both uses at a common misfit."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from mffit.fit import constants
from mffit.fit.imitation import Goal, Imitation, Lines, force, goal
from mffit.fit.ranges import envelope
from mffit.fit.road import Road, camber_lines, road_grid, weights
from mffit.fit.stages import ODD_TERMS, STAGES
from mffit.least_squares import Number
from mffit.quantities import CHANNELS
from tir.parameters import BY_NAME

CAMBER_STIFFNESS = ("PKY6", "PKY7")
CAMBER_FORCE = ("PKY3", "PKY5", "PDY3", "PVY3", "PVY4", "PEY4", "PEY5", *CAMBER_STIFFNESS)
CAMBER_MOMENT = (
    "QDZ3", "QDZ4", "QDZ8", "QDZ9", "QDZ10", "QDZ11", "QBZ4", "QBZ5", "QEZ5", "QHZ3", "QHZ4"
)  # fmt: skip
SPIN = next(stage.parameters for stage in STAGES if stage.name == "spin")
STARTS: Mapping[str, tuple[Mapping[str, float], ...]] = {
    "Fy": ({}, {"PEY5": -3.0, "PDY3": 0.3}, {"PVY3": -0.5, "PDY3": 1.0}),
    "Mz": ({}, {"QDZ4": -1.0, "QEZ5": -2.0}, {"QBZ5": 0.8, "QEZ5": 2.0}),
}
"""By channel, changes of the model's values from which the search starts; the best end is kept."""


def derive_normal(
    values: Mapping[str, Any],
    tested: Mapping[str, float],
    written: Mapping[str, float],
    measured: Mapping[str, float],
    *,
    symmetric: bool = False,
) -> dict[str, float]:
    """Coefficients of the file for turn slip off, where they differ from the fitted model.

    The goal is the fitted model on a straight path, turn slip on, over the written ranges. Only coefficients that act through
    camber are free, so that the upright wheel stays exact.

    Parameters
    ----------
    values : the fitted model, meant for turn slip on
    tested, written : ranges of the data and of the file, by name of the file's limits
    measured : PKY6 and PKY7 of the measured camber stiffness, from :func:`mffit.fit.start.camber_stiffness_terms`; may be empty
    symmetric : hold the terms that a symmetric tyre does not have
    """

    def goals(road: Road) -> tuple[Goal, ...]:
        return (goal(values, road, weights(road, tested), turn_slip=False),)

    free = {"Fy": CAMBER_FORCE, "Mz": CAMBER_MOMENT}
    return _derived(values, tested, written, measured, goals, free, symmetric=symmetric)


def derive_both(
    values: Mapping[str, Any],
    tested: Mapping[str, float],
    written: Mapping[str, float],
    measured: Mapping[str, float],
    phi_t: float,
    *,
    symmetric: bool = False,
) -> dict[str, float]:
    """Coefficients of one file for turn slip on and off, where they differ from the fitted model.

    Three goals have equal weight: the fitted model on the disc and on a straight path, both reproduced with turn slip, and on a
    straight path reproduced without. Camber and turn-slip coefficients are free, so that the upright wheel on a straight path
    stays exact.

    Parameters
    ----------
    phi_t : curvature of the disc's path [1/m]
    others : as of :func:`derive_normal`
    """

    def goals(road: Road) -> tuple[Goal, ...]:
        weight = weights(road, tested)
        return (
            goal(values, road, weight, turn_slip=True, phi_t=phi_t),
            goal(values, road, weight, turn_slip=True),
            goal(values, road, weight, turn_slip=False),
        )

    spin = {channel: [n for n in SPIN if BY_NAME[n].channel == channel] for channel in CHANNELS}
    free = {"Fy": (*CAMBER_FORCE, *spin["Fy"]), "Mz": (*CAMBER_MOMENT, *spin["Mz"])}
    return _derived(values, tested, written, measured, goals, free, symmetric=symmetric)


def _derived(
    values: Mapping[str, Any],
    tested: Mapping[str, float],
    written: Mapping[str, float],
    measured: Mapping[str, float],
    goals: Callable[[Road], tuple[Goal, ...]],
    free: Mapping[str, Sequence[str]],
    *,
    symmetric: bool,
) -> dict[str, float]:
    """The free values that come nearest to the goals, where they differ from the model's.

    Fy comes first, because its shifts enter Mz. The search starts from several values on a coarse grid, and the best end is
    refined on the fine grid.
    """
    nominal = float(values["FNOMIN"])
    coarse, fine = (road_grid(tested, written, nominal, dense=dense) for dense in (False, True))
    found = dict(values)
    for channel, names in free.items():
        moving = [n for n in names if not (symmetric and n in ODD_TERMS)]
        lines = _lines(values, written) if channel == "Fy" else None
        on_coarse, on_fine = (
            Imitation(channel, dict(found), goals(road), envelope(written), lines) for road in (coarse, fine)
        )
        begin = {name: measured.get(name, float(values[name])) for name in moving}
        ends = [
            on_coarse.solve(
                _numbers({**begin, **start}, measured),
                steps=constants.COARSE_GRID_STEPS,
                tolerance=constants.COARSE_GRID_TOLERANCE,
            )
            for start in STARTS[channel]
        ]
        best = min(ends, key=lambda end: end.cost)
        found |= on_fine.solve(
            _numbers(best.values, measured),
            steps=constants.FINE_GRID_STEPS,
            tolerance=constants.REFIT_TOLERANCE,
        ).values
    return {name: found[name] for names in free.values() for name in names if found[name] != values[name]}


def _lines(values: Mapping[str, Any], written: Mapping[str, float]) -> Lines:
    """The lines of camber and where the model's side force falls along them."""
    road, n = camber_lines(written)
    return Lines(road, n, np.diff(force("Fy", values, road, turn_slip=True).reshape(-1, n)) < 0.0)


def _numbers(start: Mapping[str, float], measured: Mapping[str, float]) -> list[Number]:
    """The numbers with the table's bounds; camber stiffness has a weak prior at the measured one."""
    size = max(abs(measured.get("PKY6", 1.0)), constants.LEAST_CAMBER_STIFFNESS)
    spread = constants.CAMBER_STIFFNESS_TIE * size / constants.CAMBER_STIFFNESS_TIE_WEIGHT
    out = []
    for name, value in start.items():
        tied = name in CAMBER_STIFFNESS and name in measured
        prior = {"expected": measured[name], "spread": spread} if tied else {}
        row = BY_NAME[name]
        out.append(Number(name, row.inside(value), *row.bounds, **prior))
    return out
