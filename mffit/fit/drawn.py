"""Random tyres drawn from the posterior of a fit."""

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np

from mffit.fit import constants
from mffit.fit.constraints import Envelope, violations
from mffit.fit.result import FitResult
from mffit.least_squares import root
from tir.parameters import BY_NAME


def ensemble(found: FitResult, count: int, *, seed: int = 0) -> list[dict[str, float]]:
    """Coefficients of ``count`` tyres drawn from the joint posterior, each within its bounds and the physical limits.

    A tyre is drawn again until it keeps the limits; after many rejected draws, closer and closer to the best tyre. The same
    seed gives the same members.
    """
    assert found.search is not None
    random, posterior, best = np.random.default_rng(seed), found.posterior, found.tyre.values
    names = [name for name in posterior.names if name in best]
    mean, spread = np.array([float(best[n]) for n in names]), root(posterior.covariance_of(names))
    envelope = found.search.problem.envelope
    hand, out = found.search.hand, []
    for _ in range(count):
        for k in range(2 * constants.MOST_DRAWS):
            away = spread @ random.standard_normal(len(names)) * 0.5 ** max(0, k - constants.MOST_DRAWS)
            inside = {n: BY_NAME[n].inside(x) for n, x in zip(names, (mean + away).tolist(), strict=True)}
            drawn = hand.within(inside)
            if _is_possible(best, drawn, envelope):
                break
        out.append(drawn)
    return out


def _is_possible(best: Mapping[str, Any], drawn: Mapping[str, float], envelope: Envelope | None) -> bool:
    """Whether the drawn structural stiffnesses are positive and the limits hold over the envelope."""
    if not all(x > 0.0 for name, x in drawn.items() if name.endswith("STIFFNESS")):
        return False
    p = SimpleNamespace(**{**best, **drawn})
    return envelope is None or bool(np.max(violations(p, envelope)) <= constants.LIMIT_MARGIN)
