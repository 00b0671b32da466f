"""How well a library of effects imitates a cause that it lacks, judged by taking each of its own effects out in turn."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mffit.diagnosis.problem import DiagnosisProblem
from mffit.effects import Effect


def imitations(problem: DiagnosisProblem, candidates: Sequence[Effect]) -> np.ndarray:
    """Share (n,) of the misfit of each effect, as large as it usually is, that the best single other effect would explain.

    All in whitened readings at the given model, to first order. Effects without influence there are left out.
    """
    found = []
    for groups in problem.columns(problem.start, candidates).values():
        white = max((problem.noise.whiten(columns) for columns in groups), key=lambda w: float(np.sum(w**2)))
        size = float(np.sum(white**2))
        if size > 0.0:
            left, values, _ = np.linalg.svd(white, full_matrices=False)
            found.append((white / np.sqrt(size), left[:, values > 1e-9 * values[0]]))
    return np.array(
        [
            max(
                (float(np.sum((axes.T @ white) ** 2)) for j, (_, axes) in enumerate(found) if j != k),
                default=0.0,
            )
            for k, (white, _) in enumerate(found)
        ]
    )


def as_likely_imitated(share: float, imitated: np.ndarray) -> float:
    """Probability that one effect explains at least this share of the misfit of a cause outside the library.

    ``imitated`` (n,) is what the library does with each of its own effects taken out. One more is counted on either side, as
    for any rank among n draws.
    """
    return (1.0 + float(np.sum(imitated >= share))) / (1.0 + len(imitated))
