"""All effects, in one list: tyre, rig and environment compete. Those of the rig are made from its records of errors."""

import tomllib
from collections.abc import Iterator
from importlib import resources
from typing import Any

from mffit.effects.effect import Effect, Free
from mffit.rig_errors import BY_NAME, RIG_ERRORS, Appearance, RigError


def tyre_effect(id: str, row: dict[str, Any]) -> Effect:
    """The effect of a table of ``tyre_effects.toml``."""
    free = tuple(Free(name=name, **_values(own)) for name, own in row["free"].items())
    return Effect(id=id, kind="tyre", **{**_values(row), "free": free})


def _values(row: dict[str, Any]) -> dict[str, Any]:
    """The values of a table, with lists as tuples."""
    return {key: tuple(value) if isinstance(value, list) else value for key, value in row.items()}


def _tyre_effects() -> Iterator[Effect]:
    text = resources.files(__package__).joinpath("tyre_effects.toml").read_text(encoding="utf-8")
    return (tyre_effect(id, row) for id, row in tomllib.loads(text).items())


def _effects(error: RigError) -> Iterator[Effect]:
    """The effects as which a diagnosis sees a rig error: with one number for the whole test, and with one for every run."""
    for seen in (error.seen_as, error.seen_per_run):
        if seen is not None:
            yield _effect(error, seen)


def _effect(error: RigError, seen: Appearance) -> Effect:
    return Effect(
        id=seen.id,
        name=seen.name,
        kind=error.kind,
        physics=seen.physics,
        free=(_free(error, seen), *(_free(BY_NAME[name]) for name in seen.together_with)),
        needs=seen.needs,
        remedy=seen.remedy,
        axes=seen.axes,
    )


def _free(error: RigError, seen: Appearance | None = None) -> Free:
    per_run = seen is not None and seen is error.seen_per_run
    return Free(
        name=error.name,
        spread=error.spread if seen is None or seen.spread is None else seen.spread,
        scan=error.scan,
        lower=error.lower,
        upper=error.upper,
        relative=error.relative,
        per_run=per_run,
        per_setup=error.of_setup and not per_run,
    )


CATALOG: tuple[Effect, ...] = (
    *_tyre_effects(),
    *(effect for error in RIG_ERRORS for effect in _effects(error)),
)
NAMES = {effect.id: effect.name for effect in CATALOG}
