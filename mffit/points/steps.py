"""Samples from recordings with steps of the sideslip angle or of slip, for the relaxation length."""

import itertools
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from mffit.constants import STRAIGHT
from mffit.points import constants
from mffit.points.choice import settings_of
from mffit.points.clock import rolled_distance
from mffit.points.points import Points, concatenate, make_points
from mffit.points.steady import Scale, stretches
from mffit.points.stretch import PLATEAU, Stretch
from mffit.sweeps import Sweep


class Stepped(NamedTuple):
    """A setting that a rig steps from one value to another."""

    force: str  #: channel that responds
    smallest: float  #: smallest change that counts as a step
    beside: str  #: the other setting, which must rest
    rests: float  #: largest absolute value of the other setting


STEPPED = {
    "alpha": Stepped("Fy", STRAIGHT.rad, "kappa", float(constants.SLIP)),
    "kappa": Stepped("Fx", float(constants.SLIP), "alpha", STRAIGHT.rad),
}
"""Stepped settings by name."""


def steps(
    sweeps: Sequence[Sweep], phi_t: Mapping[str, float], radius: float, scale: Scale | None = None
) -> dict[str, Points]:
    """By stepped setting, the samples of all runs of steps between held values, with each run as a sweep with times.

    Settings without steps have no entry. ``phi_t`` is the turn slip of the path [1/m] by file; ``radius`` is the unloaded
    radius [m], the scale of relaxation lengths.
    """
    found: dict[str, list[Points]] = {}
    for sweep in sweeps:
        if not sweep.is_series or np.any(np.diff(sweep.time) <= 0.0):
            continue
        for number, (setting, begin, end) in enumerate(_runs(sweep, radius, scale), 1):
            if np.any(np.isfinite(getattr(sweep, STEPPED[setting].force)[begin:end])):
                samples = _samples(sweep, f"{sweep.name}:{number:02d}", phi_t[sweep.file], begin, end)
                found.setdefault(setting, []).append(samples)
    return {setting: concatenate(parts) for setting, parts in found.items()}


def _runs(sweep: Sweep, radius: float, scale: Scale | None) -> list[tuple[str, int, int]]:
    """The setting, the begin and the end (excluded) of every run of steps."""
    if len(sweep) < 2 or not all(np.all(np.isfinite(x)) for x in settings_of(sweep)):
        return []
    rolled = rolled_distance(sweep.time, sweep.V)
    rest = constants.SHORTEST_REST * radius
    held = [s for s in stretches(settings_of(sweep), scale=scale) if s.kind == PLATEAU and not s.dropped]
    out: list[tuple[str, int, int]] = []
    for before, after in itertools.pairwise(held):
        for setting in STEPPED:
            if not _is_step(sweep, setting, rolled, before, after, radius):
                continue
            if out and out[-1][::2] == (setting, before.end):
                out[-1] = (setting, out[-1][1], after.end)
            else:
                # The force may still be settling to the first held value.
                settled = int(np.searchsorted(rolled, rolled[before.begin] + rest))
                out.append((setting, min(settled, before.end - 1), after.end))
    return out


def _is_step(
    sweep: Sweep, setting: str, rolled: np.ndarray, before: Stretch, after: Stretch, radius: float
) -> bool:
    """Whether a setting steps from one plateau to the next fast enough, with all else constant, and is then held long enough."""
    rows, step = slice(before.begin, after.end), STEPPED[setting]
    values = getattr(sweep, setting)
    first, last = (float(np.median(values[s.begin : s.end])) for s in (before, after))
    if abs(last - first) < step.smallest or np.max(np.abs(getattr(sweep, step.beside)[rows])) > step.rests:
        return False
    if np.ptp(sweep.gamma[rows]) > constants.STEP_OF_ANGLE.rad or np.any(np.diff(sweep.direction[rows])):
        return False
    load = sweep.Fz[rows]
    if np.ptp(load) > constants.HELD_LOAD * np.mean(load):
        return False
    share = (values[rows] - first) / (last - first)
    leaves, arrives = int(np.argmax(share > 0.1)), len(share) - int(np.argmax(share[::-1] < 0.9)) - 1
    way = rolled[rows][arrives] - rolled[rows][leaves]
    spacing = float(np.median(np.diff(rolled[rows])))
    rest = rolled[after.end - 1] - rolled[rows][arrives]
    return bool(
        way <= constants.LONGEST_STEP * radius
        and 0.0 < spacing <= constants.LONGEST_STEP * radius
        and rest >= constants.SHORTEST_REST * radius
    )


def _samples(sweep: Sweep, name: str, phi_t: float, begin: int, end: int) -> Points:
    rows = slice(begin, end)
    names = ("p", "V", "T", "kappa", "Fx", "Fy", "omega", "direction", "line")
    return make_points(
        sweep.alpha[rows],
        sweep.gamma[rows],
        sweep.Fz[rows],
        sweep_names=(name,),
        files=(sweep.file,),
        phi_t=phi_t,
        time=sweep.time[rows],
        mount=sweep.mount,
        continuous=True,
        **{name: getattr(sweep, name)[rows] for name in names},
    )
