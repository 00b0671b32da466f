"""The repaired part of an explanation: likely effects that left-out sweeps confirm, and the property file that follows."""

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


@dataclass(frozen=True, slots=True)
class Repair:
    """The effects and coefficients with which the model and the readings are corrected."""

    explanation: Explanation
    validation: Validation  #: validation of the repair, not of all named effects
    refused: NoRepair | FileKept | None = None


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
    if not (found.chosen.effects or found.coefficients) or validation.gain > 0.0:
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
    ``alternatives`` has the confidences of other effects by id. ``seen``: the model was fitted to these points. Effects of the
    tyre are repaired only if the corrected property file predicts left-out sweeps better than the given one, judged by all
    channels together, with the errors of rig and environment taken out of the readings.
    """
    likely = tuple(
        one.effect for one in named if every or one.confidence_of_tie(alternatives) >= constants.LIKELY_ANSWER
    )
    refused: NoRepair | FileKept | None = None
    if len(likely) < len(named):
        found, validation, refused = checked(
            found.only(likely).with_coefficients(inexact), given, inexact, seen=seen
        )
    of_tyre = tuple(effect for effect in found.chosen.effects if effect.kind == "tyre")
    if not of_tyre or validation.gain_of_file > 0.0:
        return Repair(found, validation, refused)
    kept = FileKept(tuple(effect.name for effect in of_tyre), validation)
    others = tuple(effect for effect in found.chosen.effects if effect not in of_tyre)
    found, validation, refused = checked(
        found.only(others).with_coefficients(inexact), given, inexact, seen=seen
    )
    return Repair(found, validation, refused or kept)
