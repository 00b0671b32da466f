"""Forwards-backwards alignment of the sideslip axis, (6)-(10)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from mffit.constants import USUAL_CORNERING_STIFFNESS
from mffit.errors import InputError
from mffit.measured import constants, wording
from mffit.measured.result import Alignment, AlignmentStep
from mffit.measured.zeros import LoadGroup, load_groups, u_of, zeros
from mffit.points import Points, main_path
from tir import Quantity, conventions


class AxisAtLoad(NamedTuple):
    """Results of the direct method at one load."""

    C_alpha: Quantity | None  #: measured cornering stiffness, ISO, negative [N/rad]
    F_forward: float  #: force at zero, corrected for the play [N]; NaN if not measured
    F_backward: float  #: [N]


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
    on_usual = points.phi_t == main_path(points)
    for group in load_groups(points):
        usual = group.of(on_usual[group.index])
        setup = points.setup[usual.index]
        usual = usual.of(setup == setup.max(initial=0))
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
    warnings = [
        wording.axis_off(step.load, difference, limit, abs(step.correction_deg))
        for step in found.last
        if (difference := abs(step.F_forward - step.F_backward)) > limit
    ]
    setups = np.unique(points.setup[on_usual])
    if len(setups) > 1:
        warnings.append(wording.last_is_aligned(points.setups[setups[-1]]))
    return replace(found, warnings=tuple(warnings))


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
    return float(np.linalg.norm(u_of(points, "Fy")[rows])) / len(rows)


def _elsewhere(known: AxisAtLoad | None, F_forward: float, F_backward: float) -> tuple[float, float] | None:
    """The report's zeros [N] where they differ visibly from these."""
    if known is None:
        return None
    there = (known.F_forward, known.F_backward)
    apart = [abs(a - b) for a, b in zip(there, (F_forward, F_backward), strict=True) if math.isfinite(a)]
    return there if apart and max(apart) > 0.1 else None
