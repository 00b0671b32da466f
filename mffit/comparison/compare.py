"""Comparing: numbers, curves and coefficients of two files, or a file with the points of a rig."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from mffit.comparison.characteristics import characteristics, with_u
from mffit.comparison.record import Comparison, CurveGap, Difference, Subject, SweepGap, ranked
from mffit.fit import Posterior
from mffit.measured import KEYS, LoadResult
from mffit.points import Points, make_points
from mffit.quantities import CHANNELS
from mffit.rig import Simulation
from mffit.scatter import rms
from tir.parameters import TABLE

LOADS = (0.6, 1.0, 1.4)
"""Loads of the numbers and curves over the nominal one, as far as both files' ranges go."""
STEPS = 61
DIRECT_ROWS = ("epsilon_gamma", "C_phit", "C_gamma", "C_alpha", "F_phit")


def between(first: Subject, second: Subject) -> Comparison:
    """Compare two files.

    Parameters
    ----------
    first, second : with the covariance of their numbers where a build says it; both are taken as independent

    Returns
    -------
    Comparison
        On the ranges that both files allow, on a straight path, at the first one's nominal pressure.
    """
    a, b = first.tyre, second.tyre
    nominal = float(a["FNOMIN"])
    lower, upper = max(float(t["FZMIN"]) for t in (a, b)), min(float(t["FZMAX"]) for t in (a, b))
    loads = list(dict.fromkeys(float(np.clip(share * nominal, lower, upper)) for share in LOADS))
    pressure = float(a["NOMPRES"])
    reach = {key: min(float(t[key]) for t in (a, b)) for key in ("ALPMAX", "CAMMAX")}
    numbers = []
    for load in loads:
        sides = [
            with_u(
                side.tyre, side.names, side.covariance,
                partial(characteristics, load=load, turn_slip=side.turn_slip, pressure=pressure, reach=reach["ALPMAX"]),
            )
            for side in (first, second)
        ]  # fmt: skip
        for key in sides[0][0]:
            if key in sides[1][0]:
                a_value, b_value = (side[0][key] for side in sides)
                u_a, u_b = (side[1].get(key) for side in sides)
                numbers.append(Difference(key, load, a_value, b_value, u_a, u_b))
    curves = [gap for load in loads for gap in _curves(first, second, load, pressure, reach)]
    return Comparison(
        first.name, second.name, ranked(numbers), _coefficients(first, second), tuple(curves), (), _notes(first, second)
    )  # fmt: skip


def _curves(
    first: Subject, second: Subject, load: float, pressure: float, reach: Mapping[str, float]
) -> list[CurveGap]:
    out = []
    for over, end in (("alpha", "ALPMAX"), ("gamma", "CAMMAX")):
        x = np.linspace(-reach[end], reach[end], STEPS)
        angles = (x, 0.0 * x) if over == "alpha" else (0.0 * x, x)
        where = make_points(*angles, load, p=pressure, V=float(first.tyre["LONGVL"]), phi_t=0.0)
        sides = [_curve(side, where) for side in (first, second)]
        for k, channel in enumerate(CHANNELS):
            values, halves = [side[0][k] for side in sides], [side[1] and side[1][k] for side in sides]
            out.append(CurveGap(channel, over, load, x, *values, *halves))
    return out


def _curve(side: Subject, where: Points) -> tuple[Sequence[np.ndarray], tuple[np.ndarray, np.ndarray] | None]:
    simulation = Simulation.of(side.tyre, turn_slip=side.turn_slip)
    band = None
    if side.covariance is not None:
        band = Posterior(side.names, side.covariance).band(simulation, where)
    return simulation.readings(where), band


def _coefficients(first: Subject, second: Subject) -> tuple[Difference, ...]:
    """Coefficients that differ."""
    errors = [
        {}
        if s.covariance is None
        else dict(zip(s.names, np.sqrt(np.diag(s.covariance)).tolist(), strict=True))
        for s in (first, second)
    ]
    rows = []
    for row in TABLE:
        if row.kind != "number" or not row.section.endswith("_COEFFICIENTS"):
            continue
        a, b = float(first.tyre[row.name]), float(second.tyre[row.name])
        if a != b:
            rows.append(Difference(row.name, None, a, b, *(e.get(row.name) for e in errors)))
    return ranked(rows)


def _notes(first: Subject, second: Subject) -> tuple[str, ...]:
    out = []
    if first.turn_slip != second.turn_slip:
        on, off = (first, second) if first.turn_slip else (second, first)
        out.append(
            f"{on.name} is for simulations with turn slip on, {off.name} for turn slip off; each is evaluated as it is meant."
        )
    unknown = [side for side in (first, second) if side.covariance is None]
    bare = [side.name for side in unknown if not side.told_of]
    if bare:
        out.append(
            f"Nothing tells how uncertain {' or '.join(bare)} is: result.json of a build beside the file would."
        )
    out += [
        f"How uncertain {side.name} is, is not told: the covariance in the result.json beside it belongs to {side.told_of}."
        for side in unknown
        if side.told_of
    ]
    if not unknown and len({first.name, second.name}) == 2:
        shared = first.rig is not None and first.rig == second.rig
        out.append(
            "Both sides count as independent"
            + (
                "; both builds are of one rig, whose errors are counted twice, so differences stand out more than stated."
                if shared
                else "."
            )
        )
    return tuple(out)


def against_points(
    subject: Subject,
    simulation: Simulation,
    points: Points,
    measured: Sequence[LoadResult],
    simulated: Sequence[LoadResult],
    name: str,
) -> Comparison:
    """Compare a file with measured points.

    Parameters
    ----------
    subject : the file, the first side
    simulation : the file on the rig as it is declared
    points : the data, the second side
    measured : what the direct method finds in the points
    simulated : what it finds in the readings that the rig would give of the file
    name : of the data
    """
    readings = simulation.readings(points)
    sweeps = []
    for channel in CHANNELS:
        apart = getattr(points, channel) - getattr(readings, channel)
        u = getattr(points, f"u_{channel}")
        for k in np.unique(points.sweep):
            rows = (points.sweep == k) & np.isfinite(apart)
            if np.any(rows):
                known = u[rows][np.isfinite(u[rows])]
                noise = float(np.median(known)) if len(known) else None
                found = apart[rows]
                sweeps.append(
                    SweepGap(
                        points.sweep_names[k], channel, rms(found), float(found.mean()), noise, len(found)
                    )
                )
    numbers = [
        Difference(KEYS[key], data.load, a.value, b.value, None, b.u)
        for data in measured
        for file in simulated
        if abs(file.load / data.load - 1.0) < 0.02
        for key in DIRECT_ROWS
        if (a := getattr(file, key)) is not None and (b := getattr(data, key)) is not None
    ]
    size = {channel: max(rms(getattr(points, channel)[np.isfinite(getattr(points, channel))]), 1e-9)
            for channel in CHANNELS if np.any(np.isfinite(getattr(points, channel)))}  # fmt: skip
    worst = sorted(sweeps, key=lambda gap: -gap.rms / (gap.noise or size[gap.channel]))
    notes = (
        f"The numbers of {subject.name} are what the direct method finds in what the rig would read of it at these very points.",
    )
    return Comparison(
        subject.name, name, ranked(numbers), (), (), tuple(worst), notes, points=points, simulation=simulation
    )
