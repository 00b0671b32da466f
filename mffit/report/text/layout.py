"""Tables and paragraphs in ASCII."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

from mffit.report.rounding import ascii_only

WIDTH = 100


def table(head: Sequence[str], rows: Sequence[Sequence[str]], *, left: int = 1) -> str:
    """Columns under their headings; the first ``left`` columns flush left, the others flush right."""
    cells = [[ascii_only(cell) for cell in row] for row in (head, *rows)]
    widths = [max(len(row[i]) for row in cells) for i in range(len(head))]
    lines = [
        "  ".join(
            c.ljust(w) if i < left else c.rjust(w) for i, (c, w) in enumerate(zip(row, widths, strict=True))
        )
        for row in cells
    ]
    lines.insert(1, "  ".join("-" * w for w in widths))
    return "\n".join(line.rstrip() for line in lines)


def blocks(parts: Sequence[str]) -> str:
    """Parts with a blank line between them, empty ones left out."""
    return ascii_only("\n\n".join(part for part in parts if part))


def paragraphs(sentences: Sequence[str]) -> str:
    """Sentences as a list, wrapped."""
    return "\n".join(textwrap.fill(s, WIDTH, initial_indent="- ", subsequent_indent="  ") for s in sentences)
