"""Forwards-backwards alignment of the sideslip axis, (6)-(10)."""

import math
from collections.abc import Iterator, Mapping

import numpy as np
from uncertainties import UFloat, ufloat

from mffit.errors import InputError
from mffit.measured import wording
from mffit.measured.axis import usual_stiffness
from mffit.measured.result import Alignment, AlignmentStep
from mffit.measured.zeros import WAYS, LoadGroup, force_at_zero, load_groups
from mffit.points import Points, main_path
from tir import Quantity, conventions


def align(
    points: Points,
    *,
    axes: str = "iso",
    measured: Mapping[float, Quantity] | None = None,
    resolution_deg: float = 0.0,
) -> Alignment:
    """The next correction of the sideslip axis, in the rig's ``axes``, from forward and backward zeros.

    The points are corrected for the play and have rows at zero sideslip and camber in both directions; ``iteration`` numbers
    repeated steps. If the usual path has several set-ups, the last one is aligned. ``measured`` is the cornering stiffness by
    load [N], used if its relative uncertainty is the smallest; otherwise it is that of two steps or the usual one. The axis
    can be turned in steps of ``resolution_deg`` [deg].

    Raises InputError if zeros of one direction are missing.
    """
    steps: list[AlignmentStep] = []
    on_usual = points.phi_t == main_path(points)
    for group in load_groups(points):
        usual = group.of(on_usual[group.index])
        setup = points.setup[usual.index]
        usual = usual.of(setup == setup.max(initial=0))
        steps += _steps(points, usual, axes, (measured or {}).get(group.load))
    if not steps:
        raise InputError(
            "no load has both forward and backward points at zero sideslip and camber: add rows with direction "
            "forward and backward"
        )
    setups = np.unique(points.setup[on_usual])
    last = [wording.LAST_IS_ALIGNED.format(name=points.setups[setups[-1]])] if len(setups) > 1 else []
    return Alignment(tuple(steps), tuple(last), resolution_deg)


def _steps(points: Points, group: LoadGroup, axes: str, measured: Quantity | None) -> Iterator[AlignmentStep]:
    """The iterations at one load, on one path and in one set-up."""
    guessed = usual_stiffness(group.load)
    known = [] if measured is None else [("measured", ufloat(measured.value, measured.u))]
    iteration = np.nan_to_num(points.iteration[group.index], nan=1.0).astype(int)
    before: tuple[UFloat, float] | None = None  # slip force, and the correction that was then applied [rad]
    for k in np.unique(iteration).tolist():
        own = group.of(iteration == k)
        slope = known[0][1].nominal_value if known else guessed.nominal_value
        forward, backward = (force_at_zero(points, own, way, slope) for way in WAYS)
        if forward is None or backward is None:
            continue
        slip = (forward - backward) / 2.0  # (7)
        candidates = [("guess", guessed)]
        if before is not None and abs(before[1]) > 1e-9:
            secant = (slip - before[0]) / before[1]  # (9)
            if secant.nominal_value < 0.0:
                candidates = [("secant", secant)]
        source, C_alpha = min(
            [*candidates, *known], key=lambda one: abs(one[1].std_dev / one[1].nominal_value)
        )
        correction = -slip / C_alpha  # (8), (10)
        before = (slip, correction.nominal_value)
        yield AlignmentStep(
            load=group.load,
            iteration=k,
            F_forward=forward.nominal_value,
            F_backward=backward.nominal_value,
            F_turn_slip=(forward.nominal_value + backward.nominal_value) / 2.0,  # (6)
            F_slip=slip.nominal_value,
            C_alpha=C_alpha.nominal_value,
            correction_deg=conventions.from_iso(axes, "alpha", math.degrees(before[1])),
            source=source,
            u_deg=math.degrees(correction.std_dev),
        )
