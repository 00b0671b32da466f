"""Record of a rule of suspicion, and the decorators that make one from a finder."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import wraps
from typing import Any

import numpy as np

from mffit.config import Config
from mffit.errors import InputError
from mffit.points import Points

Facts = Mapping[str, Any]
"""One case in which a rule applies: the values in its sentence.

Before the fit, ``file``, ``line``, ``column`` (heading) and ``key`` (of ``tyre.toml``) give its place. ``asked`` marks a case of
a graded rule that is unusual but contradicts nothing.
"""
PLACE = ("file", "line", "column", "key")
Find = Callable[..., Iterable[Any]]
"""Finder of a rule. Before the fit its arguments are points and configuration; later they depend on the module."""


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
    GRADED = (
        "as refused (before the fit) or distrusted if the data contradict it; a warning if it is only unusual"
    )
    LEFT_OUT = "left out, with a warning"


@dataclass(frozen=True, slots=True, kw_only=True)
class Rule:
    """One rule of suspicion."""

    id: str
    when: When = When.BEFORE
    looks_at: str  #: the compared quantities, in words
    outcome: Outcome = Outcome.REFUSED
    sentence: str  #: template, filled with the facts of a case
    find: Find
    of_all: bool = False  #: whether a rule before the fit also judges points that are driven or braked

    def said(self, facts: Facts) -> str:
        """The sentence about one case."""
        return self.sentence.format(**facts)

    def only_asks(self, facts: Facts) -> bool:
        """Whether a case is a question to the engineer, not a verdict."""
        return bool(facts.get("asked", self.outcome is Outcome.WARNED))

    def refusal(self, facts: Facts) -> InputError:
        """The error that ends the command; its text, with the place, is also that of a warning."""
        return InputError(self.said(facts), **{name: facts[name] for name in PLACE if name in facts})


def rule(**told: Any) -> Callable[[Find], Rule]:
    """Decorator that turns a finder into a rule; the first paragraph of the finder's docstring becomes ``looks_at``."""

    def of(find: Find) -> Rule:
        first = (find.__doc__ or "").partition("\n\n")[0]
        return Rule(looks_at=" ".join(first.split()).rstrip("."), find=find, **told)

    return of


def each_file(find: Find) -> Find:
    """Decorator that turns a finder for the points of one file, without their table, into a finder for all files."""

    @wraps(find)
    def everywhere(points: Points, config: Config) -> Iterator[Facts]:
        for k in np.unique(points.file):
            for facts in find(points.select(points.file == k, with_table=False), config):
                yield {"file": points.files[k], **facts}

    return everywhere
