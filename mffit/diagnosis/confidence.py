"""From the weight of evidence to a confidence that is right as often as it says."""

from __future__ import annotations

TEMPER = 1.35
"""What differences of log evidence are divided by.

Linearised coefficients, a noise that is itself estimated, and errors of no exact law make evidence surer than it is. Fitted by
maximum likelihood to blind campaigns (``diagnosis_study.py --doubtful --seed 21``) and checked on others, see docs/diagnosis.md.
"""


def tempered(weight: float) -> float:
    """The weight of an explanation among all others, with its log odds divided by ``TEMPER``."""
    if not 0.0 < weight < 1.0:
        return min(max(weight, 0.0), 1.0)
    odds = (weight / (1.0 - weight)) ** (1.0 / TEMPER)
    return odds / (1.0 + odds)
