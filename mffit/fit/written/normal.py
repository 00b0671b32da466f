"""The derived files: one for simulations without turn slip, and one compromise for simulations with and without it."""

from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from mffit.fit import constants
from mffit.fit.by_hand import NO_HAND, Hand
from mffit.fit.constraints import limits
from mffit.fit.ranges import envelope
from mffit.fit.stages import ODD_TERMS, STAGES
from mffit.fit.written.road import Road, camber_lines, force, forces, road_grid, weights
from mffit.least_squares import FreeNumber, Linear, of_numbers, solve
from mffit.rig import Readings
from tir.derivatives import gradient, plain
from tir.parameters import BY_NAME

MISFIT_UNIT = {"Fy": constants.MISFIT_UNIT_FY, "Mz": constants.MISFIT_UNIT_MZ}
"""By channel, unit of the residual over nominal load [N/N, m]."""
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
    """The coefficients of a derived file that differ from the fitted model, which is meant for turn slip on.

    The file for turn slip off is fitted to the forces of the fitted model on a straight path over the written ranges. The file
    for both uses, if the curvature of the disc's path ``both_on`` [1/m] is given, is fitted with equal weight to three sets of
    forces: those, the same forces computed with turn slip, and the forces on the disc. Only coefficients that act through
    camber or spin are free, so the upright wheel on a straight path stays exact. Fy is fitted first, because its shifts enter
    Mz.

    ``symmetric`` holds the terms that a symmetric tyre does not have; ``hand`` has values and bounds set by hand, which apply
    to every file; ``weight`` is as in :func:`mffit.fit.written.road.weights`.
    """
    road = road_grid(tested, written, float(values["FNOMIN"]))
    uses = [(False, 0.0)] if both_on is None else [(True, both_on), (True, 0.0), (False, 0.0)]
    goals = [
        ForcesToReproduce(turn_slip, phi_t, forces(values, road, turn_slip=True, phi_t=phi_t))
        for turn_slip, phi_t in uses
    ]
    free = _free(both=both_on is not None, symmetric=symmetric)
    free = {channel: hand.without_held(names) for channel, names in free.items()}
    found = dict(values)
    for channel, names in free.items():
        imitation = _Imitation(channel, found, values, goals, road, weights(road, tested, weight), written)
        numbers = _numbers({name: float(values[name]) for name in names}, hand)
        found |= solve(of_numbers(names, imitation.at), numbers, tolerance=constants.REFIT_TOLERANCE).values
    return {name: found[name] for names in free.values() for name in names if found[name] != values[name]}


class ForcesToReproduce(NamedTuple):
    """Forces of the fitted model that a file should reproduce in one use."""

    turn_slip: bool  #: whether the file is evaluated with turn slip
    phi_t: float  #: turn slip of every condition, ISO sign [1/m]
    forces: Readings


class _Imitation(NamedTuple):
    """Least-squares problem for one channel of a file over its ranges."""

    channel: str  #: "Fy" or "Mz"
    fixed: Mapping[str, Any]  #: every value of the file
    model: Mapping[str, Any]  #: every value of the fitted model
    goals: Sequence[ForcesToReproduce]
    road: Road
    weight: np.ndarray  #: (n,) of the conditions
    written: Mapping[str, float]  #: ranges over which the physical limits hold

    def at(self, free: Mapping[str, Any]) -> Linear:
        """Residuals and limits, with derivatives by the free values if they are traced."""
        values, by = {**self.fixed, **free}, [x for x in free.values() if not isinstance(x, float)]
        unit = MISFIT_UNIT[self.channel] * float(self.fixed["FNOMIN"])
        factor = np.sqrt(self.weight / self.weight.sum()) / unit
        out = [
            force(self.channel, values, self.road, turn_slip=goal.turn_slip, phi_t=goal.phi_t)
            for goal in self.goals
        ]
        aims = [getattr(goal.forces, self.channel) for goal in self.goals]
        data = [(plain(one) - aim) * factor for one, aim in zip(out, aims, strict=True)]
        slopes = [gradient(one, by) * factor[:, None] for one in out]
        over, over_slope = limits(SimpleNamespace(**values), envelope(self.written), by)
        held, held_slope = self._reversal(values, by)
        weight = constants.LIMIT_WEIGHT_OF_DERIVED_FILE
        return Linear(
            np.concatenate(data),
            np.concatenate(slopes),
            np.concatenate([weight * over, held / unit]),
            np.concatenate([weight * over_slope, held_slope / unit]),
        )

    def _reversal(self, values: Mapping[str, Any], by: list[Any]) -> tuple[np.ndarray, np.ndarray]:
        """Steps of Fy along lines of camber with their derivatives: a step counts where the model's Fy falls, else it is 0.

        Positive where Fy of the file rises although Fy of the model falls.
        """
        if self.channel != "Fy":
            return np.zeros(0), np.zeros((0, len(by)))
        road, n = camber_lines(self.written)
        falls = np.diff(force("Fy", self.model, road, turn_slip=True).reshape(-1, n)) < 0.0
        Fy = force("Fy", values, road, turn_slip=False)
        steps = np.diff(plain(Fy).reshape(-1, n))
        slope = np.diff(gradient(Fy, by).reshape(*falls.shape[:1], n, len(by)), axis=1)
        return np.where(falls, steps, 0.0).ravel(), slope.reshape(steps.size, len(by))


def _free(*, both: bool, symmetric: bool) -> dict[str, list[str]]:
    """By channel, the free coefficients."""
    absent = ODD_TERMS if symmetric else frozenset()
    out = {}
    for channel, camber in (("Fy", CAMBER_FORCE), ("Mz", CAMBER_MOMENT)):
        spin = [name for name in SPIN if both and BY_NAME[name].channel == channel]
        out[channel] = [name for name in (*camber, *spin) if name not in absent]
    return out


def _numbers(start: Mapping[str, float], hand: Hand) -> list[FreeNumber]:
    """The free numbers, bounded by their usual ranges, which are widened to the starting values."""
    out = []
    for name, value in start.items():
        lower, upper = hand.bounded.get(name, BY_NAME[name].usual)
        begin = hand.inside(name, value)
        out.append(FreeNumber(name, begin, min(lower, begin), max(upper, begin)))
    return out
