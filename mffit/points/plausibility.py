"""The declared axes, frame and path centre against what every tyre does."""

from __future__ import annotations

import itertools

import numpy as np

from mffit.config import Config
from mffit.errors import InputError
from mffit.points.levels import main_pressure
from mffit.points.points import Points
from tir.conventions import FLIPPED

SMALL_SLIP = np.radians(4.0)
CLEAR = 4.0
"""Ratio of a slope to its standard error above which its sign is beyond doubt."""


def check_physics(points: Points, config: Config) -> list[str]:
    """Refuse data that contradict the declaration; return warnings.

    Raises
    ------
    InputError
        With the channel and the likely cause.
    """
    steady = points.select(~points.continuous & (points.mount > 0))
    if not len(steady):
        raise InputError(
            "no sweep holds its angles long enough for a steady point; give finished points, or a time series that rests at "
            "every set-point",
            file=config.path,
        )
    signs = signatures(steady)
    wrong = [name for name, (sign, clear) in signs.items() if clear and sign > 0]
    if wrong:
        raise _contradiction(wrong, steady, config)
    if config.rig.type == "rotating-disk":
        _disc_needs(steady, config)
        _frame(steady, config)
        return _disc_warnings(steady, signs)
    return _single_load(steady)


def signatures(points: Points) -> dict[str, tuple[float, bool]]:
    """Signs that are negative for any tyre in ISO-W, each with whether it is beyond doubt."""
    forward = points.direction > 0
    upright = np.abs(points.gamma) < np.radians(1.0)
    straight = np.abs(points.alpha) < np.radians(1.0)
    alpha = forward & upright & (np.abs(points.alpha) < SMALL_SLIP)
    gamma = forward & straight & (np.abs(points.gamma) < np.radians(25.0))
    return {
        "Fy over alpha": _slope(points.alpha[alpha], (points.Fy / points.Fz)[alpha]),
        "Fy over gamma": _slope(points.gamma[gamma], (points.Fy / points.Fz)[gamma]),
        "-Mz over alpha": _slope(points.alpha[alpha], -(points.Mz / points.Fz)[alpha]),
        "turn-slip force": _outward(points),
    }


def _slope(x: np.ndarray, y: np.ndarray) -> tuple[float, bool]:
    used = np.isfinite(y)
    x, y = x[used], y[used]
    if len(x) < 4 or np.ptp(x) < np.radians(0.5):
        return 0.0, False
    A = np.column_stack([x, np.ones_like(x)])
    (slope, _), residual, *_ = np.linalg.lstsq(A, y, rcond=None)
    scatter = np.sqrt(float(residual[0]) / (len(x) - 2)) if len(residual) and len(x) > 2 else 0.0
    error = scatter / np.sqrt(np.sum((x - x.mean()) ** 2))
    return float(slope), abs(slope) > CLEAR * error


def _outward(points: Points) -> tuple[float, bool]:
    """Turn-slip force along the path's inside, with both directions' mean if there are backward runs.

    Without them a misaligned sideslip axis can turn the force round, so the sign alone proves nothing.
    """
    zero = (np.abs(points.alpha) < np.radians(0.3)) & (np.abs(points.gamma) < np.radians(0.5))
    inside = -points.Fy * np.sign(points.phi_t) / points.Fz
    forward, backward = zero & (points.direction > 0), zero & (points.direction < 0)
    if not np.any(points.phi_t) or not np.any(forward):
        return 0.0, False
    if not np.any(backward):
        return float(np.mean(inside[forward])), False
    mean = (np.mean(inside[forward]) + np.mean(inside[backward])) / 2.0
    return float(mean), abs(mean) > 0.02


def _contradiction(wrong: list[str], points: Points, config: Config) -> InputError:
    consistent = _consistent_declarations(points, config)
    channel = {"Fy over alpha": "the cornering stiffness dFy/dalpha", "Fy over gamma": "the camber stiffness dFy/dgamma"}
    channel |= {"-Mz over alpha": "the aligning stiffness dMz/dalpha", "turn-slip force": "the turn-slip force at (0, 0)"}
    names = " and ".join(channel[name] for name in wrong)
    remedy = f"; the data agree with {consistent[0]}" if consistent else "; check the signs of alpha, gamma, Fy and Mz"
    return InputError(
        f"{names} has the wrong sign for axes = {config.rig.axes!r}, path_centre = {config.rig.path_centre!r}{remedy}",
        file=config.path,
        key="rig.axes" if wrong != ["turn-slip force"] else "rig.path_centre",
    )


def _consistent_declarations(points: Points, config: Config) -> list[str]:
    """Declarations of axes and path centre under which every sign is as it should be."""
    out = []
    for axes, side in itertools.product(FLIPPED, ("left", "right")):
        relative = FLIPPED[axes] ^ FLIPPED[config.rig.axes]
        turned = points.replace(
            alpha=-points.alpha if "alpha" in relative else points.alpha,
            Fy=-points.Fy if "Fy" in relative else points.Fy,
            Mz=-points.Mz if "Mz" in relative else points.Mz,
            phi_t=points.phi_t if side == config.rig.path_centre else -points.phi_t,
        )
        if not any(clear and sign > 0 for sign, clear in signatures(turned).values()):
            out.append(f'axes = "{axes}", path_centre = "{side}"' if config.rig.type == "rotating-disk" else f'axes = "{axes}"')
    return out


def _disc_needs(points: Points, config: Config) -> None:
    """What the symmetric decomposition cannot do without."""
    for name, values, smallest in (("alpha", points.alpha, 0.75), ("gamma", points.gamma, 1.5)):
        degrees = np.degrees(values)
        if (degrees.max() > smallest) != (degrees.min() < -smallest):
            raise InputError(
                f"only one sign of {name} was run ({degrees.min():.3g} to {degrees.max():.3g} deg); a disc needs both, because "
                "turn slip is removed by mirror symmetry: add the mirrored points",
                file=config.path,
                column=f"{name}_deg",
            )
    zero = (np.abs(points.alpha) < np.radians(0.3)) & (np.abs(points.gamma) < np.radians(0.5)) & (points.direction > 0)
    if not np.any(zero):
        raise InputError(
            "no forward point at alpha = 0, gamma = 0 was run; the turn-slip force is measured there: add one per load",
            file=config.path,
        )


def _frame(points: Points, config: Config) -> None:
    """At large camber the frames differ by Fz sin(gamma), more than any tyre's camber thrust can bridge."""
    used = (np.abs(points.alpha) < np.radians(0.5)) & (np.abs(points.gamma) > np.radians(25.0)) & (points.direction > 0)
    used &= main_pressure(points)
    if np.sum(used) < 2:
        return
    gamma, friction = points.gamma[used], points.Fy[used] / points.Fz[used]
    thrust = -float(np.mean(friction * np.sign(gamma)) / np.mean(np.sin(np.abs(gamma))))
    if -0.3 < thrust < 2.2:
        return
    other = "C" if config.rig.force_frame == "W" else "W"
    raise InputError(
        f"camber thrust at more than 25 deg is {thrust:.1f} Fz sin(gamma), where tyres have 0.5 to 1.5; it looks like frame "
        f'{other}: set force_frame = "{other}"',
        file=config.path,
        key="rig.force_frame",
    )


def _disc_warnings(points: Points, signs) -> list[str]:
    out = _single_load(points)
    sign, _ = signs["turn-slip force"]
    if sign > 0:
        out.append(
            "the force at (0, 0) points towards the disc's centre: the sideslip axis is misaligned by about a degree or more, "
            "or path_centre is wrong; run forward and backward zeros and mffit align"
        )
    return out


def _single_load(points: Points) -> list[str]:
    ordered = np.sort(np.log(points.Fz))
    if not np.any(np.diff(ordered) > 0.08):
        return [f"one load only ({np.mean(points.Fz):.0f} N): terms that vary with load are held"]
    return []
