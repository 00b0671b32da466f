"""Upper limits of the sizes of effects that were not named."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from mffit.as_json import keys
from mffit.constants import TWO_SIGMA
from mffit.diagnosis.hypothesis import Hypothesis
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.effects import Effect
from mffit.linearised.gaussian import Informed
from mffit.scatter import rms


@dataclass(frozen=True, slots=True)
class Limit:
    """The largest size of an effect that agrees with the readings."""

    effect: Effect
    share: float  #: largest size over the usual size (1 sigma); rms over its numbers if it has several

    @property
    def ruled_out(self) -> bool:
        """Whether the effect would have been seen at its usual size."""
        return self.share < 1.0


keys(Limit, "id=effect.id of_usual_size=share ruled_out")


def limits(
    problem: DiagnosisProblem, chosen: Hypothesis, candidates: Sequence[Effect], known: Collection[str]
) -> tuple[Limit, ...]:
    """The limits of all candidates except named and tied ones (``known`` ids), to first order, given the chosen effects."""
    axes, out = chosen.axes, []
    others = [e for e in candidates if e.id not in known and not e.switches]
    for effect, groups in problem.columns(chosen.state, others).items():
        sizes = []
        for columns in groups:
            white = problem.noise.whiten(columns[:, np.any(columns != 0.0, axis=0)])
            white = white - axes @ (axes.T @ white)  # what the numbers of the chosen effects cannot follow
            found = Informed.of_rows(white, chosen.residual)
            sizes.append(rms(np.abs(found.mean) + TWO_SIGMA * found.u))
        # An effect that is even in its number is tested from several starts; the most sensitive one counts.
        out.append(Limit(effect, min(sizes)))
    return tuple(sorted(out, key=lambda row: row.share))
