"""The page of the effects."""

from __future__ import annotations

from collections.abc import Sequence

from mffit.effects import CATALOG, NEEDS, Effect, Free
from mffit.rig_errors import BY_NAME as RIG_ERRORS
from tir.errors import listed

INTRODUCTION = """\
# Effects

What [a diagnosis](diagnosis.md) can name, and the numbers that each effect frees: [coefficients](reference.md), with their usual
size, or [rig errors](rig-errors.md).
"""
RESULT = {
    "tyre": "## The tyre\nBecomes coefficients of the corrected `.tir`, with the reason in their comments.",
    "rig": "## The rig\nBecomes a correction of the readings. Remedies have the signs of the rig's own axes.",
    "environment": "## The environment\nBecomes a term in addition to the file: MF 6.2 has no coefficient for it.",
}


def page(catalog: Sequence[Effect] = CATALOG) -> str:
    """The page in Markdown: the effects of every kind."""
    lines = [INTRODUCTION]
    for kind, title in RESULT.items():
        lines += [title, *(_item(effect) for effect in catalog if effect.kind == kind), ""]
    return "\n".join(lines)


def _item(effect: Effect) -> str:
    """An effect as an item of a list."""
    text = f"- **{effect.name}** (`{effect.id}`) frees {', '.join(_freed(free) for free in effect.free)}. {effect.physics}"
    if effect.needs:
        text += f" Needs {listed([NEEDS[need] for need in effect.needs])}."
    if effect.remedy:
        number = f"`{effect.free[0].name}`"
        text += f" At the rig: {effect.remedy.format(value=number, opposite=f'-{number}')}."
    return text


def _freed(free: Free) -> str:
    """A number that the effect frees, with its usual size."""
    if free.name == "turn_slip":
        return "`turn_slip`, off to on"
    if free.name in RIG_ERRORS:
        return f"`{free.name}`" + (" of every run" if free.per_run else "")
    scale = " × its value" if free.relative else ""
    return f"`{free.name}` ({free.spread:g}{scale})"
