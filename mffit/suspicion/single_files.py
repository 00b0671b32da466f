"""Checks of one file: mostly for numbers in another unit, which can be plausible one by one and impossible together."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from mffit.config import Config
from mffit.points import Points
from mffit.suspicion import constants
from mffit.suspicion.rule import Finding, Subject, rule
from mffit.suspicion.slopes import slope
from mffit.sweeps.units import factor

of_file = partial(rule, subject=Subject.FILE)


@of_file(
    id="angle-in-radians",
    limits=(constants.STEEPEST_OVER_SIDESLIP, constants.STEEPEST_OVER_CAMBER),
    sentence="reaches only {largest:.3g} deg, over which the side force changes by {steepness:.0f} times the load per radian; "
    'the angles look like radians: write degrees, or {column} = {{ column = "{column}", unit = "rad" }} under '
    "[sweep.columns]",
)
def angle_in_radians(part: Points, config: Config) -> Iterator[Finding]:
    """Slope of Fy per load over sideslip and over camber, forwards and backwards; small angles are not suspected."""
    for angle, steepest in (
        ("alpha", constants.STEEPEST_OVER_SIDESLIP),
        ("gamma", constants.STEEPEST_OVER_CAMBER),
    ):
        for way in (1, -1):
            found = slope(part, part.Fy, angle, part.direction == way)
            if found.sign and abs(found.value) > steepest:
                largest = np.degrees(np.max(np.abs(getattr(part, angle))))
                facts = {"largest": largest, "steepness": abs(found.value), "column": f"{angle}_deg"}
                yield Finding(facts, column=f"{angle}_deg")


@of_file(
    id="dead-channel",
    limits=(constants.FEWEST,),
    sentence="is {reading:g} in every row, so the channel was dead; {remedy}",
)
def dead_channel(part: Points, config: Config) -> Iterator[Finding]:
    """Mz and Fy that are the same in every row although the angles change."""
    if len(part) < constants.FEWEST or np.ptp(part.alpha) + np.ptp(part.gamma) == 0.0:
        return
    for column, reading, remedy in (
        ("Mz_Nm", part.Mz, "leave the column out of this file"),
        ("Fy_N", part.Fy, "leave this file out"),
    ):
        if np.all(reading == reading[0]):
            yield Finding({"reading": reading[0], "remedy": remedy}, column=column)


@of_file(
    id="force-and-moment-exchanged",
    limits=(
        constants.LARGEST_MOMENT_ARM,
        constants.LARGEST_FRICTION,
        constants.SMALLEST_FRICTION,
        constants.LARGEST_CAMBER_THRUST,
        constants.LARGEST_FORCE_AT_ZERO,
    ),
    sentence="reaches {moment:.0f} Nm at loads of {load:.0f} N while Fy_N stays below {force:.3g} N, so the headings Fy_N and "
    "Mz_Nm look exchanged; correct them",
)
def force_and_moment_exchanged(part: Points, config: Config) -> Iterator[Finding]:
    """|Mz| and |Fy| over load: the moment is as large as a side force, and the force as small as a moment.

    In a sweep of small camber both are small: there the moment is as large as a side force must be, and the force too small for
    newtons but too large for kilonewtons.
    """
    force, moment = np.abs(part.Fy) / part.Fz, np.abs(part.Mz) / part.Fz
    if not np.all(np.isfinite(moment)):
        return
    least, most = constants.LARGEST_MOMENT_ARM, constants.LARGEST_FRICTION
    if np.max(force) < least < np.max(moment) < most or _exchanged_at_small_camber(part, force, moment):
        facts = {
            "moment": np.max(np.abs(part.Mz)),
            "force": np.max(np.abs(part.Fy)),
            "load": np.median(part.Fz),
        }
        yield Finding(facts, column="Mz_Nm")


def _exchanged_at_small_camber(part: Points, force: np.ndarray, moment: np.ndarray) -> bool:
    """Whether |Fy| and |Mz| per load (n,) of a sweep of camber are a moment and a side force."""
    shows = np.abs(part.gamma) > constants.CAMBER_THAT_SHOWS_FORCE.rad
    straight = np.max(np.abs(part.alpha)) <= constants.SMALL_ANGLE.rad
    if not straight or np.sum(shows) < constants.FEWEST:
        return False
    thrust = constants.LARGEST_CAMBER_THRUST * np.tan(np.max(np.abs(part.gamma)))
    in_kilonewtons = factor("kN", "N") * np.max(force) < constants.LARGEST_FORCE_AT_ZERO + thrust
    weak = np.max(force[shows]) < constants.SMALLEST_FRICTION < np.max(moment[shows])
    return bool(weak and not in_kilonewtons and np.max(moment) > np.max(force))


@of_file(
    id="force-in-kilonewtons",
    limits=(
        constants.SMALL_ANGLE,
        constants.CAMBER_THAT_SHOWS_FORCE,
        constants.SMALLEST_FRICTION,
        constants.FEWEST,
    ),
    sentence="is at most {largest:.3g} N at loads of {load:.0f} N, which looks like kN; write newtons, or "
    'Fy_N = {{ column = "Fy_N", unit = "kN" }} under [sweep.columns]',
)
def force_too_small(part: Points, config: Config) -> Iterator[Finding]:
    """Largest Fy per load at angles that show a force."""
    shows = (np.abs(part.alpha) > constants.SMALL_ANGLE.rad) | (
        np.abs(part.gamma) > constants.CAMBER_THAT_SHOWS_FORCE.rad
    )
    if np.sum(shows) < constants.FEWEST:
        return
    if np.max(np.abs(part.Fy[shows]) / part.Fz[shows]) < constants.SMALLEST_FRICTION:
        facts = {"largest": np.max(np.abs(part.Fy[shows])), "load": np.median(part.Fz)}
        yield Finding(facts, column="Fy_N")


@of_file(
    id="lone-load",
    limits=(constants.BEYOND_LOADS, constants.FEWEST),
    sentence="{load:.6g} N is far above all other loads of the file, which are at most {others:.6g} N; correct or remove the row",
)
def lone_load(part: Points, config: Config) -> Iterator[Finding]:
    """Largest load over all others of the file; no programme has a single point there."""
    if len(part) < constants.FEWEST:
        return
    row, others = int(np.argmax(part.Fz)), np.sort(part.Fz)[:-1]
    if part.Fz[row] > constants.BEYOND_LOADS * others[-1]:
        facts = {"load": part.Fz[row], "others": others[-1]}
        yield Finding(facts, line=_line(part, row), column="Fz_N")


@of_file(
    id="wild-force",
    limits=(constants.LARGEST_FRICTION, constants.FEWEST),
    sentence="{force:.6g} N is {friction:.0f} times the load, which no tyre reaches; correct or remove the row",
)
def wild_force(part: Points, config: Config) -> Iterator[Finding]:
    """Fy per load of one or two rows."""
    friction = np.abs(part.Fy) / part.Fz
    if 0 < np.sum(friction > constants.LARGEST_FRICTION) < constants.FEWEST:
        row = int(np.argmax(friction))
        facts = {"force": part.Fy[row], "friction": friction[row]}
        yield Finding(facts, line=_line(part, row), column="Fy_N")


@of_file(
    id="load-in-another-unit",
    limits=(constants.LARGEST_FRICTION, constants.FEWEST),
    sentence="side forces reach {friction:.0f} times the load ({load:.0f} N), which no tyre does: the load looks like kgf, or "
    'the force like another unit; map it with its unit, Fz_N = {{ column = "Fz_N", unit = "kgf" }} in [sweep.columns]',
)
def load_in_another_unit(part: Points, config: Config) -> Iterator[Finding]:
    """Fy per load of more rows; the loads of the file are too small."""
    friction = np.abs(part.Fy) / part.Fz
    if np.sum(friction > constants.LARGEST_FRICTION) >= constants.FEWEST:
        row = int(np.argmax(friction))
        yield Finding({"friction": friction[row], "load": part.Fz[row]}, column="Fz_N")


@of_file(
    id="moment-in-newton-millimetres",
    limits=(constants.LONGEST_ARM,),
    sentence="reaches {arm:.0f} m times the load, which looks like N mm; name its unit under [sweep.columns]",
)
def arm_too_long(part: Points, config: Config) -> Iterator[Finding]:
    """|Mz| and |Mx| over load."""
    for column, moment in (("Mz_Nm", part.Mz), ("Mx_Nm", part.Mx)):
        arm = np.abs(moment) / part.Fz
        if np.any(arm > constants.LONGEST_ARM):
            yield Finding({"arm": np.nanmax(arm)}, column=column)


@of_file(
    id="pressure-in-psi",
    limits=(constants.LOWEST_TESTED_PRESSURE,),
    sentence="is {pressure:.3g} kPa, far from the nominal {nominal:.3g} kPa, and looks like psi; write kPa, or "
    'p_kPa = {{ column = "p_kPa", unit = "psi" }} under [sweep.columns]',
)
def pressure_in_psi(part: Points, config: Config) -> Iterator[Finding]:
    """Median pressure over the nominal one, as it is and read as psi."""
    nominal = 1e3 * config.tyre.nominal_pressure
    pressure = float(np.median(part.p))
    lowest, highest = constants.LOWEST_TESTED_PRESSURE * nominal, nominal / constants.LOWEST_TESTED_PRESSURE
    if pressure < lowest and lowest < factor("psi", "kPa") * pressure < highest:
        yield Finding({"pressure": pressure / 1e3, "nominal": nominal / 1e3}, column="p_kPa")


def _line(part: Points, row: int) -> int | None:
    return int(part.line[row]) or None
