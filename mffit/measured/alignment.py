"""Forwards-backwards alignment of the sideslip axis, (6)-(10)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from mffit.brief import Brief
from mffit.constants import USUAL_CORNERING_STIFFNESS, USUAL_U_FORCE
from mffit.errors import InputError
from mffit.measured import constants, notes, setup_notes
from mffit.measured.groups import LoadGroup, last_setup, load_groups, zeros
from mffit.measured.ply_steer import usual_ply_steer
from mffit.points import Points, main_path
from tir import Quantity, conventions


class AxisAtLoad(NamedTuple):
    """Results of the direct method at one load."""

    C_alpha: Quantity | None  #: measured cornering stiffness, ISO, negative [N/rad]
    F_forward: float  #: force at zero, corrected for the play [N]; NaN if not measured
    F_backward: float  #: [N]


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
    source: str  #: of C_alpha: "measured" from a sideslip sweep, "secant" of two iterations (9), or "guess"
    u_deg: float  #: standard uncertainty of the correction
    reported: tuple[float, float] | None = None  #: the same zeros in the report, where these differ [N]

    @property
    def secant(self) -> bool:
        """Whether C_alpha is from two iterations."""
        return self.source == "secant"


@dataclass(frozen=True, slots=True, repr=False)
class Alignment(Brief):
    """All steps, in the order of loads and iterations."""

    steps: tuple[AlignmentStep, ...]
    warnings: tuple[str, ...]
    resolution_deg: float = field(default=constants.AXIS_RESOLUTION)

    @property
    def last(self) -> tuple[AlignmentStep, ...]:
        """The last iteration at every load."""
        return tuple({step.load: step for step in self.steps}.values())

    @property
    def correction_deg(self) -> float:
        """The next correction: mean over loads of the last iteration, weighted by stiffness."""
        return float(self._weights() @ [step.correction_deg for step in self.last])

    @property
    def u_deg(self) -> float:
        """Its standard uncertainty."""
        return float(np.linalg.norm(self._weights() * [step.u_deg for step in self.last]))

    @property
    def u_axis_deg(self) -> float:
        """Standard uncertainty of the axis's own misalignment, of which ply-steer takes an unknown part."""
        return math.hypot(self.u_deg, math.degrees(usual_ply_steer()))

    @property
    def aligned(self) -> bool:
        """Whether the correction is within its uncertainty, or below the resolution of the axis."""
        return abs(self.correction_deg) <= max(self.u_deg, self.resolution_deg)

    def _weights(self) -> np.ndarray:
        stiffness = np.array([abs(step.C_alpha) for step in self.last])
        return stiffness / stiffness.sum()


def align(
    points: Points,
    *,
    axes: str = "iso",
    C_alpha: float | None = None,
    measured: Mapping[float, AxisAtLoad] | None = None,
    resolution_deg: float = constants.AXIS_RESOLUTION,
) -> Alignment:
    """Next correction of the sideslip axis from forward and backward zeros.

    Parameters
    ----------
    points : with rows at zero sideslip and camber rolled both ways; ``iteration`` numbers repeated steps. Of several set-ups
        on the usual path the last one is aligned
    axes : the rig's axes, in which the correction is returned
    C_alpha : cornering stiffness per load [1/rad], positive, where none is measured; default 10
    measured : results of the direct method by load [N]; its stiffness is used where its uncertainty is smallest
    resolution_deg : smallest angle by which the axis can be turned [deg]

    Raises
    ------
    InputError
        If zeros of one direction are missing.
    """
    steps: list[AlignmentStep] = []
    for group in load_groups(points):
        usual = last_setup(
            points, LoadGroup(group.load, group.index[points.phi_t[group.index] == main_path(points)])
        )
        steps += _steps(
            points, usual, axes, C_alpha or USUAL_CORNERING_STIFFNESS, (measured or {}).get(group.load)
        )
    if not steps:
        raise InputError(
            "no load has both forward and backward points at zero sideslip and camber: add rows with direction "
            "forward and backward"
        )
    found = Alignment(tuple(steps), (), resolution_deg)
    limit = constants.LARGEST_DIFFERENCE
    off = (
        notes.axis_off(step.load, difference, limit, abs(step.correction_deg))
        for step in found.last
        if (difference := abs(step.F_forward - step.F_backward)) > limit
    )
    return replace(found, warnings=(*off, *_of_setup(points)))


def _of_setup(points: Points) -> list[str]:
    """A sentence on the set-up that is aligned, if the usual path was run in several."""
    usual = np.unique(points.setup[points.phi_t == main_path(points)])
    return [setup_notes.last_is_aligned(points.setups[usual[-1]])] if len(usual) > 1 else []


class _Stiffness(NamedTuple):
    value: float  #: ISO, negative [N/rad]
    u: float
    source: str


def _steps(
    points: Points, group: LoadGroup, axes: str, guess: float, known: AxisAtLoad | None
) -> list[AlignmentStep]:
    forward, backward = zeros(points, group, 1), zeros(points, group, -1)
    iteration = np.nan_to_num(points.iteration, nan=1.0)
    guessed = _Stiffness(-guess * group.load, constants.GUESSED_STIFFNESS_U * guess * group.load, "guess")
    out: list[AlignmentStep] = []
    before: tuple[float, float, float] | None = None  # slip force, its u, correction then applied [rad]
    for k in np.unique(iteration[np.concatenate([forward, backward])].astype(int)):
        f, b = forward[iteration[forward] == k], backward[iteration[backward] == k]
        if not len(f) or not len(b):
            continue
        F_f, F_b = float(np.mean(points.Fy[f])), float(np.mean(points.Fy[b]))
        F_slip, u_slip = (F_f - F_b) / 2.0, math.hypot(_u(points, f), _u(points, b)) / 2.0  # (7)
        candidates = [guessed]
        if before is not None and abs(before[2]) > 1e-9:
            secant = (F_slip - before[0]) / before[2]  # (9)
            if secant < 0.0:
                candidates = [_Stiffness(secant, math.hypot(u_slip, before[1]) / abs(before[2]), "secant")]
        if known is not None and known.C_alpha is not None:
            candidates.append(_Stiffness(known.C_alpha.value, known.C_alpha.u, "measured"))
        C = min(candidates, key=lambda c: c.u / abs(c.value))
        correction = -F_slip / C.value  # (8), (10)
        u = math.hypot(u_slip, correction * C.u) / abs(C.value)
        out.append(
            AlignmentStep(
                load=group.load,
                iteration=int(k),
                F_forward=F_f,
                F_backward=F_b,
                F_turn_slip=(F_f + F_b) / 2.0,
                F_slip=F_slip,
                C_alpha=C.value,
                correction_deg=conventions.from_iso(axes, "alpha", math.degrees(correction)),
                source=C.source,
                u_deg=math.degrees(u),
                reported=_elsewhere(known, F_f, F_b),
            )
        )
        before = (F_slip, u_slip, correction)
    return out


def _u(points: Points, rows: np.ndarray) -> float:
    """Standard uncertainty of the mean force of some points [N]."""
    u = np.where(np.isfinite(points.u_Fy[rows]), points.u_Fy[rows], USUAL_U_FORCE)
    return float(np.linalg.norm(u)) / len(rows)


def _elsewhere(known: AxisAtLoad | None, F_forward: float, F_backward: float) -> tuple[float, float] | None:
    """The report's zeros [N] where they differ visibly from these."""
    if known is None:
        return None
    there = (known.F_forward, known.F_backward)
    apart = [abs(a - b) for a, b in zip(there, (F_forward, F_backward), strict=True) if math.isfinite(a)]
    return there if apart and max(apart) > 0.1 else None
