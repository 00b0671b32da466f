"""The pages of the effects."""

from __future__ import annotations

from collections.abc import Sequence

from mffit.effects import CATALOG, NEEDS, Effect, Free
from mffit.rig_errors import BY_NAME as RIG_ERRORS
from tir.errors import listed
from tir.parameters import BY_NAME

SWITCHES = {"turn_slip": ("–", "whether the simulation has turn slip")}
"""Unit and meaning of what is neither a coefficient of the file nor a rig error."""
RESULT = {
    "tyre": "Becomes coefficients of the corrected `.tir`, with the reason in their comments.",
    "rig": "Becomes a correction of the readings. Remedies have the signs of the rig's own axes.",
    "environment": "Becomes a term in addition to the file: MF 6.2 has no coefficient for it.",
}
KINDS = {"tyre": "The tyre", "rig": "The rig", "environment": "The environment"}


def page(effect: Effect, catalog: Sequence[Effect] = CATALOG) -> str:
    """The page of one effect in Markdown.

    Effects that it can be confused with are links if they are in ``catalog``.
    """
    names = {other.id: other.name for other in catalog}
    alike = [f"[{names[i]}]({i}.md)" if i in names else f"`{i}`" for i in effect.confusable_with]
    facts = [f"`{effect.id}`", effect.kind]
    facts += [f"needs {listed([NEEDS[need] for need in effect.needs])}"] if effect.needs else []
    lines = [f"# {effect.name[:1].upper()}{effect.name[1:]}", "", " · ".join(facts), "", effect.physics, ""]
    lines += [_item(free) for free in effect.free]
    if effect.remedy:
        number = f"`{effect.free[0].name}`"
        remedy = effect.remedy.format(value=number, opposite=f"-{number}")
        lines += ["", f"At the rig: {remedy}."]
    if alike:
        lines += ["", f"Can be confused with {listed(alike)}."]
    return "\n".join(lines) + "\n"


def index(catalog: Sequence[Effect] = CATALOG) -> str:
    """The page that lists all effects."""
    lines = [
        "# The effects",
        "",
        "What [a diagnosis](../diagnosis.md) can name. These pages are written from the records in `mffit/effects`. "
        "Each states what an effect frees, with its usual size, and with what it can be confused in a full programme. "
        "Limits are those of [the table of parameters](../parameters.md) and of [the rig errors](../rig-errors.md).",
    ]
    for kind, title in KINDS.items():
        lines += ["", f"## {title}", RESULT[kind], ""]
        lines += [
            f"- [{e.name}]({e.id}.md): {', '.join(f'`{n}`' for n in e.parameters)}"
            for e in catalog
            if e.kind == kind
        ]
    return "\n".join(lines) + "\n"


def pages(catalog: Sequence[Effect] = CATALOG) -> dict[str, str]:
    """All pages by file name."""
    return {"index.md": index(catalog)} | {f"{effect.id}.md": page(effect, catalog) for effect in catalog}


def _item(free: Free) -> str:
    """A number that the effect frees, as an item of a list."""
    unit, meaning = _described(free.name)
    meaning += ", one for every run" if free.per_run else ""
    meaning += ", one for every set-up" if free.per_setup else ""
    if free.name == "turn_slip":
        return f"- `turn_slip`: {meaning}, off to on"
    scale = " × its value" if free.relative else ""
    return f"- `{free.name}` [{unit}]: {meaning}; usually {free.spread:g}{scale}"


def _described(name: str) -> tuple[str, str]:
    """Unit and meaning of a number."""
    if name in SWITCHES:
        return SWITCHES[name]
    if name in RIG_ERRORS:
        return RIG_ERRORS[name].unit, RIG_ERRORS[name].meaning
    row = BY_NAME[name]
    return row.unit, row.description + (f" ({row.equation})" if row.equation else "")
