"""The page of all rules of suspicion."""

from __future__ import annotations

from mffit.suspicion.rule import Rule, When
from mffit.suspicion.rules import RULES

HEAD = """# Suspicions

The rules that find mistakes in readings, in the order in which they are applied, from the records in
`mffit/suspicion/rules.py`.
[Broken data](broken-data.md) describes the method and its success rate, [the constants](constants.md) state the limits.
"""


def page() -> str:
    """The page in Markdown: a table per occasion."""
    return "\n".join([HEAD, *(_section(when) for when in When)])


def _section(when: When) -> str:
    rows = [_row(rule) for rule in RULES if when is rule.when]
    head = "| rule | looks at | outcome |\n|---|---|---|"
    return f"## {str(when).capitalize()}\n{head}\n" + "\n".join(rows) + "\n"


def _row(rule: Rule) -> str:
    cells = (f"`{rule.id}`", rule.looks_at, rule.outcome)
    return "| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |"
