"""Checks of single files: values that no tyre has, and the reading under which the file would be plausible.

Numbers in a wrong unit can be plausible one by one and impossible in combination.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from mffit.config import Config
from mffit.points import Points
from mffit.suspicion import constants
from mffit.suspicion.groups import readings_of
from mffit.suspicion.rereadings import MISTAKES
from mffit.suspicion.rule import Finding, rule_of_files
from mffit.suspicion.slopes import slope
from tir.constants import CREDIBLE_FRICTION

WEAKEST_CAMBER_IN_RADIANS = float(np.degrees(constants.SMALLEST_CAMBER_THRUST))
"""Slope of Fy/Fz over camber [1/rad] of the tyre with the weakest camber force, if radians are read as degrees."""
CAMBER_THAT_SHOWS_FORCE = float(constants.SMALLEST_FRICTION / constants.SMALLEST_CAMBER_THRUST)
"""Camber [rad] from which every tyre has a visible side force."""
AS_READ = dict.fromkeys(("alpha", "gamma", "Fz", "Fy", "Mz"), 1.0)
"""Signs of the rig's axes; these checks use sizes only, so all are +1."""


@rule_of_files(id="dead-channel", sentence="is {reading:g} in every row, so the channel was dead; {remedy}")
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


@rule_of_files(
    id="repeated-rows",
    sentence="holds {count} rows a second time, with the same readings; remove the copies, as they would count as more readings",
)
def repeated_rows(part: Points, config: Config) -> Iterator[Finding]:
    """Rows with the readings of another row of the file, if they are half of it."""
    first = np.unique(readings_of(part), axis=0, return_index=True)[1]
    copies = np.setdiff1d(np.arange(len(part)), first)
    if len(part) >= constants.FEWEST and 2 * len(copies) >= len(part) and np.ptp(part.Fy) > 0.0:
        yield Finding({"count": len(copies)}, line=int(part.line[copies[0]]) or None)


@rule_of_files(
    id="lone-load",
    sentence="{load:.6g} N is far above all other loads of the file, which are at most {others:.6g} N; correct or remove the row",
)
def lone_load(part: Points, config: Config) -> Iterator[Finding]:
    """Largest load over all others of the file; no programme has a single point there."""
    if len(part) < constants.FEWEST:
        return
    row, others = int(np.argmax(part.Fz)), np.sort(part.Fz)[:-1]
    if part.Fz[row] > constants.BEYOND_NOMINAL * others[-1]:
        facts = {"load": part.Fz[row], "others": others[-1]}
        yield Finding(facts, line=int(part.line[row]) or None, column="Fz_N")


@rule_of_files(
    id="wild-force",
    sentence="{force:.6g} N is {friction:.0f} times the load, which no tyre reaches; correct or remove the row",
)
def wild_force(part: Points, config: Config) -> Iterator[Finding]:
    """Fy per load of one or two rows."""
    friction = np.abs(part.Fy) / part.Fz
    if 0 < np.sum(friction > CREDIBLE_FRICTION) < constants.FEWEST:
        row = int(np.argmax(friction))
        facts = {"force": part.Fy[row], "friction": friction[row]}
        yield Finding(facts, line=int(part.line[row]) or None, column="Fy_N")


class Impossible(NamedTuple):
    """A value that no tyre has."""

    column: str
    said: str  #: words that follow the name of the column


def _steep(part: Points, config: Config) -> Iterator[Impossible]:
    limits = {"alpha": constants.STEEPEST_OVER_SIDESLIP, "gamma": WEAKEST_CAMBER_IN_RADIANS}
    for angle, steepest in limits.items():
        for way in (1, -1):
            found = slope(part, part.Fy, angle, part.direction == way)
            if found.sign and abs(found.value) > steepest:
                largest = np.degrees(np.max(np.abs(getattr(part, angle))))
                said = (
                    f"reaches only {largest:.3g} deg, over which the side force changes by {abs(found.value):.0f} times the load "
                    "per radian"
                )
                yield Impossible(f"{angle}_deg", said)


def _reached(values: np.ndarray) -> float:
    """The absolute value that at least a few of the values (n,) reach, so that single wild ones do not count; 0 with too few."""
    sizes = np.sort(np.abs(values[np.isfinite(values)]))
    few = int(constants.FEWEST)
    return float(sizes[-few]) if len(sizes) >= few else 0.0


def _strong(part: Points, config: Config) -> Iterator[Impossible]:
    for column, reading, largest in (
        ("Fy_N", part.Fy, CREDIBLE_FRICTION),
        ("Mz_Nm", part.Mz, constants.LARGEST_MOMENT_ARM),
        ("Mx_Nm", part.Mx, CREDIBLE_FRICTION * config.tyre.unloaded_radius),
    ):
        reached = _reached(reading / part.Fz)
        if reached > largest:
            unit = " m" if column.endswith("Nm") else ""
            said = f"reaches {reached:.2g}{unit} times the load, where no tyre exceeds {largest:g}{unit}"
            yield Impossible(column, said)


def _weak(part: Points, config: Config) -> Iterator[Impossible]:
    shows = (np.abs(part.alpha) >= constants.SIDESLIP_OF_SLOPES.rad) | (
        np.abs(part.gamma) >= CAMBER_THAT_SHOWS_FORCE
    )
    force = np.abs(part.Fy[shows])
    if np.sum(shows) >= constants.FEWEST and np.max(force / part.Fz[shows]) < constants.SMALLEST_FRICTION:
        said = f"is at most {np.max(force):.3g} N at loads of {np.median(part.Fz):.0f} N"
        yield Impossible("Fy_N", said)


def _soft(part: Points, config: Config) -> Iterator[Impossible]:
    nominal, pressure = 1e3 * config.tyre.nominal_pressure, float(np.median(part.p))
    if pressure * constants.BEYOND_NOMINAL < nominal:
        said = f"is {pressure / 1e3:.3g} kPa, far from the nominal {nominal / 1e3:.3g} kPa"
        yield Impossible("p_kPa", said)


IMPOSSIBLE: tuple[Callable[[Points, Config], Iterator[Impossible]], ...] = (_soft, _steep, _weak, _strong)


def impossible(part: Points, config: Config) -> list[Impossible]:
    """The impossible values of a file; empty for a plausible file."""
    return [found for test in IMPOSSIBLE for found in test(part, config)]


@rule_of_files(id="impossible-file", sentence="{said}; {looks}")
def impossible_file(part: Points, config: Config) -> Iterator[Finding]:
    """Pressure over the nominal one, slopes of Fy over the angles, Fy, Mz and Mx over load; as read and without each mistake."""
    found = impossible(part, config)
    if not found:
        return
    column, said = found[0]
    looks = "no single unit or exchanged heading explains it: check the columns and units of this file"
    for mistake in MISTAKES:
        if mistake.beyond_doubt and not impossible(mistake.undone(part, AS_READ), config):
            said = said if column == mistake.column else f"{column} {said}"
            column, looks = mistake.column, f"it looks like {mistake.looks}: {mistake.remedy}"
            break
    yield Finding({"said": said, "looks": looks}, column=column)
