"""Ranges of load, pressure, sideslip and camber: those of the data, and those written to the file."""

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np

from mffit.constants import UPRIGHT
from mffit.fit import constants
from mffit.fit.constraints import Envelope, characteristics, grid, violations
from mffit.points import Points, levels
from tir.constants import SIDESLIP_BEYOND_PEAK
from tir.evaluate import evaluate

NAMES = ("PRESMIN", "PRESMAX", "FZMIN", "FZMAX", "ALPMIN", "ALPMAX", "CAMMIN", "CAMMAX")


def tested_ranges(points: Points) -> dict[str, float]:
    """FZ, ALP, CAM and PRES limits [N, rad, Pa] of the set-points, and KPU limits if longitudinal slip was run."""
    driven = not np.all(points.free_rolling)
    slip = {"KPUMIN": float(np.min(points.kappa)), "KPUMAX": float(np.max(points.kappa))} if driven else {}
    alpha, gamma = float(np.max(np.abs(points.alpha))), float(np.max(np.abs(points.gamma)))
    return {
        "PRESMIN": float(np.min(points.p)),
        "PRESMAX": float(np.max(points.p)),
        "FZMIN": float(np.min(points.Fz)),
        "FZMAX": float(np.max(points.Fz)),
        "ALPMIN": -alpha,
        "ALPMAX": alpha,
        "CAMMIN": -gamma,
        "CAMMAX": gamma,
        **{name: min(x, 0.0) if name == "KPUMIN" else max(x, 0.0) for name, x in slip.items()},
    }


def sideslips_with_slip(points: Points) -> tuple[float, ...]:
    """Sideslips [rad] at which longitudinal slip was run, in rising order; empty if none was run."""
    held = levels.level_values(points.alpha[~points.free_rolling], levels.SIDESLIP)
    return tuple(np.unique(held[np.isfinite(held)]).tolist())


def single_pressure(ranges: Mapping[str, float]) -> bool:
    """Whether only one pressure was run."""
    return ranges["PRESMAX"] - ranges["PRESMIN"] < levels.PRESSURE.tolerance


def single_load(ranges: Mapping[str, float]) -> bool:
    """Whether only one load was run."""
    return ranges["FZMAX"] < (1.0 + levels.LOAD.tolerance) * ranges["FZMIN"]


def covered_ranges(points: Points) -> dict[str, float]:
    """The tested ranges over which the fit keeps the physical limits; a single pressure is widened to both sides."""
    ranges = tested_ranges(points)
    if single_pressure(ranges):
        ranges["PRESMIN"] *= 1.0 - constants.AROUND_A_SINGLE_VALUE
        ranges["PRESMAX"] *= 1.0 + constants.AROUND_A_SINGLE_VALUE
    return ranges


def envelope(ranges: Mapping[str, float]) -> Envelope:
    """Ranges by file key, as the envelope for the physical limits."""
    return Envelope(
        Fz=(ranges["FZMIN"], ranges["FZMAX"]),
        gamma=ranges["CAMMAX"],
        alpha=ranges["ALPMAX"],
        pressure=(ranges["PRESMIN"], ranges["PRESMAX"]),
        kappa=max(-ranges.get("KPUMIN", 0.0), ranges.get("KPUMAX", 0.0), 0.0) + 0.0,
    )


def plausible_ranges(
    values: Mapping[str, Any], tested: Mapping[str, float], *, turn_slip: bool
) -> dict[str, float]:
    """The ranges to write: the tested ranges, extended as far as the model stays plausible.

    Simulations clip their inputs to the ranges of the file, or fade forces out beyond them: with the tested ranges, forces would
    stop following the sideslip at 8 degrees, for example. The targets are a tenth of the smallest and one and a half of the
    largest load, 20 degrees of sideslip, and pressures a fifth beyond the tested ones. The camber range grows by half, up to 45
    degrees; beyond, the quadratic term of the curvature would cost more inside the range than it gains outside. Each end moves
    towards its target as long as the limits of :mod:`mffit.fit.constraints` hold, no characteristic changes faster than in
    public tyres, and grip, stiffness and moment over load follow their slope over the tested loads and pressures.
    """
    model = SimpleNamespace(**values)
    ranges = dict(tested)
    allowed = max(constants.LIMIT_MARGIN, _worst_violation(model, ranges)) + 1e-9
    for name, end in _wished_ends(tested).items():
        for share in constants.RANGE_SHARES:
            stop = tested[name] + share * (end - tested[name])
            wider, alone = (_with_end(inside, name, stop) for inside in (ranges, tested))
            if (
                _worst_violation(model, wider) <= allowed
                and _as_tested(model, wider, name, tested)
                and _as_in_public_tyres(model, alone, name, tested[name], turn_slip)
            ):
                ranges = wider
                break
    return ranges


def with_room(
    values: Mapping[str, Any],
    written: Mapping[str, float],
    stated: Mapping[str, float],
    *,
    turn_slip: bool = False,
) -> tuple[dict[str, float], dict[str, str]]:
    """The ranges to write, none of them empty, and the origin of each range that the sweeps do not vary, by quantity.

    A simulation clips its inputs to the range of the file, so an empty range would fix them. A camber or sideslip that was not
    varied gets the base file's range (``stated``) if the model stays plausible in it, else a small range.
    """
    model = SimpleNamespace(**values)
    ranges, origin = dict(written), {}
    for word, low, high, small in (
        ("camber", "CAMMIN", "CAMMAX", constants.UNTESTED_ANGLE.rad),
        ("sideslip", "ALPMIN", "ALPMAX", constants.UNTESTED_ANGLE.rad),
    ):
        if ranges[high] - ranges[low] > 2.0 * UPRIGHT.rad:
            continue
        ranges |= {low: -small, high: small}
        origin[word] = f"{np.degrees(small):.0f} deg to either side"
        end = max(-stated.get(low, 0.0), stated.get(high, 0.0))
        theirs = {**ranges, low: -end, high: end}
        if (
            end > small
            and _worst_violation(model, theirs) <= constants.LIMIT_MARGIN
            and _as_in_public_tyres(model, theirs, high, small, turn_slip)
        ):
            ranges = theirs
            origin[word] = f"the base's {np.degrees(end):.0f} deg to either side"
    for word, low, high in (("load", "FZMIN", "FZMAX"), ("pressure", "PRESMIN", "PRESMAX")):
        if not ranges[low] < ranges[high]:
            share = constants.AROUND_A_SINGLE_VALUE
            ranges |= {low: (1.0 - share) * ranges[low], high: (1.0 + share) * ranges[high]}
            origin[word] = f"{share:.0%} to either side"
    return ranges, origin


def _wished_ends(tested: Mapping[str, float]) -> dict[str, float]:
    alpha, gamma = tested["ALPMAX"], tested["CAMMAX"]
    wider_gamma = min(constants.BEYOND_TESTED * gamma, constants.WRITTEN_CAMMAX.rad)
    return {
        "FZMIN": constants.WRITTEN_FZMIN_SHARE * tested["FZMIN"],
        "FZMAX": constants.BEYOND_TESTED * tested["FZMAX"],
        "PRESMIN": (1.0 - constants.WRITTEN_PRESSURE_SHARE) * tested["PRESMIN"],
        "PRESMAX": (1.0 + constants.WRITTEN_PRESSURE_SHARE) * tested["PRESMAX"],
        "CAMMAX": max(gamma, wider_gamma),
        "ALPMAX": max(SIDESLIP_BEYOND_PEAK.rad, alpha),
    }


def _with_end(ranges: Mapping[str, float], name: str, value: float) -> dict[str, float]:
    mirrored = {name.replace("MAX", "MIN"): -value} if name in ("CAMMAX", "ALPMAX") else {}
    return {**ranges, name: value, **mirrored}


def _worst_violation(model: Any, ranges: Mapping[str, float]) -> float:
    """The largest violation of a physical limit, on one grid for each half of the load range."""
    low, high = ranges["FZMIN"], ranges["FZMAX"]
    middle = 0.5 * (low + high)
    halves = ((low, middle), (middle, high))
    return max(float(violations(model, envelope(ranges)._replace(Fz=loads)).max()) for loads in halves)


def _as_tested(model: Any, ranges: Mapping[str, float], name: str, tested: Mapping[str, float]) -> bool:
    """Whether grip and stiffness over load follow their slope over the tested loads or pressures up to the range's end ``name``.

    A polynomial follows the tested conditions and may turn away outside them. A change smaller than by the slope is not a cliff.
    """
    key = name[:-3]
    if {"FZ": single_load, "PRES": single_pressure}.get(key, lambda _: True)(tested):
        return True
    begin, other = (tested[key + end] for end in (name[-3:], "MIN" if name.endswith("MAX") else "MAX"))
    x = np.linspace(begin, ranges[name], int(constants.STEPS_OF_A_GRID))
    for line in _along(model, ranges, name, np.array([other, *x])):
        first, found = line[:, :1], line[:, 1:]
        toward = (found[:, :1] - first) * (x - begin) / (begin - other)
        room = constants.OFF_THE_TESTED_SLOPE * np.abs(found[:, :1])
        change = found - found[:, :1]
        if np.any((change > np.maximum(toward, 0.0) + room) | (change < np.minimum(toward, 0.0) - room)):
            return False
    return True


def _along(model: Any, ranges: Mapping[str, float], name: str, x: np.ndarray) -> list[np.ndarray]:
    """Grip and stiffness over load at values (n,) of the range ``name``: (k, n) over a grid of the other ranges.

    For the largest load also the largest moment over load. Towards no load that vanishes with the length of the contact, along
    a curve.
    """
    others = grid(envelope(ranges))
    conditions = [
        np.tile(x, others[0].size) if name.startswith(axis) else np.repeat(values, len(x))
        for axis, values in zip(("FZ", "CAM", "PRES"), others, strict=True)
    ]
    found = characteristics(model, *conditions)
    if name == "FZMAX":
        found.append(_largest_moment(model, ranges["ALPMAX"], *conditions) / conditions[0])
    return [one.reshape(-1, len(x)) for one in found if np.any(one)]


def _largest_moment(
    model: Any, most: float, Fz: np.ndarray, gamma: np.ndarray, pressure: np.ndarray
) -> np.ndarray:
    """Largest aligning moment (n,) over sideslip up to ``most``: half the difference of both sides, in which camber cancels."""
    size = np.linspace(0.0, most, int(constants.STEPS_OF_A_GRID))[:, None]
    left, right = (evaluate(model, Fz, alpha, gamma, pressure=pressure)[0].Mz for alpha in (-size, size))
    return np.asarray(0.5 * np.max(np.abs(right - left), axis=0))


def _as_in_public_tyres(
    model: Any, ranges: Mapping[str, float], name: str, begin: float, turn_slip: bool
) -> bool:
    """Whether grip and stiffness over load, and the side force over sideslip, change no faster than those of public tyres.

    Compared in steps from ``begin`` to the range's end ``name``, on a grid of the other ranges. Steps are in the logarithm of
    load or pressure, or in an angle [rad]. Over sideslip only a falling force counts, because a force may rise to its peak.
    """
    if ranges[name] == begin:
        return True
    relative, n = name.startswith(("FZ", "PRES")), int(constants.STEPS_OF_A_GRID)
    x = (np.geomspace if relative else np.linspace)(begin, ranges[name], n)
    if name == "ALPMAX":
        Fz, gamma, pressure = (np.repeat(values, n) for values in grid(envelope(ranges)))
        along = np.tile(x, Fz.size // n)
        left, right = (
            evaluate(model, Fz, alpha, gamma, pressure=pressure, turn_slip=turn_slip)[0].Fy
            for alpha in (-along, along)
        )
        found = [(left - right).reshape(-1, n)]  # of opposite sideslip, so that camber thrust cancels
    else:
        found = _along(model, ranges, name, x)
    step = np.diff(np.log(x) if relative else x)
    for line in found:
        with np.errstate(
            divide="ignore", invalid="ignore"
        ):  # a change of sign is NaN, which is not below the limit
            change = np.diff(np.log(line / line[:, :1]), axis=1) / step
        if not np.all((-change if name == "ALPMAX" else np.abs(change)) <= constants.FASTEST_CHANGE):
            return False
    return True
