"""The repaired part of an explanation: likely effects that left-out sweeps confirm, and the property file that follows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from mffit.constants import MOST
from mffit.diagnosis.estimated import estimated
from mffit.diagnosis.explanation import Explanation
from mffit.diagnosis.notes import FileKept, NoRepair
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.diagnosis.rest import Rest
from mffit.diagnosis.result import AcceptedEffect
from mffit.diagnosis.search import Search
from mffit.diagnosis.validation import Validation, validate
from mffit.effects import Effect


@dataclass(frozen=True, slots=True, eq=False)
class Confirmed:
    """The explanation that left-out sweeps confirm, and what follows from it."""

    found: Explanation
    given: DiagnosisProblem  #: the problem of the given model, with the pure scatter of the readings
    named: tuple[AcceptedEffect, ...]
    alternatives: Mapping[str, float]  #: id -> confidence of effects that were not accepted
    rest: tuple[Rest, ...]  #: what the explanation leaves beyond chance


@dataclass(frozen=True, slots=True)
class Repair:
    """The effects and coefficients with which the model and the readings are corrected."""

    explanation: Explanation
    validation: Validation  #: validation of the repair, not of all named effects
    refused: NoRepair | FileKept | None = None


def checked(
    found: Explanation, given: DiagnosisProblem, search: Search
) -> tuple[Explanation, Validation, NoRepair | None]:
    """The explanation if left-out sweeps confirm it, else its first effect alone, else none; its validation; and the refusal.

    ``given`` has the pure scatter of the readings.
    """
    validation = validate(
        given, found.refined, found.freed, weights=found.plain.noise, seen=search.asked.seen
    )
    if not (found.chosen.effects or found.coefficients) or validation.gain > 0.0:
        return found, validation, None
    refused = NoRepair(tuple(effect.name for effect in found.chosen.effects), validation)
    if len(found.chosen.effects) > 1:
        first = estimated(found.only(found.chosen.effects[:1]), search)
        return (*checked(first, given, search)[:2], refused)
    return found.withdrawn(), validation.without_repair(), refused


def repair(confirmed: Confirmed, validation: Validation, search: Search) -> Repair:
    """The repair of the named effects that are likely, or of every one if that is asked.

    Tied effects are one answer, with the confidence of the whole tie. ``validation`` belongs to all named effects together.
    Effects of the tyre are repaired only if the corrected property file predicts left-out sweeps better than the given one,
    judged by all channels together, with the errors of rig and environment taken out of the readings.
    """
    found, named = confirmed.found, confirmed.named
    refused: NoRepair | FileKept | None = None

    def only(effects: Sequence[Effect]) -> tuple[Explanation, Validation, NoRepair | None]:
        return checked(estimated(found.only(tuple(effects)), search), confirmed.given, search)

    likely = [
        one.effect
        for one in named
        if search.asked.repair_all or one.confidence_of_tie(confirmed.alternatives) >= MOST
    ]
    if len(likely) < len(found.chosen.effects):
        found, validation, refused = only(likely)
    of_tyre = tuple(effect for effect in found.chosen.effects if effect.kind == "tyre")
    if not of_tyre or validation.gain_of_file > 0.0:
        return Repair(found, validation, refused)
    kept = FileKept(tuple(effect.name for effect in of_tyre), validation)
    found, validation, refused = only([effect for effect in found.chosen.effects if effect not in of_tyre])
    return Repair(found, validation, refused or kept)
