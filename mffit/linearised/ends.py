"""How fast a model goes wrong beyond the tested ranges, by the readings at their ends predicted from all others."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from mffit.linearised import constants
from mffit.linearised.channel import LinearisedChannel, Uncertain
from mffit.linearised.inputs import LEVELS, REVERSED, SLIPS, Input
from mffit.linearised.mixed import Mixed, Variances


def growths(channel: LinearisedChannel, numbers: Sequence[Uncertain]) -> np.ndarray:
    """Standard deviation (d, 2) of the error below and above every tested range, at one unit of :meth:`Input.beyond` to 3/2.

    That power is how a curve strays whose slope is known up to an end and then wanders at random. Of the load it is over the
    load, of other conditions in the unit of the channel.
    """
    model, given = _with_priors(channel, numbers)
    settings, kept = channel.seen.settings, np.sort(np.concatenate(model.groups))
    ends = [
        (i, sides, rest, kept[out])
        for i, one in enumerate(channel.smooth.inputs)
        for sides, rest, out in _ends(one, settings[kept, i])
    ]
    growth = np.zeros((settings.shape[1], 2))
    predicted = model.left_out(given, [rows for *_, rows in ends])
    for (i, sides, rest, _), found in zip(ends, predicted, strict=True):
        at = settings[found.rows, i]
        # Not all of it is the tyre's: noise, and what each run has of its own.
        own = np.exp(given.noise) + np.sum(model.own[found.rows] ** 2 * np.exp(given.own), axis=1)
        strays = (found.error**2 - own) * (channel.unit[found.rows] / rest.size(at)) ** 2
        far = np.sum(np.abs(rest.beyond(at)) ** 3)
        growth[i, sides] = np.sqrt(max(np.sum(strays), 0.0) / far) if far > 0.0 else 0.0
    return growth


def _with_priors(channel: LinearisedChannel, numbers: Sequence[Uncertain]) -> tuple[Mixed, Variances]:
    """The model with numbers that are free within their priors, because the present values are those of all readings."""
    m = len(channel.missed)
    known, free = np.linalg.norm(channel.turn, axis=1), [not number.held for number in numbers]
    spread = np.array([number.spread for number in numbers])
    has_prior = np.isfinite(spread)
    expected = np.where(has_prior, [number.expected for number in numbers], 0.0)[free]
    size = np.where(has_prior, spread, constants.FREE_OVER_KNOWN * known)[free]
    slopes = channel.slopes[:, free]
    every = max(1, len(channel.rows) // (2 * (m + len(size))))  # two readings for each number are enough
    model = replace(
        channel.model,
        residual=channel.model.residual - slopes @ expected,
        common=np.hstack([channel.model.common[:, :m], slopes * size]),
        groups=[rows[::every] for rows in channel.model.groups],
    )
    common = np.append(channel.variances.common[:m], np.zeros(len(size)))
    return model, channel.variances._replace(common=common)


def _ends(one: Input, values: np.ndarray) -> Iterator[tuple[list[int], Input, np.ndarray]]:
    """The sides of a condition's ends, the range (of the same condition) without each of them, and the rows (k,) in them.

    The formula is nearly symmetric in slips and camber, so both ends of these are one.
    """
    depth = (0.5 if one.is_held else constants.SPACINGS_OF_AN_END) * one.spacing
    if one.name in REVERSED | SLIPS:
        size = np.abs(values)
        ends = [([0, 1], size > np.max(size) - depth)]
    else:
        ends = [([0], values < one.lower + depth), ([1], values > one.upper - depth)]
    for sides, out in ends if one.name in LEVELS else ():
        rest = values[~out]
        if len(np.unique(rest)) > 1:
            yield sides, replace(one, lower=float(rest.min()), upper=float(rest.max())), np.flatnonzero(out)
