"""The repaired part of an explanation: likely effects that left-out sweeps confirm."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from mffit.diagnosis import constants
from mffit.diagnosis.explanation import Explanation
from mffit.diagnosis.inexact import EXACT, Inexactness
from mffit.diagnosis.notes import FileKept, NoRepair
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.diagnosis.result import AcceptedEffect
from mffit.diagnosis.validation import Validation, validate
from tir.parameters import BY_NAME


@dataclass(frozen=True, slots=True)
class Repair:
    """The effects and coefficients with which the model and the readings are corrected."""

    explanation: Explanation
    validation: Validation  #: validation of the repair, not of all named effects
    refused: NoRepair | FileKept | None
    keeps_file: bool
    """Whether the given property file is kept, because the corrected one without its rig and environment terms is worse."""


def checked(
    found: Explanation, given: DiagnosisProblem, inexact: Inexactness, *, seen: bool
) -> tuple[Explanation, Validation, NoRepair | None]:
    """The explanation if left-out sweeps confirm it, else one without effects; its validation; and the refusal, if any.

    ``given`` has the pure scatter of the readings. ``seen``: the model was fitted to these points.
    """
    # Without an effect, refitting coefficients to the points of their own fit repairs nothing.
    if seen and not found.chosen.effects:
        found = found.withdrawn()
    coefficients = inexact if found.coefficients else EXACT
    validation = validate(given, found.refined, coefficients, weights=found.plain.noise, seen=seen)
    if not (found.chosen.effects or found.coefficients) or validation.helps:
        return found, validation, None
    refused = NoRepair(tuple(effect.name for effect in found.chosen.effects), validation)
    return found.withdrawn(), validation.without_repair(), refused


def repair(
    found: Explanation,
    named: Sequence[AcceptedEffect],
    given: DiagnosisProblem,
    inexact: Inexactness,
    validation: Validation,
    alternatives: Mapping[str, float],
    *,
    seen: bool,
    every: bool,
) -> Repair:
    """The repair of the ``named`` effects that are likely, or of ``every`` one.

    Tied effects are one answer, with the confidence of the whole tie. ``validation`` belongs to all named effects together,
    ``alternatives`` has the confidences of other effects by id. ``seen``: the model was fitted to these points.
    """
    likely = tuple(
        one.effect for one in named if every or one.confidence_of_tie(alternatives) >= constants.LIKELY_ANSWER
    )
    refused = None
    if len(likely) < len(named):
        found, validation, refused = checked(
            found.only(likely).with_coefficients(inexact), given, inexact, seen=seen
        )
    terms = tuple(effect.name for effect in found.chosen.effects if effect.kind != "tyre")
    changed = any(n in BY_NAME for n in found.coefficients) or any(
        e.kind == "tyre" for e in found.chosen.effects
    )
    if not terms or not changed or validation.file_helps:
        return Repair(found, validation, refused, keeps_file=False)
    return Repair(found, validation, FileKept(terms, validation), keeps_file=True)
