"""What was not found: how large each other effect can be without contradicting the readings."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from mffit.diagnosis.candidates import Hypothesis, Problem
from mffit.effects import Effect
from mffit.scatter import rms

COVERED = 2.0
"""Standard deviations within which the true size is expected."""


@dataclass(frozen=True, slots=True)
class Limit:
    """The largest size of an effect that the readings leave open."""

    effect: Effect
    share: float  #: of the size that it usually has (1 sigma); the rms of them if it has several

    @property
    def ruled_out(self) -> bool:
        """Whether the effect would have been seen at its usual size."""
        return self.share < 1.0


def limits(
    problem: Problem, chosen: Hypothesis, candidates: Sequence[Effect], known: Collection[str]
) -> tuple[Limit, ...]:
    """The limits of all candidates but those named or tied (``known`` ids), to first order beside what was chosen."""
    residual, Q = chosen.residual, np.empty((len(chosen.residual), 0))
    if chosen.jacobian.shape[1]:
        Q = np.linalg.qr(chosen.jacobian)[0]
    others = [e for e in candidates if e.id not in known and not e.switches]
    out = []
    for effect, groups in problem.columns(chosen.state, others).items():
        sizes = []
        for columns in groups:  # where an effect is even in its number, the start that shows it best counts
            white = problem.noise.whiten(columns[:, np.any(columns != 0.0, axis=0)])
            white = white - Q @ (Q.T @ white)
            covariance = np.linalg.inv(white.T @ white + np.eye(white.shape[1]))
            found = np.abs(covariance @ (white.T @ residual))
            sizes.append(rms(found + COVERED * np.sqrt(np.diag(covariance))))
        out.append(Limit(effect, min(sizes)))
    return tuple(sorted(out, key=lambda row: row.share))
