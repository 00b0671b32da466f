"""The part of an explanation that left-out sweeps confirm."""

from __future__ import annotations

from mffit.diagnosis.explain import only_first
from mffit.diagnosis.explanation import Explanation
from mffit.diagnosis.inexact import EXACT, Inexactness
from mffit.diagnosis.notes import NoRepair
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.diagnosis.validation import Validation, validate


def confirmed(
    found: Explanation, given: DiagnosisProblem, inexact: Inexactness, *, seen: bool
) -> tuple[Explanation, Validation, NoRepair | None]:
    """The whole explanation if left-out sweeps confirm it, else its first effect, else nothing; and what was refused.

    ``given`` has the scatter of the readings alone. ``seen``: the model was fitted to these points.
    """
    # Refitting coefficients to points that they were fitted to repairs nothing.
    if seen and not found.chosen.effects:
        found = found.withdrawn()
    validation = validate(given, found.refined, inexact if found.coefficients else EXACT, seen=seen)
    if not (found.chosen.effects or found.coefficients) or validation.helps:
        return found, validation, None
    refused = NoRepair(tuple(effect.name for effect in found.chosen.effects), validation)
    if len(found.chosen.effects) > 1:
        fewer = only_first(found, inexact)
        validation = validate(given, fewer.refined, inexact, seen=seen)
        if validation.helps:
            return fewer, validation, refused
    before = validation.gap_before
    return found.withdrawn(), Validation(validation.folds, before, before), refused
