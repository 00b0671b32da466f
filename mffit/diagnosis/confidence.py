"""Confidence of an answer from the weight of its evidence."""

from __future__ import annotations

from mffit.diagnosis import constants


def tempered(weight: float) -> float:
    """The weight of an explanation among all others, its log odds divided by ``LOG_ODDS_DIVISOR``."""
    if not 0.0 < weight < 1.0:
        return min(max(weight, 0.0), 1.0)
    odds = (weight / (1.0 - weight)) ** (1.0 / constants.LOG_ODDS_DIVISOR)
    return odds / (1.0 + odds)
