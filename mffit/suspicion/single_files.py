"""Checks of one file: mostly for numbers in another unit, which can be plausible one by one and impossible together."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from mffit.config import Config
from mffit.points import Points
from mffit.suspicion import constants
from mffit.suspicion.rule import Finding
from mffit.suspicion.slopes import slope
from mffit.sweeps.units import factor


def angle_in_radians(part: Points, config: Config) -> Iterator[Finding]:
    """Angles over which the side force is far too steep; small angles alone are not suspected."""
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


def dead_channel(part: Points, config: Config) -> Iterator[Finding]:
    """A channel that reads one and the same number while the angles change."""
    if len(part) < constants.FEWEST_ROWS_OF_A_DEAD_CHANNEL or np.ptp(part.alpha) + np.ptp(part.gamma) == 0.0:
        return
    for column, reading, remedy in (
        ("Mz_Nm", part.Mz, "leave the column out of this file"),
        ("Fy_N", part.Fy, "leave this file out"),
    ):
        if np.all(reading == reading[0]):
            yield Finding({"reading": reading[0], "remedy": remedy}, column=column)


def force_too_small(part: Points, config: Config) -> Iterator[Finding]:
    """Side forces that are too small for the angles."""
    shows = (np.abs(part.alpha) > constants.SIDESLIP_THAT_SHOWS_FORCE.rad) | (
        np.abs(part.gamma) > constants.CAMBER_THAT_SHOWS_FORCE.rad
    )
    if np.sum(shows) < constants.FEWEST_POINTS_OF_FRICTION:
        return
    if np.max(np.abs(part.Fy[shows]) / part.Fz[shows]) < constants.SMALLEST_FRICTION:
        facts = {"largest": np.max(np.abs(part.Fy[shows])), "load": np.median(part.Fz)}
        yield Finding(facts, column="Fy_N")


def lone_load(part: Points, config: Config) -> Iterator[Finding]:
    """One load far above all others of its file: no programme has a single point there."""
    if len(part) < constants.FEWEST_ROWS_OF_A_LONE_LOAD:
        return
    row, others = int(np.argmax(part.Fz)), np.sort(part.Fz)[:-1]
    if part.Fz[row] > constants.LONE_LOAD * others[-1]:
        facts = {"load": part.Fz[row], "others": others[-1]}
        yield Finding(facts, line=_line(part, row), column="Fz_N")


def wild_force(part: Points, config: Config) -> Iterator[Finding]:
    """One or two side forces beyond all friction."""
    friction = np.abs(part.Fy) / part.Fz
    if 0 < np.sum(friction > constants.LARGEST_FRICTION) < constants.FEWEST_POINTS_OF_FRICTION:
        row = int(np.argmax(friction))
        facts = {"force": part.Fy[row], "friction": friction[row]}
        yield Finding(facts, line=_line(part, row), column="Fy_N")


def load_in_another_unit(part: Points, config: Config) -> Iterator[Finding]:
    """Side forces beyond all friction at several points: the loads of the file are too small."""
    friction = np.abs(part.Fy) / part.Fz
    if np.sum(friction > constants.LARGEST_FRICTION) >= constants.FEWEST_POINTS_OF_FRICTION:
        row = int(np.argmax(friction))
        yield Finding({"friction": friction[row], "load": part.Fz[row]}, column="Fz_N")


def arm_too_long(part: Points, config: Config) -> Iterator[Finding]:
    """Moments with an arm that no tyre has."""
    arm = np.abs(part.Mz) / part.Fz
    if np.any(arm > constants.LONGEST_ARM):
        yield Finding({"arm": np.nanmax(arm)}, column="Mz_Nm")


def pressure_in_psi(part: Points, config: Config) -> Iterator[Finding]:
    """A pressure far below the nominal one that would be near it in psi."""
    nominal = 1e3 * config.tyre.nominal_pressure
    pressure = float(np.median(part.p))
    lowest, highest = constants.LOWEST_TESTED_PRESSURE * nominal, nominal / constants.LOWEST_TESTED_PRESSURE
    if pressure < lowest and lowest < factor("psi", "kPa") * pressure < highest:
        yield Finding({"pressure": pressure / 1e3, "nominal": nominal / 1e3}, column="p_kPa")


def _line(part: Points, row: int) -> int | None:
    return int(part.line[row]) or None
