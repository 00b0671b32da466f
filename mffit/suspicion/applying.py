"""Runs the rules before and after the fit."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby

import numpy as np

from mffit.config import Config
from mffit.config.loading import as_declared
from mffit.points import Points
from mffit.suspicion import constants
from mffit.suspicion.others import Doubt, JudgedSweeps, views
from mffit.suspicion.rule import Finding, Outcome, Rule, Subject, When
from mffit.suspicion.rules import RULES


def before_the_fit(points: Points, config: Config) -> tuple[str, ...]:
    """Warnings about points that are odd under their declaration.

    Points that were driven or braked are not judged, nor, on a disc, the samples of moving sweeps. An InputError says that the
    points contradict every tyre or the declaration, or that a disc cannot do without what is missing.
    """
    judged = points.select(~points.continuous) if config.rig.on_disc else points
    if np.any(judged.free_rolling) and not np.all(judged.free_rolling):
        judged = judged.select(judged.free_rolling)
    warnings = []
    with as_declared(config):
        for rule, file, finding in _before(judged, config):
            if rule.outcome is Outcome.REFUSED:
                raise rule.refusal(finding, file)
            warnings.append(rule.said(finding.facts))
    return tuple(warnings)


def _before(points: Points, config: Config) -> Iterator[tuple[Rule, str | None, Finding]]:
    """Findings in the order of the rules; neighbouring rules about single files are applied file by file."""
    parts = [(points.files[k], points.select(points.file == k)) for k in np.unique(points.file)]
    for subject, rules in groupby(_rules(When.BEFORE), key=lambda rule: rule.subject):
        same = list(rules)
        data: Sequence[tuple[str | None, Points]] = ()
        if subject is Subject.FILE:
            data = parts
        elif subject is Subject.ALL_FILES:
            data = [(None, points)]
        for file, part in data:
            for rule in same:
                for finding in rule.find(part, config):
                    yield rule, file, finding


def after_the_fit(campaign: JudgedSweeps, when: When = When.AFTER) -> tuple[Doubt, ...]:
    """Sweeps that do not fit the others, judged by what all others predict.

    ``When.FIRST``: the fit itself may still be wrong. A sweep that contradicts all others beyond plausibility is refused.
    """
    seen = views(campaign, least=constants.GROSS_SHARE if when is When.FIRST else 0.0)
    doubts: list[Doubt] = []
    for rule in _rules(when) if seen else ():
        if rule.subject is not Subject.SWEEP:
            continue
        for finding in rule.find(seen):
            if rule.outcome is Outcome.REFUSED:
                raise rule.refusal(finding)
            doubts.append(finding)
    return tuple(doubts)


def _rules(when: When) -> list[Rule]:
    return [rule for rule in RULES if when in rule.when]
