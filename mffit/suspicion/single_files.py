"""Checks of single files: values that are unusual or impossible, and the reading under which the file would be plausible.

Numbers in a wrong unit can be plausible one by one and impossible in combination. Unusual values are refused if physics excludes
them or a known mistake explains them; otherwise they are asked for.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from mffit.config import Config
from mffit.constants import EXPLAINED_SHARE, FEWEST, STRAIGHT, UPRIGHT
from mffit.points import Points
from mffit.points.constants import UNLOADED
from mffit.suspicion import constants
from mffit.suspicion.groups import readings_of
from mffit.suspicion.rereadings import ANGLES_EXCHANGED, MISTAKES
from mffit.suspicion.rule import Facts, Outcome, each_file, rule
from mffit.suspicion.slopes import STILL, slope
from tir.constants import CREDIBLE_FRICTION

WEAKEST_CAMBER_THRUST = constants.USUAL_CAMBER_THRUST[0]
WEAKEST_CAMBER_IN_RADIANS = float(np.degrees(WEAKEST_CAMBER_THRUST))
"""Slope of Fy/Fz over camber [1/rad] of the tyre with the weakest camber force, if radians are read as degrees."""
CAMBER_THAT_SHOWS_FORCE = constants.SMALLEST_FRICTION / WEAKEST_CAMBER_THRUST
"""Camber [rad] from which every tyre has a visible side force."""
STILL_IN_RADIANS = {angle: float(np.radians(still)) for angle, still in STILL.items()}
"""Range of an angle that stands still, if radians are read as degrees."""
AS_READ = dict.fromkeys(("alpha", "gamma", "Fz", "Fy", "Mz"), 1.0)
"""Signs of the rig's axes; these checks use sizes only, so all are +1."""


@rule(id="dead-channel", sentence="is {reading:g} in every row, so the channel was dead; {remedy}")
@each_file
def dead_channel(part: Points, config: Config) -> Iterator[Facts]:
    """Mz and Fy that are the same in every row although the angles change, and a speed of 0, at which there is no slip."""
    if len(part) < FEWEST or np.ptp(part.alpha) + np.ptp(part.gamma) == 0.0:
        return
    for column, reading, remedy in (
        ("Mz_Nm", part.Mz, "leave the column out of this file"),
        ("Fy_N", part.Fy, "leave this file out"),
        ("V_mps", part.V, "leave the column out of this file"),
    ):
        if np.all(reading == reading[0]) and not (column == "V_mps" and reading[0] > 0.0):
            yield {"column": column, "reading": reading[0], "remedy": remedy}


@rule(
    id="repeated-rows",
    sentence="holds rows twice, with the same readings ({count} copies); remove the copies, as they would count as more readings",
)
@each_file
def repeated_rows(part: Points, config: Config) -> Iterator[Facts]:
    """Rows with the readings of another row of the file, if they are half of it."""
    first = np.unique(readings_of(part), axis=0, return_index=True)[1]
    copies = np.setdiff1d(np.arange(len(part)), first)
    if len(part) >= FEWEST and 2 * len(copies) >= len(part) and np.ptp(part.Fy) > 0.0:
        yield {"line": _line(part, copies[0]), "count": len(copies)}


def _line(part: Points, row: int) -> int | None:
    """Line of a point in its file; None if it is unknown."""
    return int(part.line[row]) or None


@rule(
    id="lone-load",
    outcome=Outcome.GRADED,
    sentence="{load:.6g} N is far above all other loads of the file, which are at most {others:.6g} N{seen} correct or remove "
    "the row",
)
@each_file
def lone_load(part: Points, config: Config) -> Iterator[Facts]:
    """Largest load over all others of the file; refused if the side force hardly differs from that at the nearest angles."""
    row = int(np.argmax(part.Fz))
    others = float(np.sort(part.Fz)[-2]) if len(part) >= FEWEST else np.inf
    if not part.Fz[row] > constants.BEYOND_NOMINAL * others:
        return
    swept = part.alpha if np.ptp(part.alpha) > np.ptp(part.gamma) else part.gamma
    in_order = np.setdiff1d(np.argsort(swept), row, assume_unique=True)
    between = [np.interp(swept[row], swept[in_order], y[in_order]) for y in (part.Fy, part.Fy / part.Fz)]
    as_others = abs(part.Fy[row] - between[0])
    as_loaded = abs(part.Fy[row] - between[1] * part.Fz[row])
    asked = bool(as_others >= EXPLAINED_SHARE * as_loaded)
    seen = ": if it is a wild reading," if asked else ", and its side force is that of the others;"
    facts = {"load": part.Fz[row], "others": others, "seen": seen, "asked": asked}
    yield {"line": _line(part, row), "column": "Fz_N", **facts}


@rule(
    id="wild-force",
    sentence="{force:.6g} N is {friction:.0f} times the load, which no tyre reaches; correct or remove the row",
)
@each_file
def wild_force(part: Points, config: Config) -> Iterator[Facts]:
    """Fy per load of a few loaded rows."""
    friction = np.where(_loaded(part), np.abs(part.Fy) / part.Fz, 0.0)
    if 0 < np.sum(friction > CREDIBLE_FRICTION) < FEWEST:
        row = int(np.argmax(friction))
        yield {"line": _line(part, row), "column": "Fy_N", "force": part.Fy[row], "friction": friction[row]}


def _loaded(part: Points) -> np.ndarray:
    """Mask (n,) of the rows with enough load for the ratio of force to load to mean something."""
    return np.asarray(part.Fz >= UNLOADED * np.max(part.Fz, initial=0.0))


UNEXPLAINED = "no single unit or exchanged heading explains it: check the columns and units of this file"


class Unusual(NamedTuple):
    """A value outside the usual range of tyres."""

    column: str
    said: str  #: words that follow the name of the column
    impossible: bool = False  #: whether physics excludes it
    looks: str = UNEXPLAINED  #: what to do if no known mistake explains it


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
                change = f"yet the side force changes by {abs(found.value):.0f} times the load per radian"
                yield Unusual(f"{angle}_deg", f"spans only {largest:.3g} deg, {change}")


def _reached(values: np.ndarray) -> float:
    """The absolute value that at least a few of the values (n,) reach, so that single wild ones do not count; 0 with too few."""
    sizes = np.sort(np.abs(values[np.isfinite(values)]))
    few = int(FEWEST)
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
    if np.sum(shows) >= FEWEST and np.max(force / part.Fz[shows]) < constants.SMALLEST_FRICTION:
        said = f"is at most {np.max(force):.3g} N at loads of {np.median(part.Fz):.0f} N"
        yield Unusual("Fy_N", said)


def _pressure(part: Points, config: Config) -> Iterator[Unusual]:
    nominal, pressure = 1e3 * config.tyre.nominal_pressure, float(np.median(part.p))
    least, most = constants.USUAL_PRESSURE
    if not least <= pressure / nominal <= most:
        said = f"is {pressure / 1e3:.3g} kPa, far from the nominal {nominal / 1e3:.3g} kPa"
        yield Unusual("p_kPa", said)


def _slippery(part: Points, config: Config) -> Iterator[Unusual]:
    far = (np.abs(part.alpha) >= constants.SIDESLIP_OF_FRICTION.rad) & _loaded(part) & part.free_rolling
    if np.sum(far) >= FEWEST:
        friction = np.max(np.abs(part.Fy[far]) / part.Fz[far])
        if friction < constants.USUAL_FRICTION:
            largest = np.degrees(np.max(np.abs(part.alpha[far])))
            said = f"reaches {friction:.2g} times the load up to {largest:.3g} deg of sideslip"
            looks = (
                "unless the road was wet or of ice, check the units of Fy_N and Fz_N (a load in lbf, kgf or kN and a force in "
                "another unit look like this)"
            )
            yield Unusual("Fy_N", said, looks=looks)


Test = Callable[[Points, Config], Iterator[Unusual]]
TESTS: tuple[Test, ...] = (_pressure, _steep, _weak, _strong)
ASKED: tuple[Test, ...] = (*TESTS, _slippery)
"""With tests that some sound tyre or road does not pass, and by which no file is refused."""


def unusual(part: Points, config: Config, tests: tuple[Test, ...] = TESTS) -> list[Unusual]:
    """The unusual values of a file; empty for most files."""
    return [found for test in tests for found in test(part, config)]


@rule(id="unusual-file", outcome=Outcome.GRADED, sentence="{said}; {looks}")
@each_file
def unusual_file(part: Points, config: Config) -> Iterator[Facts]:
    """Pressure over the nominal one, slopes of Fy over the angles, Fy, Mz and Mx over load; refused if physics excludes it or a
    known mistake explains it.
    """
    found = unusual(part, config)
    if found:
        yield from _explained(found, part, config)
    for column, said, impossible, looks in found or _slippery(part, config):
        yield {"column": column, "said": said, "looks": looks, "asked": not impossible}


def _explained(found: list[Unusual], part: Points, config: Config) -> Iterator[Facts]:
    """The known mistakes without which the least is unusual, and nothing that was usual before; several only if they are units
    of one column, or the exchange of both angles.
    """
    before, what, mistakes, exchanged = {one.column for one in found}, found[0], [], ""
    for mistake in (one for one in MISTAKES if one.beyond_doubt):
        left = {one.column for one in unusual(mistake.undone(part, AS_READ), config, ASKED)}
        if left < before:
            before, mistakes = left, [mistake]
            what = next(one for one in found if one.column not in left)
            exchanged = ""
        elif mistakes and left == before and mistake is ANGLES_EXCHANGED:
            exchanged = f". Or it looks like {mistake.looks}: {mistake.remedy}"
        elif mistakes and left == before and mistake.column == mistakes[0].column and mistakes[0].units:
            mistakes.append(mistake)
    if mistakes:
        first, *others = mistakes
        said = what.said if what.column == first.column else f"{what.column} {what.said}"
        also = "".join(f" or {other.units[0]}" for other in others if other.units)
        looks = (
            f"it looks like {first.looks}{also}: {first.remedy}"
            + ", with the true unit" * bool(also)
            + exchanged
        )
        yield {"column": first.column, "said": said, "looks": looks}
