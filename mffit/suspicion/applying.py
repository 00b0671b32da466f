"""Runs the rules: before the fit, after it, and before a diagnosis."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from itertools import groupby

import numpy as np

from mffit.config import Config
from mffit.config.declared import as_declared
from mffit.points import Points
from mffit.quantities import CHANNELS
from mffit.rig import Simulation
from mffit.suspicion import declarations, outliers
from mffit.suspicion.misread import Misread
from mffit.suspicion.others import Campaign, Doubt, evidence
from mffit.suspicion.outliers import Outlier
from mffit.suspicion.prediction import FittedModel
from mffit.suspicion.rule import Finding, Outcome, Rule, Subject, When
from mffit.suspicion.rules import NO_TYRE, RULES
from mffit.suspicion.slopes import Signatures
from mffit.suspicion.trust import Misfit


def before_the_fit(points: Points, config: Config) -> tuple[str, ...]:
    """Warnings about points that are odd under their declaration.

    Parameters
    ----------
    points : as read; on a disc the samples of moving sweeps are not judged
    config : the declaration

    Raises
    ------
    InputError
        The points contradict every tyre or the declaration, or a disc cannot do without what is missing.
    """
    judged = points.select(~points.continuous) if config.rig.on_disc else points
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


def after_the_fit(campaign: Campaign, fitted: FittedModel, when: When = When.AFTER) -> tuple[Doubt, ...]:
    """Sweeps that do not fit the others, judged by what all others predict.

    Parameters
    ----------
    campaign : points, their uncertainty, and how to fit some of them
    fitted : the fit to all points
    when : ``When.FIRST`` if the fit itself may still be wrong

    Raises
    ------
    InputError
        A sweep contradicts all others beyond plausibility.
    """
    seen = evidence(campaign, fitted)
    doubts: list[Doubt] = []
    for rule in _rules(when, Subject.SWEEP) if seen is not None else ():
        for finding in rule.find(seen):
            if rule.outcome is Outcome.REFUSED:
                raise rule.refusal(finding)
            doubts.append(finding)
    return tuple(doubts)


def distrust(misfit: Misfit) -> tuple[str, ...]:
    """Why the file of a fit is not to be trusted; empty for a sound fit."""
    return tuple(
        rule.said(facts) for rule in _rules(When.AFTER, Subject.MODEL) for facts in rule.find(misfit)
    )


def misread(points: Points, simulation: Simulation, signs: Mapping[str, float]) -> Misread | None:
    """The one sweep that contradicts a simulation as a known mistake would; see :func:`misread_sweep`."""
    (rule,) = _rules(When.DIAGNOSIS)
    return next(iter(rule.find(points, simulation, signs)), None)


def contradictions(found: Signatures) -> list[str]:
    """What the signatures show that no tyre does, as beginnings of sentences; empty for plausible ones."""
    return declarations.broken(NO_TYRE, found)


def about(finding: Doubt | Misread | Sequence[Outlier]) -> str:
    """The sentence about a doubtful sweep, a misread sweep, or all outlying readings."""
    match finding:
        case Doubt():
            facts = {
                "unit": CHANNELS[finding.channel].unit,
                "percent": 100 * finding.share,
                "explained": f"; it looks like {finding.looks}" if finding.looks else "",
            }
            return _rule("doubtful-sweep").said(asdict(finding) | facts)
        case Misread():
            facts = {"percent": 100 * finding.before, "left": 100 * finding.after}
            return _rule("misread-sweep").said(asdict(finding) | facts)
        case _:
            return _rule("outlying-reading").said(outliers.in_words(finding))


def _rules(when: When, subject: Subject | None = None) -> list[Rule]:
    return [rule for rule in RULES if when in rule.when and subject in (None, rule.subject)]


def _rule(name: str) -> Rule:
    (rule,) = (rule for rule in RULES if rule.id == name)
    return rule
