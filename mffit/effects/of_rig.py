"""Effects of rig, environment and motion, made from the records of :mod:`mffit.rig_errors`."""

from __future__ import annotations

from mffit.effects.effect import Effect, Free
from mffit.rig_errors import BY_NAME, RIG_ERRORS, Appearance, RigError


def effects_of(error: RigError) -> tuple[Effect, ...]:
    """The effects as which a diagnosis sees one rig error; none for an error that only takes part in others."""
    return tuple(_effect(error, seen) for seen in error.seen_as)


def _effect(error: RigError, seen: Appearance) -> Effect:
    return Effect(
        id=seen.id,
        name=seen.name,
        kind=error.kind,
        physics=seen.physics,
        free=(_free(error, seen), *(_free(BY_NAME[name]) for name in seen.together_with)),
        needs=seen.needs,
        parity=seen.parity,
        confusable_with=seen.confusable_with,
        remedy=seen.remedy,
        axes=seen.axes,
    )


def _free(error: RigError, seen: Appearance | None = None) -> Free:
    return Free(
        name=error.name,
        spread=error.spread if seen is None or seen.spread is None else seen.spread,
        scan=error.scan,
        lower=error.lower,
        upper=error.upper,
        relative=error.relative,
        per_run=seen is not None and seen.per_run,
    )


RIG_EFFECTS = tuple(effect for error in RIG_ERRORS for effect in effects_of(error))
