"""Forwards-backwards alignment of the sideslip axis, (6)-(10)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from mffit.brief import Brief
from mffit.errors import InputError
from mffit.measured import wording
from mffit.measured.groups import load_groups, zeros
from mffit.measured.notes import AxisOff
from mffit.points import Points
from tir import conventions

FIRST_GUESS = 10.0
"""Cornering stiffness per load of a motorcycle tyre [1/rad], the paper's guess for the first step."""
LARGEST_DIFFERENCE = 50.0
"""|F_forward - F_backward| [N] above which the axis counts as not aligned."""


@dataclass(frozen=True, slots=True)
class AlignmentStep:
    """One iteration at one load."""

    load: float  #: [N]
    iteration: int
    F_forward: float  #: mean of the forward zeros, ISO [N]
    F_backward: float  #: [N]
    F_turn_slip: float  #: (6) [N]
    F_slip: float  #: (7) [N]
    C_alpha: float  #: used for the correction, ISO, negative [N/rad]
    correction_deg: float  #: next correction of the steering reading, in degrees of the rig's axis
    secant: bool  #: C_alpha from two iterations (9), not the guess


@dataclass(frozen=True, slots=True, repr=False)
class Alignment(Brief):
    """All steps, in the order of loads and iterations."""

    steps: tuple[AlignmentStep, ...]
    warnings: tuple[str, ...]

    @property
    def correction_deg(self) -> float:
        """The correction to apply now: mean over loads of the last iteration's, weighted with the stiffness."""
        last = {step.load: step for step in self.steps}
        weight = np.array([abs(step.C_alpha) for step in last.values()])
        return float(np.average([step.correction_deg for step in last.values()], weights=weight))


def align(points: Points, *, axes: str = "iso", C_alpha: float | None = None) -> Alignment:
    """Next correction of the sideslip axis from forward and backward zeros.

    Parameters
    ----------
    points : with rows at zero sideslip and camber rolled both ways; ``iteration`` numbers repeated steps
    axes : the rig's axes, in which the correction is returned
    C_alpha : cornering stiffness per load [1/rad], positive; default 10

    Raises
    ------
    InputError
        If zeros of one direction are missing.
    """
    steps: list[AlignmentStep] = []
    for group in load_groups(points):
        steps += _steps(points, group, axes, C_alpha or FIRST_GUESS)
    if not steps:
        raise InputError(
            "no load has both forward and backward points at zero sideslip and camber: add rows with direction "
            "forward and backward"
        )
    last = {step.load: step for step in steps}.values()
    off = [
        AxisOff(
            step.load, abs(step.F_forward - step.F_backward), LARGEST_DIFFERENCE, abs(step.correction_deg)
        )
        for step in last
        if abs(step.F_forward - step.F_backward) > LARGEST_DIFFERENCE
    ]
    return Alignment(tuple(steps), tuple(map(wording.warning, off)))


def _steps(points: Points, group, axes: str, guess: float) -> list[AlignmentStep]:
    forward, backward = zeros(points, group, 1), zeros(points, group, -1)
    iteration = np.nan_to_num(points.iteration, nan=1.0)
    out: list[AlignmentStep] = []
    before: tuple[float, float] | None = None  # (slip force, correction then applied [rad])
    for k in np.unique(iteration[np.concatenate([forward, backward])].astype(int)):
        f, b = forward[iteration[forward] == k], backward[iteration[backward] == k]
        if not len(f) or not len(b):
            continue
        F_f, F_b = float(np.mean(points.Fy[f])), float(np.mean(points.Fy[b]))
        F_slip = (F_f - F_b) / 2.0  # (7)
        C, secant = -guess * group.load, False
        if before is not None and abs(before[1]) > 1e-9:
            found = (F_slip - before[0]) / before[1]  # (9)
            if found < 0.0:
                C, secant = found, True
        correction = -F_slip / C  # (8), (10)
        rig = conventions.from_iso(axes, "alpha", math.degrees(correction))
        out.append(AlignmentStep(group.load, int(k), F_f, F_b, (F_f + F_b) / 2.0, F_slip, C, rig, secant))
        before = (F_slip, correction)
    return out
