"""What remains beyond an explanation, with its evidence, and the answers that may follow from it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum

import numpy as np
from scipy.special import chdtrc

from mffit.constants import ODD_SWEEP_RATIO
from mffit.diagnosis import constants
from mffit.diagnosis.explanation import Explanation
from mffit.diagnosis.noise import Origin
from mffit.scatter import rms, robust
from mffit.suspicion.constants import DISTRUSTED_MISFIT
from mffit.suspicion.others import without_worst


class Answer(Enum):
    """The answer of a diagnosis."""

    NOTHING = "nothing is missing"
    FOUND = "something is missing, and this is it"
    UNDECIDED = "something may be missing, and these data cannot tell what"
    UNKNOWN = "something is missing, and no effect of the library is it"


class RestKind(Enum):
    """The way in which an explanation leaves more than noise."""

    SMOOTH = "smooth structure over the conditions"
    LOCAL = "structure in one place"
    SCATTER = "scatter far beyond the stated noise"
    SWEEP = "one sweep that contradicts the others"
    COEFFICIENTS = "coefficients further from the file of a build than their uncertainty explains"
    ALL = "misfit so far beyond the noise that the model hardly is one of this tyre"


@dataclass(frozen=True, slots=True)
class Rest:
    """Misfit that remains in addition to all effects, and that chance does not explain."""

    kind: RestKind
    channel: str  #: "" if it is in several
    evidence: float  #: log odds of an unknown cause over chance
    ratio: float = math.nan  #: misfit over stated noise, if that is the reason
    sweep: str = ""  #: the sweep that has most of it, if one has

    @property
    def found(self) -> bool:
        """Whether there is such a cause beyond reasonable doubt."""
        return self.evidence > constants.STRUCTURE_EVIDENCE


def remaining(found: Explanation) -> tuple[Rest, ...]:
    """Everything that an explanation leaves beyond chance, the most certain first; empty if it leaves noise."""
    left = [rest for rest in (*_structure(found), *_beyond_noise(found), *_sweeps(found)) if rest.found]
    return tuple(sorted(left, key=lambda rest: -rest.evidence))


def hardly_this_tyre(found: Explanation) -> tuple[Rest, ...]:
    """The misfit of a model that is so wrong, even with the best effects, that a name would be a guess; else empty.

    A file of a build is so wrong if its coefficients leave their uncertainty. Otherwise it is the robust misfit in units of the
    stated noise, of the channel that fits better: one channel may be mostly noise.
    """
    if found.strained:
        return (Rest(RestKind.COEFFICIENTS, "", math.inf),)
    noise = found.scatter
    residual = found.plain.measured - found.plain.predict(found.refined.state)
    z = np.where(np.isfinite(noise.stated), residual / noise.stated, np.nan)
    misfit = {
        name: float(np.nan_to_num(robust(rows), nan=math.inf)) for name, rows in noise.by_channel(z).items()
    }
    better = min(misfit, key=misfit.__getitem__)
    judged = found.chosen.effects or noise.origin is Origin.STATED
    if judged and constants.MISFIT_OF_ANOTHER_TYRE < misfit[better] < math.inf:
        return (Rest(RestKind.ALL, better, math.inf, misfit[better]),)
    return ()


def _structure(found: Explanation) -> Iterator[Rest]:
    """Smooth and local structure, each with the price of its search."""
    if found.smooth.is_strange:
        most = max(found.smooth.strange, key=found.smooth.amplitude.__getitem__)
        yield Rest(RestKind.SMOOTH, most, found.smooth.unexcused)
    yield Rest(RestKind.LOCAL, found.bump.channel, found.bump.gain)


def _beyond_noise(found: Explanation) -> Iterator[Rest]:
    """Channels that scatter far more than stated even with the explanation, each with the sweep that scatters most."""
    noise, points = found.scatter, found.problem.points
    if noise.origin is not Origin.STATED:
        return
    left = noise.by_channel(found.plain.measured - found.plain.predict(found.refined.state))
    for channel, residual in left.items():
        u = noise.of_channel(noise.u, channel)
        known = np.isfinite(u)
        if not known.any():
            continue
        ratio = rms(u[known] / noise.of_channel(noise.stated, channel)[known])
        evidence = _log_odds(ratio / constants.STATED_NOISE_FACTOR**2, int(known.sum()))
        off = {name: rms(residual[points.sweep == k]) for k, name in enumerate(points.sweep_names)}
        off = {name: size for name, size in off.items() if np.isfinite(size)}
        worst = max(off, key=off.__getitem__)
        odd = off[worst] > ODD_SWEEP_RATIO * float(np.median(list(off.values())))
        yield Rest(RestKind.SCATTER, channel, evidence, ratio, worst if odd else "")


def _log_odds(ratio: float, n: int) -> float:
    """Log likelihood ratio of normal scatter as seen over one of unit size; 0 if it is not larger."""
    return 0.5 * n * (ratio**2 - 1.0 - 2.0 * float(np.log(ratio))) if ratio > 1.0 else 0.0


def _sweeps(found: Explanation) -> Iterator[Rest]:
    """The sweep with the least probable misfit of each channel, in units of the estimated noise, without its worst points."""
    points, noise = found.problem.points, found.problem.noise
    n = len(points)
    row, channel = noise.used % n, noise.used // n
    square = found.chosen.residual**2
    names = np.unique(points.sweep).tolist()
    for k, name in enumerate(noise.channels):
        worst = Rest(RestKind.SWEEP, name, 0.0)
        for sweep in names:
            own = square[(channel == k) & (points.sweep[row] == sweep)]
            own = own[without_worst(own)]
            ratio = float(np.sqrt(np.mean(own))) if len(own) else 0.0
            if ratio <= DISTRUSTED_MISFIT:
                continue
            chance = float(chdtrc(len(own), float(np.sum(own))))
            evidence = -float(np.log(max(chance * len(names), 1e-300)))
            if evidence > worst.evidence:
                worst = Rest(RestKind.SWEEP, name, evidence, ratio, points.sweep_names[sweep])
        yield worst
