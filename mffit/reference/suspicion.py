"""The page of all rules of suspicion."""

from __future__ import annotations

import mffit.constants
import mffit.points.constants
import tir.constants
from mffit.suspicion import constants
from mffit.suspicion.rule import Rule, When
from mffit.suspicion.rules import RULES

HEAD = """# Suspicions

The rules that find mistakes in readings, in the order in which they are applied, from the records in
`mffit/suspicion/rules.py`.
[Broken data](broken-data.md) describes the method and its success rate.
"""
NAMES = {
    id(value): name
    for module in (mffit.constants, mffit.points.constants, tir.constants, constants)
    for name, value in vars(module).items()
    if name.isupper()
}


def page() -> str:
    """The page in Markdown: a table per occasion."""
    return "\n".join([HEAD, *(_section(when) for when in When)])


def _section(when: When) -> str:
    rows = [_row(rule) for rule in RULES if when is rule.when]
    head = "| rule | looks at | limits | outcome |\n|---|---|---|---|"
    return f"## {str(when).capitalize()}\n{head}\n" + "\n".join(rows) + "\n"


def _row(rule: Rule) -> str:
    cells = (
        f"`{rule.id}`",
        rule.looks_at,
        "<br>".join(_limit(limit) for limit in rule.limits),
        rule.outcome,
    )
    return "| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |"


def _limit(limit: float) -> str:
    unit = getattr(limit, "unit", "-")
    value = f"{limit:.3g}" if unit == "-" else f"{limit:.3g} {unit}"
    return f"{NAMES[id(limit)].lower().replace('_', ' ')} {value}"
