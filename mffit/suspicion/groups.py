"""Groups of points that would share a mistake: every sweep, and every condition of a sweep with several conditions."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from mffit.constants import FEWEST, MOST
from mffit.points import Points, levels
from mffit.quantities import COLUMNS
from tir.frozen import ReadOnlyArrays


@dataclass(frozen=True, slots=True, eq=False)
class Group(ReadOnlyArrays):
    """Points that would share a mistake."""

    name: str  #: in sentences
    file: str
    index: np.ndarray  #: (m,) indices of the points
    whole: bool  #: True for a whole sweep, False for one of its conditions


def groups(points: Points) -> list[Group]:
    """Every sweep, and every condition (load, pressure, direction, mount, camber) of a sweep with several conditions."""
    found = [*_sweeps(points), *_conditions(points)]
    unique = {group.index.tobytes(): group for group in reversed(found)}
    # Only a minority of the points can contradict the others.
    return [g for g in reversed(unique.values()) if FEWEST <= len(g.index) <= 0.5 * len(points)]


def kind_of(points: Points, index: np.ndarray) -> tuple[str, bool, tuple[int, ...]]:
    """What rows (m,) have in common with those of which the formula misses alike: the slip or angle that they move most, relative
    to all points, whether most are driven or braked, and, without sideslip that moves, the sizes of held angles, in tolerances.
    """
    moved = {
        name: float(np.ptp(getattr(points, name)[index])) / (float(np.ptp(getattr(points, name))) or np.inf)
        for name in ("alpha", "kappa", "gamma")
    }
    moving = max(moved, key=lambda name: moved[name])
    held = [] if moving == "alpha" else [name for name in ("alpha", "gamma") if name != moving]
    sizes = (
        float(np.median(np.abs(getattr(points, name)[index]))) / levels.KINDS[name].tolerance for name in held
    )
    return moving, bool(np.mean(points.free_rolling[index]) < MOST), tuple(map(round, sizes))


def alike(points: Points, group: Group, every: Sequence[Group]) -> list[Group]:
    """Whole sweeps of the group's kind, of other files if there are any: a file may share its mistake; empty without any."""
    kind = kind_of(points, group.index)
    found = [g for g in every if g.whole and not np.isin(g.index, group.index).any()]
    found = [g for g in found if kind_of(points, g.index) == kind]
    return [g for g in found if g.file != group.file] or found


def readings_of(points: Points) -> np.ndarray:
    """Conditions and readings (n, 6) by which one point is a copy of another."""
    Mz = np.nan_to_num(points.Mz)
    return np.column_stack([points.alpha, points.gamma, points.Fz, points.Fy, Mz, points.direction])


def _sweeps(points: Points) -> Iterator[Group]:
    for k, index in points.rows_of_sweeps.items():
        file = points.files[points.file[index[0]]]
        yield Group(name=points.sweep_names[k], file=file, index=index, whole=True)


def confirmed_by_others(part: Points, others: Points, columns: Collection[str] = ()) -> bool:
    """Whether other points cover the load, the camber to either side and the pressure of a sweep, or those in ``columns``.

    If not, only the formula predicts the sweep from them, and it may be wrong between two loads, cambers or pressures. Between
    the outermost of several levels the readings confirm it.
    """
    for name in levels.SETTINGS:
        if columns and COLUMNS[name] not in columns:
            continue
        kind = levels.KINDS[name]
        own, known = (np.abs(getattr(of, name)) for of in (part, others))
        several = levels.count(known, kind) >= FEWEST
        own, known = (levels.in_tolerances(values, kind) for values in (own, known))
        own, known = own[np.isfinite(own)], np.sort(known[np.isfinite(known)])
        below, above = (np.searchsorted(known, own + shift) for shift in (-1.0, 1.0))
        measured = (below < above) | (several & (below > 0) & (above < len(known)))
        if 2 * np.sum(measured) < len(own):
            return False
    return True


def parts_of_sweeps(points: Points) -> np.ndarray:
    """Index (n,) of each point's part, from 0: a sweep, or one condition of a sweep with several conditions."""
    out = np.empty(len(points), dtype=int)
    for k, (_, rows, _) in enumerate(_parts(points)):
        out[rows] = k
    return out


def _conditions(points: Points) -> Iterator[Group]:
    for sweep, rows, by_camber in _parts(points):
        if len(rows) < len(sweep.index):
            part = points.select(rows)
            said = f"{np.mean(part.Fz):.0f} N, {np.mean(part.p) / 1e3:.0f} kPa"
            if by_camber:
                said += f", camber {np.degrees(np.mean(part.gamma)):z.0f} deg"
            yield Group(name=f"{sweep.name} at {said}", file=sweep.file, index=rows, whole=False)


def _parts(points: Points) -> Iterator[tuple[Group, np.ndarray, bool]]:
    """Every sweep with the indices (m,) of one of its conditions, and whether camber distinguishes the conditions."""
    load = levels.labels_of_setting(points, "Fz")
    pressure = levels.nearest_labels(points.p, levels.PRESSURE)
    camber = levels.nearest_labels(points.gamma, levels.CAMBER)
    for sweep in _sweeps(points):
        i = sweep.index
        own = levels.count(points.gamma[i], levels.CAMBER)
        keys = np.column_stack([load[i], pressure[i], points.direction[i], points.mount[i]])
        # In a camber sweep camber varies continuously and is not a condition.
        few = own * FEWEST <= len(i)
        by_camber = few and not levels.spread(points.gamma[i], levels.CAMBER)
        if by_camber:
            keys = np.column_stack([keys, camber[i]])
        for rows in levels.rows_of_equal(keys):
            yield sweep, i[rows], by_camber
