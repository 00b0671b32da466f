"""Records of a rule of suspicion and of its findings."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import wraps
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from mffit.config import Config
from mffit.errors import InputError
from mffit.points import Points


class When(StrEnum):
    """When a rule is applied."""

    READING = "while a recording becomes points"
    BEFORE = "before the fit"
    MEASURED = "after the direct method, with or without a fit"
    AFTER = "after the fit"
    DIAGNOSIS = "before a diagnosis"


class Outcome(StrEnum):
    """Consequence of a rule that applies."""

    REFUSED = "the command ends"
    CONTRADICTION = "the declaration is contradicted"
    WARNED = "a warning"
    DISTRUSTED = "the result is not to be trusted"
    GRADED = "the result is not to be trusted, or a warning where chance is unlikely but not excluded"
    LEFT_OUT = "left out, with a warning"


class Finding(NamedTuple):
    """One case in which a rule applies."""

    facts: Mapping[str, Any]  #: values that fill the rule's sentence
    file: str | Path | None = None
    line: int | None = None
    column: str | None = None
    key: str | None = None  #: key of ``tyre.toml``


Find = Callable[..., Iterable[Any]]
"""Finder of a rule. Before the fit its arguments are points and configuration; later they depend on the module."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Rule:
    """One rule of suspicion."""

    id: str
    when: When = When.BEFORE
    looks_at: str  #: the compared quantities, in words
    outcome: Outcome = Outcome.REFUSED
    sentence: str  #: template, filled with the facts of a finding
    find: Find
    of_all: bool = (
        False  #: before the fit, whether points count that are otherwise not judged, such as driven ones
    )

    def said(self, facts: Mapping[str, Any]) -> str:
        """The sentence about one finding."""
        return self.sentence.format(**facts)

    def refusal(self, finding: Finding) -> InputError:
        """The error that ends the command."""
        said = self.said(finding.facts)
        return InputError(said, file=finding.file, line=finding.line, column=finding.column, key=finding.key)


def rule(**told: Any) -> Callable[[Find], Rule]:
    """Decorator that turns a finder into a rule; the first line of the finder's docstring becomes ``looks_at``."""
    return lambda find: Rule(looks_at=(find.__doc__ or "").partition("\n")[0].rstrip("."), find=find, **told)


def rule_of_files(**told: Any) -> Callable[[Find], Rule]:
    """Decorator that turns a finder for the points of one file into a rule for all files."""

    def of(find: Find) -> Rule:
        @wraps(find)
        def everywhere(points: Points, config: Config) -> Iterator[Finding]:
            for k in np.unique(points.file):
                for finding in find(points.select(points.file == k), config):
                    yield finding._replace(file=points.files[k])

        return rule(**told)(everywhere)

    return of
