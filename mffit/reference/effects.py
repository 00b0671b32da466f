"""The pages of the effects."""

from __future__ import annotations

import math
from collections.abc import Sequence

from mffit.effects import CATALOG, NEEDS, Effect, Free
from mffit.rig_errors import BY_NAME as RIG_ERRORS
from tir.errors import listed
from tir.parameters import BY_NAME

SWITCHES = {"turn_slip": ("–", "whether the simulation has turn slip")}
"""Unit and meaning of what is neither a coefficient of the file nor a rig error."""
RESULT = {
    "tyre": "It becomes coefficients of the corrected `.tir`, with the reason in their comments.",
    "rig": "It becomes a correction of the readings, and the direct method is redone with it; the tyre's file does not change.",
    "environment": "It becomes a term beside the file: MF 6.2 has no coefficient for it.",
}
KINDS = {"tyre": "The tyre", "rig": "The rig", "environment": "The environment"}


def page(effect: Effect, catalog: Sequence[Effect] = CATALOG) -> str:
    """The page of one effect in Markdown.

    Effects that it can be confused with are links if they are in ``catalog``.
    """
    names = {other.id: other.name for other in catalog}
    needs = [NEEDS[need] for need in effect.needs] or ["nothing special"]
    alike = [f"[{names[i]}]({i}.md) (`{i}`)" if i in names else f"`{i}`" for i in effect.confusable_with]
    lines = [
        f"# {effect.name[:1].upper()}{effect.name[1:]}",
        "",
        f"`{effect.id}` · {effect.kind}",
        "",
        effect.physics,
        "",
        "## What it sets free",
        "| number | unit | meaning | usual size of the change | limits | started from |",
        "|---|---|---|---|---|---|",
        *[_row(free) for free in effect.free],
        "",
        RESULT[effect.kind],
        "",
        *_remedy(effect),
        "## What the data must have",
        f"{_sentence(needs)}.",
        "",
        "## How to recognise it",
        f"Under reversed angles: {effect.parity or 'no symmetry'}. "
        + (
            f"Can be confused with {listed(alike)}."
            if alike
            else "No other effect of the library looks like it in a full programme."
        ),
    ]  # fmt: skip
    return "\n".join(lines) + "\n"


def index(catalog: Sequence[Effect] = CATALOG) -> str:
    """The page that lists all effects."""
    lines = [
        "# The effects",
        "",
        "What a diagnosis can name. These pages are written from the records in `mffit/effects`; "
        "[Diagnosis](../diagnosis.md) says how they compete.",
    ]
    for kind, title in KINDS.items():
        lines += ["", f"## {title}", "| id | frees | physics |", "|---|---|---|"]
        lines += [
            f"| [`{e.id}`]({e.id}.md) | {', '.join(f'`{n}`' for n in e.parameters)} | {e.physics} |"
            for e in catalog
            if e.kind == kind
        ]
    return "\n".join(lines) + "\n"


def pages(catalog: Sequence[Effect] = CATALOG) -> dict[str, str]:
    """All pages by file name."""
    return {"index.md": index(catalog)} | {f"{effect.id}.md": page(effect, catalog) for effect in catalog}


def _remedy(effect: Effect) -> list[str]:
    """What to do at the rig, without the number."""
    if not effect.remedy:
        return []
    said = effect.remedy.format(value="the number found", opposite="the opposite of the number found")
    return ["## What to do at the rig", f"{_sentence([said])}. Signs are those of the rig's own axes.", ""]


def _row(free: Free) -> str:
    unit, meaning = _described(free.name)
    meaning += ", one of them for every run" if free.per_run else ""
    meaning += ", one of them for every set-up of the rig, if there are several" if free.per_setup else ""
    if free.name == "turn_slip":
        return f"| `turn_slip` | {unit} | {meaning} | off to on | – | – |"
    scale = " × its value" if free.relative else ""
    lower = "–∞" if math.isinf(free.lower) else f"{free.lower:g}"
    upper = "∞" if math.isinf(free.upper) else f"{free.upper:g}"
    starts = ", ".join(f"{start:+g}" if start else "0" for start in free.scan)
    return f"| `{free.name}` | {unit} | {meaning} | {free.spread:g}{scale} | {lower} to {upper} | {starts}{scale} |"


def _described(name: str) -> tuple[str, str]:
    """Unit and meaning of a number."""
    if name in SWITCHES:
        return SWITCHES[name]
    if name in RIG_ERRORS:
        return RIG_ERRORS[name].unit, RIG_ERRORS[name].meaning
    row = BY_NAME[name]
    return row.unit, row.description + (f" ({row.equation})" if row.equation else "")


def _sentence(words: Sequence[str]) -> str:
    text = listed(words)
    return text[:1].upper() + text[1:]
