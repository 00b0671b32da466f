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
    """Standard deviation (d,) of the error beyond the tested range of every condition, over the force, at one unit of
    :meth:`Input.strayed`; from both ends.
    """
    model, given = _with_priors(channel, numbers)
    settings, kept = channel.seen.settings, np.sort(np.concatenate(model.groups))
    ends = [
        (i, rest, kept[out])
        for i, one in enumerate(channel.smooth.inputs)
        for rest, out in _ends(one, settings[kept, i])
    ]
    force = channel.seen.points.channel(channel.name) / channel.unit - channel.model.residual
    strays, far = np.zeros((2, settings.shape[1]))
    predicted = model.left_out(given, [rows for *_, rows in ends])
    for (i, rest, _), found in zip(ends, predicted, strict=True):
        # Not all of it is the tyre's: noise, and what each run has of its own.
        own = np.exp(given.noise) + np.sum(model.own[found.rows] ** 2 * np.exp(given.own), axis=1)
        strays[i] += np.sum(found.error**2 - own)
        far[i] += np.sum(force[found.rows] ** 2 * rest.strayed(settings[found.rows, i]))
    return np.asarray(np.sqrt(np.maximum(strays, 0.0) / np.where(far > 0.0, far, np.inf)))


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


def _ends(one: Input, values: np.ndarray) -> Iterator[tuple[Input, np.ndarray]]:
    """The range of a condition of the test plan without each of its ends, and the rows (k,) in this end.

    The formula is nearly symmetric in slips and camber, so both ends of these are one.
    """
    if one.name not in LEVELS:
        return
    depth = (0.5 if one.is_held else constants.SPACINGS_OF_AN_END) * one.spacing
    for place in [np.abs(values)] if one.name in REVERSED | SLIPS else [values, -values]:
        out = place > np.max(place) - depth
        rest = values[~out]
        if len(np.unique(rest)) > 1:
            yield replace(one, lower=float(rest.min()), upper=float(rest.max())), np.flatnonzero(out)
