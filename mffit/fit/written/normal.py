"""The derived files: one for simulations without turn slip, and one that serves both uses at a common misfit."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from mffit.fit.by_hand import NO_HAND, Hand
from mffit.fit.ranges import envelope
from mffit.fit.stages import ODD_TERMS, STAGES
from mffit.fit.written.imitation import ForcesToReproduce, Imitation, Lines, force, goal
from mffit.fit.written.road import Road, camber_lines, road_grid, weights
from mffit.least_squares import FreeNumber
from tir.parameters import BY_NAME

CAMBER_STIFFNESS = ("PKY6", "PKY7")
CAMBER_FORCE = ("PKY3", "PKY5", "PDY3", "PVY3", "PVY4", "PEY4", "PEY5", *CAMBER_STIFFNESS)
CAMBER_MOMENT = (
    "QDZ3", "QDZ4", "QDZ8", "QDZ9", "QDZ10", "QDZ11", "QBZ4", "QBZ5", "QEZ5", "QHZ3", "QHZ4"
)  # fmt: skip
SPIN = next(stage.parameters for stage in STAGES if stage.name == "spin")


def derive(
    values: Mapping[str, Any],
    tested: Mapping[str, float],
    written: Mapping[str, float],
    *,
    both_on: float | None = None,
    symmetric: bool = False,
    hand: Hand = NO_HAND,
    weight: str = "everything",
) -> dict[str, float]:
    """Coefficients of a derived file, where they differ from the fitted model.

    The goal of the file for turn slip off is the fitted model on a straight path over the written ranges. The file for both
    uses has three goals of equal weight: the same, the model on a straight path reproduced with turn slip, and the model
    on the disc. Only coefficients that act through camber or spin are free, so that the upright wheel on a straight path stays
    exact. Fy comes first, because its shifts enter Mz.

    Parameters
    ----------
    values : the fitted model, meant for turn slip on
    tested, written : ranges of the data and of the file, by name of the file's limits
    both_on : for the file for both uses, curvature of the disc's path [1/m]; None for the file for turn slip off
    symmetric : hold the terms that a symmetric tyre does not have
    hand : coefficients that are held in every file, and bounds that every file keeps
    weight : "everything" or "road", see :func:`mffit.fit.written.road.weights`
    """
    goals = _goals(values, road_grid(tested, written, float(values["FNOMIN"])), tested, both_on, weight)
    free = _free(both=both_on is not None, symmetric=symmetric)
    free = {channel: hand.without_held(names) for channel, names in free.items()}
    found = dict(values)
    for channel, names in free.items():
        limits = (envelope(written), _lines(values, written) if channel == "Fy" else None)
        numbers = _numbers({name: float(values[name]) for name in names}, hand)
        found |= Imitation(channel, found, goals, *limits).solve(numbers).values
    return {name: found[name] for names in free.values() for name in names if found[name] != values[name]}


def _goals(
    values: Mapping[str, Any],
    road: Road,
    tested: Mapping[str, float],
    both_on: float | None,
    kind: str,
) -> tuple[ForcesToReproduce, ...]:
    weight = weights(road, tested, kind)
    without = goal(values, road, weight, turn_slip=False)
    if both_on is None:
        return (without,)
    return (
        goal(values, road, weight, turn_slip=True, phi_t=both_on),
        goal(values, road, weight, turn_slip=True),
        without,
    )


def _free(*, both: bool, symmetric: bool) -> dict[str, list[str]]:
    """By channel, the free coefficients."""
    absent = ODD_TERMS if symmetric else frozenset()
    out = {}
    for channel, camber in (("Fy", CAMBER_FORCE), ("Mz", CAMBER_MOMENT)):
        spin = [name for name in SPIN if both and BY_NAME[name].channel == channel]
        out[channel] = [name for name in (*camber, *spin) if name not in absent]
    return out


def _lines(values: Mapping[str, Any], written: Mapping[str, float]) -> Lines:
    """The lines of camber and where the model's side force falls along them."""
    road, n = camber_lines(written)
    return Lines(road, n, np.diff(force("Fy", values, road, turn_slip=True).reshape(-1, n)) < 0.0)


def _numbers(start: Mapping[str, float], hand: Hand) -> list[FreeNumber]:
    """The numbers within their usual ranges, or as far as they start."""
    out = []
    for name, value in start.items():
        lower, upper = hand.bounded.get(name, BY_NAME[name].usual)
        begin = hand.inside(name, value)
        out.append(FreeNumber(name, begin, min(lower, begin), max(upper, begin)))
    return out
