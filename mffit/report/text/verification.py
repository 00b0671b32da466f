"""A verification, for the terminal."""

from __future__ import annotations

from mffit.report import constants
from mffit.report.text.layout import blocks, paragraphs, table, wrapped
from mffit.results.values import Json
from mffit.results.verification import Verification


def verification_summary(found: Verification) -> str:
    """The text that ``mffit build --verify`` prints: another method first, the result, and the largest changes."""
    parts = [paragraphs(found.notes), wrapped(f"{found.folder}: {found.headline}")]
    shown = found.changes[: constants.MOST_ROWS]
    if shown:
        rows = [(row.file, row.key, _written(row.old), _written(row.new)) for row in shown]
        parts.append(table(("file", "number", "stored", "new"), rows, left=2))
    if len(found.changes) > len(shown):
        parts.append(f"and {len(found.changes) - len(shown)} more, all with --json")
    return blocks(parts)


def _written(value: Json) -> str:
    if value is None:
        return "null"
    return f"{value:.10g}" if isinstance(value, float) else str(value).lower()
