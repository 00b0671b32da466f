"""The derived files: for simulations without turn slip, and the one file that serves both kinds at a common misfit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

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
FORCE_STARTS: tuple[Mapping[str, float], ...] = ({}, {"PEY5": -3.0, "PDY3": 0.3}, {"PVY3": -0.5, "PDY3": 1.0})
MOMENT_STARTS: tuple[Mapping[str, float], ...] = (
    {},
    {"QDZ4": -1.0, "QEZ5": -2.0},
    {"QBZ5": 0.8, "QEZ5": 2.0},
)
TIE = 0.1
"""Spread of the measured camber stiffness as PKY6 and PKY7 see it, relative."""
TIE_SHARE = 0.03
"""Weight of that tie beside the whole grid."""


def derive_normal(
    values: Mapping[str, Any],
    tested: Mapping[str, float],
    written: Mapping[str, float],
    measured: Mapping[str, float],
    *,
    symmetric: bool = False,
) -> dict[str, float]:
    """Coefficients of the file for turn slip off, where they differ from the fitted model.

    The target is the fitted model on a straight path, turn slip on, on a grid over the written ranges. Only coefficients
    that act through camber move, so that the upright wheel stays exact. First those of Fy, then those of Mz, which sees
    the shifts of Fy. Several starts on a coarse grid, the best of them finished on the fine one.

    Parameters
    ----------
    values : the fitted model, right with turn slip on
    tested, written : ranges of the data and of the file, by name of the file's limits
    measured : PKY6 and PKY7 of the measured camber stiffness, from :func:`mffit.fit.start.camber_stiffness_terms`; may be empty
    symmetric : hold the terms that a symmetric tyre does not have
    """

    def goals(road: Road) -> tuple[Goal, ...]:
        return (goal(values, road, weights(road, tested), turn_slip=False),)

    return _derived(
        values, tested, written, measured, goals, (CAMBER_FORCE, CAMBER_MOMENT), symmetric=symmetric
    )


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

    Three goals count alike: the fitted model on the disc and on a straight path, both with turn slip, and on a straight
    path without. Camber and turn-slip coefficients move; the upright wheel on a straight path stays exact.

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

    by_channel = [[n for n in SPIN if BY_NAME[n].channel == channel] for channel in CHANNELS]
    free = ((*CAMBER_FORCE, *by_channel[0]), (*CAMBER_MOMENT, *by_channel[1]))
    return _derived(values, tested, written, measured, goals, free, symmetric=symmetric)


def _derived(values, tested, written, measured, goals, free, *, symmetric: bool) -> dict[str, float]:
    """The values that imitate the goals, of Fy first and then of Mz, where they differ from the model's."""
    coarse, fine = (
        road_grid(tested, written, float(values["FNOMIN"]), dense=dense) for dense in (False, True)
    )
    found = dict(values)
    for channel, names, starts in zip(CHANNELS, free, (FORCE_STARTS, MOMENT_STARTS), strict=True):
        moving = [n for n in names if not (symmetric and n in ODD_TERMS)]
        lines = _lines(values, written) if channel == "Fy" else None
        on_coarse, on_fine = (
            Imitation(channel, dict(found), goals(road), envelope(written), lines) for road in (coarse, fine)
        )
        begun = {name: measured.get(name, float(values[name])) for name in moving}
        tried = [
            on_coarse.solve(_numbers({**begun, **start}, measured), steps=25, tolerance=1e-3)
            for start in starts
        ]
        best = min(tried, key=lambda end: end.cost)
        found.update(on_fine.solve(_numbers(best.values, measured), steps=30, tolerance=1e-4).values)
    return {name: found[name] for names in free for name in names if found[name] != values[name]}


def _lines(values: Mapping[str, Any], written: Mapping[str, float]) -> Lines:
    road, n = camber_lines(written)
    return Lines(road, n, np.diff(force("Fy", values, road, turn_slip=True).reshape(-1, n)) < 0.0)


def _numbers(start: Mapping[str, float], measured: Mapping[str, float]) -> Sequence[Number]:
    """The numbers with the table's bounds, camber stiffness softly tied to the measured one."""
    spread = TIE * max(abs(measured.get("PKY6", 1.0)), 0.1) / TIE_SHARE
    out = []
    for name, value in start.items():
        tied = (
            {"expected": measured[name], "spread": spread}
            if name in CAMBER_STIFFNESS and name in measured
            else {}
        )
        row = BY_NAME[name]
        out.append(Number(name, row.inside(value), *row.bounds, **tied))
    return out
