"""A single sweep that was written down wrongly: reversed, in another unit, or under another load, camber or pressure."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from mffit.points import Points, levels
from mffit.points.mistakes import MISTAKES
from mffit.quantities import CHANNELS, CONDITIONS
from mffit.rig import Simulation
from mffit.scatter import robust, usual_size

GROSS = 0.15
"""Share of a channel's usual size from which on a sweep is looked at."""
ALONE = 3.0
"""How much farther off than the sweeps usually are it must be."""
BEYOND = 2.0
"""How much farther off than any other: a model that is out everywhere misses some sweeps more than others."""
AS_OTHERS = 1.5
"""How far off, compared with them, it may be when the mistake is undone."""
EXPLAINED = 1.0 / 3.0
"""Share of its error that may be left."""
FEWEST_SWEEPS = 4
LABELS = (("Fz", "Fz_N", levels.LOAD), ("gamma", "gamma_deg", levels.CAMBER), ("p", "p_kPa", levels.PRESSURE))
SHOWN = {"Fz": 1.0, "gamma": 180.0 / np.pi, "p": 1e-3}
"""From SI to the unit of the column."""


@dataclass(frozen=True, slots=True)
class Misread:
    """One sweep that looks like a known mistake."""

    sweep: str
    file: str
    looks: str
    column: str
    remedy: str
    before: float  #: how far it is off, as a share of the usual size of the channel that is worst
    after: float  #: with the mistake undone


def misread(points: Points, start: Simulation, signs: Mapping[str, float]) -> Misread | None:
    """The one sweep that contradicts the model in a way of its own which a known mistake explains; None if there is none.

    Where several sweeps look like one, it is the model or the rig that is at fault.

    Parameters
    ----------
    points : as declared (n,)
    start : the simulation as given; it may miss all sweeps by something else
    signs : +1 or -1 per channel, what turns ISO-W into the rig's axes
    """
    numbers = [k for k in np.unique(points.sweep) if np.sum(points.sweep == k) > 2]
    if len(numbers) < FEWEST_SWEEPS:
        return None
    parts = [points.select(points.sweep == k) for k in numbers]
    size = {name: usual_size(getattr(p, name) / p.Fz for p in parts) for name in CHANNELS}
    off = [_off(part, start, size) for part in parts]
    usual = {name: float(np.median([o[name] for o in off if name in o] or [np.nan])) for name in CHANNELS}
    found = []
    for part, before in zip(parts, off, strict=True):
        worst = {n: max((o[n] for o in off if o is not before and n in o), default=0.0) for n in before}
        gross = {n: e for n, e in before.items() if e > max(GROSS, ALONE * usual[n], BEYOND * worst[n])}
        best: Misread | None = None
        for looks, column, remedy, undone in _mistakes(part, points, signs) if gross else ():
            after = _off(undone, start, size)
            if all(after[n] < EXPLAINED * e for n, e in gross.items()) and all(
                e < max(AS_OTHERS * usual[n], GROSS, before[n] if n not in gross else 0.0)
                for n, e in after.items()
            ):
                left = max(after.values())
                if best is None or left < best.after:
                    name = part.sweep_names[part.sweep[0]]
                    file = part.files[part.file[0]]
                    best = Misread(name, file, looks, column, remedy, max(gross.values()), left)
        if best is not None:
            found.append(best)
    return found[0] if len(found) == 1 else None


def _mistakes(
    part: Points, points: Points, signs: Mapping[str, float]
) -> Iterator[tuple[str, str, str, Points]]:
    """What each mistake looks like, its column, what to do, and the points without it."""
    for mistake in MISTAKES:
        if mistake.beyond_doubt:
            yield mistake.looks, mistake.column, mistake.remedy, mistake.undone(part, signs)
    for channel, column, quantity in LABELS:
        held = getattr(part, channel)
        here = float(np.mean(held))
        if levels.spread(held, quantity):
            continue
        for level in np.unique(np.round(levels.level_values(getattr(points, channel), quantity), 9)):
            if abs(level - here) > quantity.tolerance * (here if quantity.relative else 1.0):
                word, _, unit = CONDITIONS[column]
                size = signs[channel] * level * SHOWN[channel] if channel in signs else level * SHOWN[channel]
                said = f"{abs(size) if channel == 'Fz' else size:.4g} {unit}"
                yield (
                    f"run at a {word} of {said}", column, f"write the {word} that was run, {said}",
                    part.replace(**{channel: held + (level - here)}),
                )  # fmt: skip


def _off(part: Points, start: Simulation, size: Mapping[str, float]) -> dict[str, float]:
    """Median error of each channel of some points, as a share of its usual size."""
    out = start.readings(part)
    load = float(np.mean(part.Fz))
    return {
        name: robust((getattr(part, name) - getattr(out, name)) / (size[name] * load))
        for name in CHANNELS
        if np.isfinite(size[name]) and np.isfinite(getattr(part, name)).any()
    }
