"""Priors set by hand that the points contradict."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from scipy.special import ndtri

from mffit.constants import FALSE_ALARM
from mffit.fit.fitted import Fitted
from mffit.fit.priors import Prior
from tir import Quantity
from tir.parameters import BY_NAME


class Contradiction(NamedTuple):
    """A prior and what all else says about the same coefficient."""

    name: str
    points: Quantity  #: of the points and the priors of all other numbers
    prior: Prior
    apart: float  #: difference over its standard uncertainty


def contradicted_priors(fitted: Fitted) -> Iterator[Contradiction]:
    """The priors set by hand that differ from the points by more than chance explains.

    The posterior of one number is the mean of prior and points, weighted by their information, so that the part of the points
    follows from posterior and prior.
    """
    stderr = fitted.posterior.stderr
    far = float(-ndtri(FALSE_ALARM / (2.0 * max(len(fitted.hand.priors), 1))))
    for name, prior in fitted.hand.priors.items():
        if name not in fitted.values or name in fitted.at_bound:
            continue
        both, own = stderr[name] ** -2.0, prior.spread**-2.0
        if not both > own:  # the points say nothing
            continue
        value = (both * fitted.values[name] - own * prior.expected) / (both - own)
        u = (both - own) ** -0.5
        apart = abs(value - prior.expected) / math.hypot(u, prior.spread)
        if apart > far:
            yield Contradiction(name, Quantity(value, u, BY_NAME[name].unit), prior, apart)
