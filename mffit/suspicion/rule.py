"""The records: what a suspicion is, and what it found."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any, NamedTuple

from mffit.errors import InputError


class When(StrEnum):
    """When a rule is applied."""

    READING = "while a recording becomes points"
    BEFORE = "before the fit"
    MEASURED = "after the direct method, with or without a fit"
    FIRST = "after the first fit"
    AFTER = "after the fit"
    DIAGNOSIS = "before a diagnosis"


class Subject(StrEnum):
    """What one call of a rule is given."""

    SAMPLES = "samples of a recording"
    FILE = "one file"
    SIGN = "sign of a slope"
    SIZE = "size of a slope"
    ALL_FILES = "all files"
    SWEEP = "one sweep against all others"
    MODEL = "the fitted model"
    DIRECT = "the direct measurement"
    READINGS = "single readings"
    SIMULATION = "one sweep against a simulation"


class Outcome(StrEnum):
    """What follows if a rule applies."""

    REFUSED = "the command ends"
    CONTRADICTION = "the declaration is contradicted"
    WARNED = "a warning"
    DISTRUSTED = "the result is not to be trusted"
    GRADED = "the result is not to be trusted, or a warning where chance is unlikely but not excluded"
    LEFT_OUT = "left out, with a warning"


class Finding(NamedTuple):
    """One case in which a rule applies."""

    facts: Mapping[str, Any]  #: fill the rule's sentence
    file: str | Path | None = None
    line: int | None = None
    column: str | None = None
    key: str | None = None  #: of ``tyre.toml``


Find = Callable[..., Iterable[Any]]
"""What it takes and finds depends on the subject."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Rule:
    """One suspicion."""

    id: str
    when: tuple[When, ...] = (When.BEFORE,)
    subject: Subject
    looks_at: str  #: what is compared, in words
    limits: tuple[float, ...] = ()  #: records of ``constants.py``
    outcome: Outcome = Outcome.REFUSED
    sentence: str  #: filled with the facts of a finding
    find: Find

    def said(self, facts: Mapping[str, Any]) -> str:
        """The sentence about one finding."""
        return self.sentence.format(**facts)

    def refusal(self, finding: Finding, file: str | None = None) -> InputError:
        """The error that ends the command; ``file`` is named if the finding names none."""
        return InputError(
            self.said(finding.facts),
            file=finding.file or file,
            line=finding.line,
            column=finding.column,
            key=finding.key,
        )


def rule(
    *,
    id: str,
    subject: Subject,
    sentence: str,
    limits: tuple[float, ...] = (),
    when: tuple[When, ...] = (When.BEFORE,),
    outcome: Outcome = Outcome.REFUSED,
) -> Callable[[Find], Rule]:
    """Decorator that turns a finder into a rule; the first line of the finder's docstring names what is compared."""

    def of(find: Find) -> Rule:
        looks_at = (find.__doc__ or "").partition("\n")[0].rstrip(".")
        return Rule(
            id=id,
            when=when,
            subject=subject,
            looks_at=looks_at,
            limits=limits,
            outcome=outcome,
            sentence=sentence,
            find=find,
        )

    return of
