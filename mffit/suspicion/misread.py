"""Detection of a single sweep that a simulation misses because it was recorded wrongly.

Its sign is reversed, its unit is wrong, or its label states a wrong load, camber or pressure.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial

import numpy as np

from mffit.constants import FEWEST
from mffit.points import Points, levels
from mffit.points.constants import UNLIKE_SHARE
from mffit.points.points import of_si
from mffit.quantities import COLUMNS, CONDITIONS, SIDEWAYS
from mffit.rig import Simulation
from mffit.scatter import robust, usual_size
from mffit.suspicion import constants
from mffit.suspicion.rereadings import Away, Mistake, certain_mistakes, explaining
from mffit.suspicion.rule import Outcome, When, rule


@dataclass(frozen=True, slots=True)
class Misread:
    """A sweep whose errors a known mistake explains."""

    sweep: str
    file: str
    looks: str
    column: str
    remedy: str
    before: float  #: median error of the worst channel, as a share of its usual size
    after: float  #: largest such error of any channel with the mistake undone

    @property
    def sentence(self) -> str:
        """The remark about the sweep."""
        return misread_sweep.said(asdict(self) | {"percent": 100 * self.before, "left": 100 * self.after})


def misread(
    points: Points, simulation: Simulation, signs: Mapping[str, float], channels: Collection[str] = SIDEWAYS
) -> Misread | None:
    """The single sweep whose contradiction to a simulation a known mistake explains; None if there is none or several."""
    return next(iter(misread_sweep.find(points, simulation, signs, channels)), None)


@rule(
    id="misread-sweep",
    when=When.DIAGNOSIS,
    outcome=Outcome.LEFT_OUT,
    sentence=(
        "{file}: {sweep} misses the simulation by {percent:.0f} % of what sweeps usually read, as no other does; it looks "
        "like {looks}, which leaves {left:.2g} %. It was left out. In column {column}: {remedy}."
    ),
)
def misread_sweep(
    points: Points, simulation: Simulation, signs: Mapping[str, float], channels: Collection[str] = SIDEWAYS
) -> Iterator[Misread]:
    """Median error of the simulation over the usual size of the channel, with each known mistake undone.

    A sweep is found if its error clearly exceeds that of any other and a known mistake explains it. If this holds for several
    sweeps, the model or the rig is at fault. A small error counts as a wrong label only if sound sweeps of the same kind at or
    around that label confirm the model there. ``signs`` convert from ISO-W to the rig's axes.
    """
    numbers, counts = np.unique(points.sweep, return_counts=True)
    numbers = numbers[counts >= FEWEST]
    if len(numbers) < FEWEST:
        return
    parts = [points.select(points.sweep == k) for k in numbers]
    size = {name: usual_size(p.channel(name) / p.Fz for p in parts) for name in channels}

    def away(of: Points) -> dict[str, Away]:
        return {n: Away(error=e, share=e) for n, e in _off(of, simulation, size).items()}

    off = [_off(part, simulation, size) for part in parts]
    usual = {name: float(np.median([o[name] for o in off if name in o] or [np.nan])) for name in channels}
    found = []
    for part, before in zip(parts, off, strict=True):
        others = [o for o in off if o is not before]
        worst = {name: max((o[name] for o in others if name in o), default=0.0) for name in before}
        beyond = {n: e for n, e in before.items() if e > constants.DISTRUSTED_MISFIT * worst[n]}
        gross = {name: error for name, error in beyond.items() if error > UNLIKE_SHARE}
        wrong, least = (gross, float(UNLIKE_SHARE)) if gross else (beyond, 0.0)
        tolerated = {
            n: max(constants.DISTRUSTED_MISFIT * usual[n], least, 0.0 if n in wrong else before[n])
            for n in before
        }
        candidates = _candidates(part, points, signs, () if gross else [p for p in parts if p is not part])
        best = explaining(candidates, wrong, away, tolerated) if wrong else None
        if best is not None:
            mistake = best.mistake
            found.append(
                Misread(
                    sweep=part.sweep_names[part.sweep[0]],
                    file=part.files[part.file[0]],
                    looks=mistake.looks,
                    column=mistake.column,
                    remedy=mistake.remedy,
                    before=max(wrong.values()),
                    after=best.left,
                )
            )
    if len(found) == 1:
        yield found[0]


def _held(part: Points, channel: str) -> float:
    """Absolute mean of a condition of a sweep."""
    return float(abs(np.mean(getattr(part, channel))))


def _near(kind: levels.LevelKind, value: float) -> float:
    """Difference up to which values of a condition count as equal."""
    return kind.tolerance * (value if kind.relative else 1.0)


def _differ_only_in(part: Points, other: Points, channel: str) -> bool:
    """Whether two sweeps vary the same angles, in the same direction and mount, and agree in all labels except ``channel``."""
    if any((np.ptp(getattr(part, a)) > 0.0) != (np.ptp(getattr(other, a)) > 0.0) for a in ("alpha", "gamma")):
        return False
    if part.direction[0] != other.direction[0] or part.mount[0] != other.mount[0]:
        return False
    return all(
        abs(_held(part, name) - _held(other, name)) <= _near(levels.KINDS[name], _held(part, name))
        for name in levels.SETTINGS
        if name != channel
    )


def _candidates(
    part: Points, points: Points, signs: Mapping[str, float], confirming: Sequence[Points]
) -> Iterator[tuple[Mistake, Points]]:
    """The mistakes that may explain a sweep, each with the corrected points: known ones, and every other level of a condition at
    which it may have been run.

    With ``confirming`` sweeps, only levels of conditions at or around which these confirm the model.
    """
    if not confirming:
        rest = points.select(points.sweep != part.sweep[0])
        yield from certain_mistakes(part, signs, rest, by_formula=False)
    for channel in levels.SETTINGS:
        held, kind = getattr(part, channel), levels.KINDS[channel]
        here, size = float(np.mean(held)), _held(part, channel)
        near = _near(kind, here)
        if confirming:
            alike = [_held(other, channel) for other in confirming if _differ_only_in(part, other, channel)]
            if not (any(x <= size + near for x in alike) and any(x >= size - near for x in alike)):
                continue
        if levels.spread(held, kind):
            continue
        for level in np.unique(np.round(levels.level_values(getattr(points, channel), kind), 9)):
            if abs(level - here) > near:
                mistake = _run_at(channel, COLUMNS[channel], signs, here, float(level))
                yield mistake, mistake.undone(part, signs)


def _run_at(channel: str, column: str, signs: Mapping[str, float], here: float, level: float) -> Mistake:
    """The mistake that a condition with the label ``here`` was run at another level."""
    word, _, unit = CONDITIONS[column][:3]
    size = signs.get(channel, 1.0) * level * of_si(column)
    run = f"{abs(size) if channel == 'Fz' else size:.4g} {unit}"
    return Mistake(
        looks=f"run at a {word} of {run}",
        column=column,
        remedy=f"write the {word} that was run, {run}",
        undone=partial(_moved, channel=channel, step=level - here),
    )


def _moved(points: Points, signs: Mapping[str, float], channel: str, step: float) -> Points:
    return points.replace(**{channel: getattr(points, channel) + step})


def _off(part: Points, simulation: Simulation, size: Mapping[str, float]) -> dict[str, float]:
    """By channel, the robust size of the errors of some points, as a share of the channel's usual size."""
    load = float(np.mean(part.Fz))
    return {
        name: robust((part.channel(name) - read) / (size[name] * load))
        for name, read in simulation.readings(part, size).items()
        if np.isfinite(size[name]) and np.isfinite(part.channel(name)).any()
    }
