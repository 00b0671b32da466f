"""The run that would separate two explanations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mffit.additions import ADDITIONS, SEPARATING, candidates
from mffit.additions.constants import WORTHWHILE_FALL
from mffit.config import Config
from mffit.diagnosis import constants
from mffit.diagnosis.hypothesis import Hypothesis
from mffit.points import Points
from mffit.points.points import concatenate


@dataclass(frozen=True, slots=True)
class Separation:
    """The run that separates two explanations best."""

    run: str  #: in words, with its load
    chi2: float  #: expected chi2 between the two fitted explanations

    @property
    def worthwhile(self) -> bool:
        """Whether the run is expected to decide between the two."""
        return self.chi2 >= constants.SEPARATING_CHI2


def separation(
    config: Config, points: Points, a: Hypothesis, b: Hypothesis, noise: Mapping[str, float]
) -> Separation:
    """The further run in which two refitted explanations differ most per point; among equal ones that with the fewest.

    ``noise`` is the standard uncertainty of a reading by channel; NaN for channels that were not measured.
    """
    measured = {name: u for name, u in noise.items() if np.isfinite(u)}
    runs = [
        run
        for run in candidates(config, points, kinds=(*ADDITIONS, *SEPARATING))
        if measured.keys() >= {*run.addition.measures}
    ]
    # Together with the test, whose usual speed and path are those of the explanations.
    test = concatenate([points, *(run.points for run in runs)])
    of_a, of_b = (one.state.readings(test, measured) for one in (a, b))
    apart = np.sum([((of_a[name] - of_b[name]) / u) ** 2 for name, u in measured.items()], axis=0)
    parts = np.split(apart[len(points) :], np.cumsum([run.cost for run in runs])[:-1])
    most = max(map(np.mean, parts))
    equal = [
        one for one in zip(runs, parts, strict=True) if np.mean(one[1]) >= (1.0 - WORTHWHILE_FALL) * most
    ]
    run, part = min(equal, key=lambda one: one[0].cost)
    return Separation(run.title, float(np.sum(part)))
