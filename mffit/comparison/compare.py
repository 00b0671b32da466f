"""Comparison of two files, or of a file with measured points: numbers, curves and coefficients."""

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import chain
from typing import Any

import numpy as np

from mffit.comparison import constants, wording
from mffit.comparison.characteristics import DECIDED_BY, Tested, characteristics, with_slopes
from mffit.comparison.record import (
    ComparedSubject,
    Comparison,
    CurveGap,
    Difference,
    Shared,
    SweepGap,
    ranked,
)
from mffit.constants import STEPS_OF_LINE
from mffit.fit.plan import channels_of
from mffit.measured import LoadResult
from mffit.points import Points, levels, make_points
from mffit.points.noise import over_noise
from mffit.quantities import KEYS, SIDEWAYS
from mffit.rig import Readings, Simulation
from mffit.rounding import AtLeast
from mffit.scatter import rms
from mffit.tested import NOT_MEASURED, estimated
from tir.parameters import TABLE

CURVES = (("alpha", "ALPMAX", (*SIDEWAYS,)), ("gamma", "CAMMAX", (*SIDEWAYS,)), ("kappa", "kappa", ("Fx",)))
"""The varied quantity, the key of its range, and the channels whose curves are compared."""
OUTPUT_OF = {"r_e_m": "Re", **{key: by.channel for key, by in DECIDED_BY.items()}}
"""By number, the output of the model that it is read off."""
DIRECT_ROWS = ("epsilon_gamma", "C_phit", "C_gamma", "C_alpha", "F_phit")


def between(first: ComparedSubject, second: ComparedSubject) -> Comparison:
    """The comparison of two files, with covariance and build if known; effects of errors of a common rig cancel.

    It covers the ranges of both files, on a straight path, each at its own inflation pressure, as in a call without one.
    """
    tyres = (first.tyre, second.tyre)
    lower, upper = max(float(t["FZMIN"]) for t in tyres), min(float(t["FZMAX"]) for t in tyres)
    nominal = float(first.tyre["FNOMIN"])
    if not 0.0 < upper >= lower:  # the ranges have no load in common
        lower, upper = 0.0, np.inf
    within = (float(np.clip(share * nominal, lower, upper)) for share in constants.COMPARED_LOADS)
    loads = list(dict.fromkeys(within))
    tested, shared = Tested.of(tyres), _shared(first, second)
    reach = {key: min(float(t[key]) for t in tyres) for key in ("ALPMAX", "CAMMAX")}
    reach["kappa"] = tested.kappa
    numbers = [row for load in loads for row in _numbers(first, second, load, tested, shared)]
    curves = [gap for load in loads for gap in _curves(first, second, load, reach)]
    coefficients = _coefficients(first, second, shared)
    return Comparison(
        first=first.name,
        second=second.name,
        numbers=ranked(numbers),
        coefficients=coefficients,
        curves=tuple(curves),
        sweeps=(),
        notes=(
            *wording.notes_between(first, second, shared),
            *wording.notes_on_peaks(numbers, tested),
            *wording.notes_on_estimates(first.name, second.name, (*numbers, *coefficients)),
            *(wording.note_on_own_peaks(numbers) if first.build or second.build else ()),
        ),
        apart=wording.apart(first, second),
    )


def _shared(first: ComparedSubject, second: ComparedSubject) -> Shared:
    """The effects of rig errors on both sides, if one rig measured both; empty for different rigs."""
    if first.build is None or second.build is None or first.build.rig != second.build.rig:
        return {}
    a, b = first.build.moved_by, second.build.moved_by
    return {error: (a[error], b[error]) for error in a if error in b}


def _numbers(
    first: ComparedSubject,
    second: ComparedSubject,
    load: float,
    tested: Tested,
    shared: Shared,
) -> Iterator[Difference]:
    """Differences of the numbers of both files at a load [N]; the largest forces are those within the slip ``tested``."""
    found, moved = [], []
    for k, side in enumerate((first, second)):
        at: Any = {"turn_slip": side.turn_slip, "tested": tested}
        predictor = None if side.foretold is None else side.foretold[0]
        own = characteristics(side.tyre, load, known=side.known, predictor=predictor, **at)
        if side.build is not None and side.known is not None:
            own = {key: side.build.at_least_stated(key, q) for key, q in own.items()}
        found.append(own)
        moved.append(_moved(side, load, at, [pair[k] for pair in shared.values()]))
    a, b = found
    for key in a:
        if key in b:
            # To first order, the effect of rig errors may exceed the stated uncertainty; then it replaces it.
            u = [
                max(one[key].u, float(np.hypot.reduce(by[key], initial=0.0)))
                for one, by in zip(found, moved, strict=True)
            ]
            yield Difference(
                key=key,
                load=load,
                first=a[key].value,
                second=b[key].value,
                u_first=u[0] or None,
                u_second=u[1] or None,
                covariance=float(moved[0][key] @ moved[1][key]),
                at_least_first=isinstance(a[key], AtLeast),
                at_least_second=isinstance(b[key], AtLeast),
                estimated_first=_is_estimated(first, key, u[0]),
                estimated_second=_is_estimated(second, key, u[1]),
            )


def _is_estimated(side: ComparedSubject, key: str, u: float | None) -> bool:
    """Whether a side did not measure a number or coefficient: by the comments of its file, or as its build has no uncertainty."""
    output = OUTPUT_OF.get(key, "")
    by_file = output in estimated(side.tyre) or side.tyre.status.get(key, "").startswith(NOT_MEASURED)
    return by_file or (side.known is not None and not u)


def _moved(
    side: ComparedSubject, load: float, at: Mapping[str, Any], moves: Sequence[Mapping[str, float]]
) -> dict[str, np.ndarray]:
    """By number, its changes (e,) by given changes of the coefficients."""
    names = [name for name in dict.fromkeys(chain(*moves)) if name in side.tyre.values]
    found, slopes = with_slopes(side.tyre, load, names, **at)
    sizes = [[move.get(name, 0.0) for move in moves] for name in names]
    return dict(zip(found, slopes @ np.reshape(sizes, (len(names), len(moves))), strict=True))


def _curves(
    first: ComparedSubject, second: ComparedSubject, load: float, reach: Mapping[str, float]
) -> Iterator[CurveGap]:
    """The differences of the curves of Fy and Mz over sideslip and over camber, and of Fx over longitudinal slip."""
    for over, end, channels in CURVES:
        x = np.linspace(-abs(reach[end]), abs(reach[end]), STEPS_OF_LINE)
        alpha, gamma, kappa = (x if over == varied else 0.0 * x for varied in ("alpha", "gamma", "kappa"))
        (a, half_a), (b, half_b) = (
            _curve(side, (load, alpha, gamma, kappa), channels) for side in (first, second)
        )
        for channel in channels:
            yield CurveGap(
                channel=channel,
                over=over,
                load=load,
                x=x,
                first=a[channel],
                second=b[channel],
                half_first=half_a.get(channel),
                half_second=half_b.get(channel),
            )


def _curve(
    side: ComparedSubject, at: tuple[Any, Any, Any, Any], channels: Sequence[str]
) -> tuple[Readings, Mapping[str, np.ndarray]]:
    """Forces of a file at a load, sideslip, camber and slip, at its own pressure and speed, and half widths of known bands."""
    Fz, alpha, gamma, kappa = at
    pressure, speed = float(side.tyre["INFLPRES"]), float(side.tyre["LONGVL"])
    where = make_points(alpha, gamma, Fz, kappa=kappa, p=pressure, V=speed, phi_t=0.0)
    simulation = Simulation.of(side.tyre, turn_slip=side.turn_slip)
    band: Mapping[str, np.ndarray] = {}
    if side.foretold is not None:
        known, fitted = side.foretold
        band = known.band(simulation, Simulation.of(fitted, turn_slip=known.curved), where, channels)
    return simulation.readings(where, channels), band


def _coefficients(first: ComparedSubject, second: ComparedSubject, shared: Shared) -> tuple[Difference, ...]:
    """Differences of the coefficients that are not equal."""
    u_first, u_second = ({} if side.known is None else side.known.stderr for side in (first, second))
    names = [row.name for row in TABLE if row.kind == "number" and row.section.endswith("_COEFFICIENTS")]
    rows = [
        Difference(
            key=name,
            load=None,
            first=float(first.tyre[name]),
            second=float(second.tyre[name]),
            u_first=u_first.get(name),
            u_second=u_second.get(name),
            estimated_first=_is_estimated(first, name, u_first.get(name)),
            estimated_second=_is_estimated(second, name, u_second.get(name)),
            covariance=sum(x.get(name, 0.0) * y.get(name, 0.0) for x, y in shared.values()),
        )
        for name in names
        if first.tyre[name] != second.tyre[name]
    ]
    return ranked(rows)


def against_points(
    subject: ComparedSubject,
    simulation: Simulation,
    points: Points,
    measured: Sequence[LoadResult],
    simulated: Sequence[LoadResult],
    name: str,
) -> Comparison:
    """The comparison of a file, the first side, with measured points, the second side, of this ``name``.

    ``simulation`` is the file on the declared rig; ``measured`` and ``simulated`` are results of the direct method for the
    points and for simulated readings of the file.
    """
    return Comparison(
        first=subject.name,
        second=name,
        numbers=ranked(_direct(measured, simulated)),
        coefficients=(),
        curves=(),
        sweeps=_sweeps(points, simulation),
        notes=(wording.note_on_data(subject.name),),
        points=points,
        simulation=simulation,
    )


def _direct(measured: Sequence[LoadResult], simulated: Sequence[LoadResult]) -> list[Difference]:
    """Differences between the direct method's results for the file and for the data, at common loads."""
    return [
        Difference(key=KEYS[key], load=data.load, first=a.value, second=b.value, u_second=b.u)
        for data in measured
        for file in simulated
        if abs(math.log(file.load / data.load)) < levels.LOAD.tolerance
        for key in DIRECT_ROWS
        if (a := getattr(file, key)) is not None and (b := getattr(data, key)) is not None
    ]


def _sweeps(points: Points, simulation: Simulation) -> tuple[SweepGap, ...]:
    """The gap of every sweep and channel, the largest first, relative to the noise or else to the channel's rms."""
    readings = simulation.readings(points, channels_of(points))
    found: list[tuple[float, SweepGap]] = []
    for channel, read in readings.items():
        apart, u = points.channel(channel) - read, points.u(channel)
        size = max(rms(points.channel(channel)), 1e-9)
        for k in np.unique(points.sweep):
            rows = (points.sweep == k) & np.isfinite(apart)
            if not np.any(rows):
                continue
            known = u[rows][np.isfinite(u[rows])]
            over = over_noise(read, points.channel(channel), u, rows)
            gap = SweepGap(
                sweep=points.sweep_names[k],
                channel=channel,
                rms=rms(apart[rows]),
                bias=float(apart[rows].mean()),
                noise=float(np.median(known)) if len(known) else None,
                over_noise=over.ratio if over.n else None,
                n=int(rows.sum()),
            )
            found.append((gap.over_noise or gap.rms / size, gap))
    return tuple(gap for _, gap in sorted(found, key=lambda item: -item[0]))
