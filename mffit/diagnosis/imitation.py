"""Imitation of causes outside the library: how well other effects explain each effect of the library if it is removed."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from mffit.diagnosis import constants
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.effects import Effect


def imitations(problem: DiagnosisProblem, candidates: Sequence[Effect]) -> np.ndarray:
    """Share (n,) of each effect's change of the readings that the best single other effect would explain.

    Computed in whitened readings at the given model, to first order. Effects without influence are left out, and so are rivals
    that practically equal the effect: a cause imitated so well would leave nothing unexplained.
    """
    found = []
    for groups in problem.columns(problem.start, candidates).values():
        white = max((problem.noise.whiten(columns) for columns in groups), key=lambda w: float(np.sum(w**2)))
        size = float(np.sum(white**2))
        if size > 0.0:
            left, values, _ = np.linalg.svd(white, full_matrices=False)
            found.append((white / np.sqrt(size), left[:, values > 1e-9 * values[0]]))
    out = []
    for k, (white, _) in enumerate(found):
        shares = [float(np.sum((axes.T @ white) ** 2)) for j, (_, axes) in enumerate(found) if j != k]
        out.append(max((x for x in shares if x < constants.SAME_EFFECT_SHARE), default=0.0))
    return np.array(out)


def is_no_imitation(share: float, imitated: np.ndarray) -> float:
    """Probability that an effect which explains this share of the misfit is real, and not only an imitation of an unknown cause.

    The unknown cause is taken as certain. The rank of the share among those of imitations (n,) is a p-value, which bounds the
    Bayes factor by -e p ln p (Sellke, Bayarri and Berger, The American Statistician 55, 2001).
    """
    p = (1.0 + float(np.sum(imitated >= share))) / (1.0 + len(imitated))
    bound = -math.e * p * math.log(p) if p < 1.0 / math.e else 1.0
    return min(1.0 - p, 1.0 / (1.0 + bound / constants.KNOWN_BESIDE_UNKNOWN))
