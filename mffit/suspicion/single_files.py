"""Checks of single files: values that are unusual or impossible, and the reading under which the file would be plausible.

Numbers in a wrong unit can be plausible one by one and impossible in combination. Unusual values are refused if a known mistake
explains them; otherwise they are asked for.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from mffit.config import Config
from mffit.constants import STRAIGHT, UPRIGHT
from mffit.points import Points
from mffit.suspicion import constants
from mffit.suspicion.groups import readings_of
from mffit.suspicion.rereadings import MISTAKES, Mistake
from mffit.suspicion.rule import Finding, Outcome, rule_of_files
from mffit.suspicion.slopes import STILL, slope
from tir.constants import CREDIBLE_FRICTION

WEAKEST_CAMBER_IN_RADIANS = float(np.degrees(constants.SMALLEST_CAMBER_THRUST))
"""Slope of Fy/Fz over camber [1/rad] of the tyre with the weakest camber force, if radians are read as degrees."""
CAMBER_THAT_SHOWS_FORCE = float(constants.SMALLEST_FRICTION / constants.SMALLEST_CAMBER_THRUST)
"""Camber [rad] from which every tyre has a visible side force."""
STILL_IN_RADIANS = {angle: float(np.radians(still)) for angle, still in STILL.items()}
"""Range of an angle that stands still, if radians are read as degrees."""
AS_READ = dict.fromkeys(("alpha", "gamma", "Fz", "Fy", "Mz"), 1.0)
"""Signs of the rig's axes; these checks use sizes only, so all are +1."""


@rule_of_files(id="dead-channel", sentence="is {reading:g} in every row, so the channel was dead; {remedy}")
def dead_channel(part: Points, config: Config) -> Iterator[Finding]:
    """Mz and Fy that are the same in every row although the angles change, and a speed of 0, at which there is no slip."""
    if len(part) < constants.FEWEST or np.ptp(part.alpha) + np.ptp(part.gamma) == 0.0:
        return
    for column, reading, remedy in (
        ("Mz_Nm", part.Mz, "leave the column out of this file"),
        ("Fy_N", part.Fy, "leave this file out"),
        ("V_mps", part.V, "leave the column out of this file"),
    ):
        if np.all(reading == reading[0]) and not (column == "V_mps" and reading[0] > 0.0):
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


class LoneLoad(NamedTuple):
    """A load far above all others of its file."""

    row: int
    others: float  #: the largest of the others [N]
    contradicted: bool  #: whether the side force is that of the others at this angle


def _lone_load(part: Points) -> LoneLoad | None:
    if len(part) < constants.FEWEST:
        return None
    row, others = int(np.argmax(part.Fz)), float(np.sort(part.Fz)[-2])
    if not part.Fz[row] > constants.BEYOND_NOMINAL * others:
        return None
    swept = part.alpha if np.ptp(part.alpha) > np.ptp(part.gamma) else part.gamma
    in_order = np.setdiff1d(np.argsort(swept), row, assume_unique=True)
    between = [np.interp(swept[row], swept[in_order], y[in_order]) for y in (part.Fy, part.Fy / part.Fz)]
    as_others = abs(part.Fy[row] - between[0])
    as_loaded = abs(part.Fy[row] - between[1] * part.Fz[row])
    return LoneLoad(row, others, bool(as_others < constants.MUCH_NEARER * as_loaded))


@rule_of_files(
    id="lone-load",
    sentence="{load:.6g} N is far above all other loads of the file, which are at most {others:.6g} N, and its side force is "
    "that of the others; correct or remove the row",
)
def lone_load(part: Points, config: Config) -> Iterator[Finding]:
    """Largest load over all others of the file, if the side force hardly differs from that at the nearest angles."""
    found = _lone_load(part)
    if found is not None and found.contradicted:
        facts = {"load": part.Fz[found.row], "others": found.others}
        yield Finding(facts, line=int(part.line[found.row]) or None, column="Fz_N")


@rule_of_files(
    id="unusual-load",
    outcome=Outcome.WARNED,
    sentence="{load:.6g} N is far above all other loads of {file}, which are at most {others:.6g} N: if it is a wild reading, "
    "correct or remove the row",
)
def unusual_load(part: Points, config: Config) -> Iterator[Finding]:
    """The same, if the side force grows with it."""
    found = _lone_load(part)
    if found is not None and not found.contradicted:
        facts = {"load": part.Fz[found.row], "others": found.others, "file": part.files[part.file[0]]}
        yield Finding(facts)


@rule_of_files(
    id="wild-force",
    sentence="{force:.6g} N is {friction:.0f} times the load, which no tyre reaches; correct or remove the row",
)
def wild_force(part: Points, config: Config) -> Iterator[Finding]:
    """Fy per load of a few loaded rows."""
    friction = np.where(_loaded(part), np.abs(part.Fy) / part.Fz, 0.0)
    if 0 < np.sum(friction > CREDIBLE_FRICTION) < constants.FEWEST:
        row = int(np.argmax(friction))
        facts = {"force": part.Fy[row], "friction": friction[row]}
        yield Finding(facts, line=int(part.line[row]) or None, column="Fy_N")


def _loaded(part: Points) -> np.ndarray:
    """Mask (n,) of the rows whose force over load says something."""
    return np.asarray(part.Fz >= constants.LEAST_LOADED * np.max(part.Fz, initial=0.0))


class Unusual(NamedTuple):
    """A value outside what tyres usually have."""

    column: str
    said: str  #: words that follow the name of the column
    impossible: bool = False  #: whether physics excludes it


def _steep(part: Points, config: Config) -> Iterator[Unusual]:
    # Only the angle itself may change the force: an angle that a force deflects is steep in it.
    free = _loaded(part) & part.free_rolling
    upright, straight = np.abs(part.gamma) <= UPRIGHT.rad, np.abs(part.alpha) <= STRAIGHT.rad
    for angle, steepest, alone in (
        ("alpha", constants.STEEPEST_OVER_SIDESLIP, upright),
        ("gamma", WEAKEST_CAMBER_IN_RADIANS, straight),
    ):
        for way in (1, -1):
            found = slope(part, part.Fy, angle, free & alone & (part.direction == way), STILL_IN_RADIANS)
            if found.sign and abs(found.value) > steepest:
                largest = np.degrees(np.max(np.abs(getattr(part, angle))))
                said = (
                    f"reaches only {largest:.3g} deg, over which the side force changes by {abs(found.value):.0f} times the load "
                    "per radian"
                )
                yield Unusual(f"{angle}_deg", said)


def _reached(values: np.ndarray) -> float:
    """The absolute value that at least a few of the values (n,) reach, so that single wild ones do not count; 0 with too few."""
    sizes = np.sort(np.abs(values[np.isfinite(values)]))
    few = int(constants.FEWEST)
    return float(sizes[-few]) if len(sizes) >= few else 0.0


def _strong(part: Points, config: Config) -> Iterator[Unusual]:
    loaded, radius = _loaded(part), config.tyre.unloaded_radius
    for column, reading, largest in (
        ("Fy_N", part.Fy, CREDIBLE_FRICTION),
        ("Mz_Nm", part.Mz, constants.LARGEST_MOMENT_ARM * radius),
        ("Mx_Nm", part.Mx, CREDIBLE_FRICTION * radius),
    ):
        reached = _reached(reading[loaded] / part.Fz[loaded])
        if reached > largest:
            unit = " m" if column.endswith("Nm") else ""
            said = f"reaches {reached:.2g}{unit} times the load, where no tyre exceeds {largest:.3g}{unit}"
            yield Unusual(column, said, impossible=True)


def _weak(part: Points, config: Config) -> Iterator[Unusual]:
    shows = (np.abs(part.alpha) >= constants.SIDESLIP_OF_SLOPES.rad) | (
        np.abs(part.gamma) >= CAMBER_THAT_SHOWS_FORCE
    )
    force = np.abs(part.Fy[shows])
    if np.sum(shows) >= constants.FEWEST and np.max(force / part.Fz[shows]) < constants.SMALLEST_FRICTION:
        said = f"is at most {np.max(force):.3g} N at loads of {np.median(part.Fz):.0f} N"
        yield Unusual("Fy_N", said)


def _pressure(part: Points, config: Config) -> Iterator[Unusual]:
    nominal, pressure = 1e3 * config.tyre.nominal_pressure, float(np.median(part.p))
    lowest, highest = constants.USUAL_PRESSURE
    if not lowest * nominal <= pressure <= highest * nominal:
        said = f"is {pressure / 1e3:.3g} kPa, far from the nominal {nominal / 1e3:.3g} kPa"
        yield Unusual("p_kPa", said)


def _slippery(part: Points, config: Config) -> Iterator[Unusual]:
    far = (np.abs(part.alpha) >= constants.SIDESLIP_OF_FRICTION.rad) & _loaded(part) & part.free_rolling
    if np.sum(far) >= constants.FEWEST:
        friction = np.max(np.abs(part.Fy[far]) / part.Fz[far])
        if friction < constants.USUAL_FRICTION:
            largest = np.degrees(np.max(np.abs(part.alpha[far])))
            yield Unusual(
                "Fy_N", f"reaches {friction:.2g} times the load up to {largest:.3g} deg of sideslip"
            )


Test = Callable[[Points, Config], Iterator[Unusual]]
TESTS: tuple[Test, ...] = (_pressure, _steep, _weak, _strong)
ASKED: tuple[Test, ...] = (*TESTS, _slippery)
"""With tests that some sound tyre or road does not pass, and by which no file is refused."""


def unusual(part: Points, config: Config, tests: tuple[Test, ...] = TESTS) -> list[Unusual]:
    """The unusual values of a file; empty for most files."""
    return [found for test in tests for found in test(part, config)]


def _explained(found: list[Unusual], part: Points, config: Config) -> tuple[Unusual, list[Mistake]] | None:
    """What known mistakes explain, and these: without one of them the least is unusual, and nothing that was usual before."""
    before, best = {one.column for one in found}, None
    for mistake in (one for one in MISTAKES if found and one.beyond_doubt):
        left = {one.column for one in unusual(mistake.undone(part, AS_READ), config, ASKED)}
        if left < before:
            before = left
            best = next(one for one in found if one.column not in left), [mistake]
        elif best and left == before and mistake.column == best[1][0].column and best[1][0].units:
            best[1].append(mistake)
    return best


@rule_of_files(id="impossible-file", sentence="{said}; {looks}")
def impossible_file(part: Points, config: Config) -> Iterator[Finding]:
    """Pressure over the nominal one, slopes of Fy over the angles, Fy, Mz and Mx over load; as read and without each mistake."""
    found = unusual(part, config)
    if explained := _explained(found, part, config):
        (column, said, _), (mistake, *others) = explained
        said = said if column == mistake.column else f"{column} {said}"
        also = "".join(f" or {other.units[0]}" for other in others if other.units)
        looks = f"it looks like {mistake.looks}{also}: {mistake.remedy}"
        looks += ", with the true unit" * bool(also)
        yield Finding({"said": said, "looks": looks}, column=mistake.column)
    for column, said, impossible in found:
        if impossible:
            yield Finding({"said": said, "looks": UNEXPLAINED}, column=column)


UNEXPLAINED = "no single unit or exchanged heading explains it: check the columns and units of this file"


@rule_of_files(id="unusual-file", outcome=Outcome.WARNED, sentence="{column} of {file} {said}; {looks}")
def unusual_file(part: Points, config: Config) -> Iterator[Finding]:
    """The same, where neither physics nor a known mistake decides."""
    for column, said, _ in unusual(part, config):
        yield Finding(
            {"column": column, "said": said, "looks": UNEXPLAINED, "file": part.files[part.file[0]]}
        )


@rule_of_files(
    id="low-friction",
    outcome=Outcome.WARNED,
    sentence="{column} of {file} {said}: unless the road was wet or of ice, check the units of Fy_N and Fz_N (a load in lbf, "
    "kgf or kN and a force in another unit look like this)",
)
def low_friction(part: Points, config: Config) -> Iterator[Finding]:
    """Fy per load at large sideslip, where nothing else is unusual."""
    if not unusual(part, config):
        for column, said, _ in _slippery(part, config):
            yield Finding({"column": column, "said": said, "file": part.files[part.file[0]]})
