"""Tables and paragraphs in ASCII."""

import re
import shutil
import sys
import textwrap
from collections.abc import Iterable, Sequence

from mffit.constants import TERMINAL_LINES, TERMINAL_WIDTH
from mffit.rounding import ascii_only

BLANK = re.compile(r"\n\s*\n")
"""What parts of a text have between them."""
COMMAND, LABEL = re.compile(r"\s+mffit "), re.compile(r" *(?:\S.*? {2,})?")


def table(head: Sequence[str], rows: Sequence[Sequence[str]], *, left: int = 1) -> str:
    """Columns below their headings; the first ``left`` columns are flush left, the others flush right.

    Columns beyond the width of the terminal follow below, beside the first again.
    """
    cells = [[ascii_only(cell) for cell in row] for row in (head, *rows)]
    widths = [max(len(row[i]) for row in cells) for i in range(len(head))]
    parts, used = [list(range(left))], sum(widths[:left]) + 2 * (left - 1)
    for i in range(left, len(head)):
        if used + 2 + widths[i] > _room() and parts[-1][left:]:
            parts.append([0])
            used = widths[0]
        parts[-1].append(i)
        used += 2 + widths[i]
    return "\n\n".join(_columns_of(cells, widths, part, left) for part in parts)


def _columns_of(cells: Sequence[Sequence[str]], widths: Sequence[int], part: Sequence[int], left: int) -> str:
    """Some columns of a table with its headings."""
    lines = [
        "  ".join(row[i].ljust(widths[i]) if i < left else row[i].rjust(widths[i]) for i in part)
        for row in cells
    ]
    lines.insert(1, "  ".join("-" * widths[i] for i in part))
    return "\n".join(line.rstrip() for line in lines)


def _room() -> int:
    """Characters that a line has: those of the terminal, any number where the text goes to a file or a program."""
    return shutil.get_terminal_size((sys.maxsize, 1)).columns


def columns(text: str, left: int = 1) -> str:
    """Lines of cells between ``¦`` as a table, the first its headings; empty without rows."""
    head, *rows = ([cell.strip() for cell in line.split("¦")] for line in text.split("\n") if line.strip())
    n = len(head)  # a name may have the mark, too
    rows = [[*row, *[""] * n][:n] for row in rows]
    return f"{table(head, rows, left=left)}\n" if rows else ""


def blocks(parts: Iterable[str]) -> str:
    """The parts that are not empty, with a blank line between them, within the terminal's width; a command is never broken."""
    text = ascii_only("\n\n".join(part for part in parts if part))
    return "\n".join(line if COMMAND.match(line) else _within(line) for line in text.split("\n"))


def _within(line: str) -> str:
    """A line, continued below its text if it is too long; the text is behind a label or an indent."""
    return wrapped(line, others=" " * LABEL.match(line).end()) if len(line) > _room() else line  # type: ignore[union-attr]


def lines_left(*parts: str) -> int:
    """Lines of a screen that parts leave, with a blank one after each and one for what is written."""
    return TERMINAL_LINES - 1 - sum(part.count("\n") + 2 for part in parts if part)


def tables_within(lines: int, tables: Sequence[Sequence[Sequence[str]]], left: Sequence[int]) -> list[str]:
    """Tables, each of its head and its rows, cut to an even share of so many lines, with what is left out said below them."""
    texts, cut_off = [], 0
    for k, (head, *rows) in enumerate(tables):
        room = max(lines // (len(tables) - k) - 3, 1)  # head, rule and blank line
        texts.append(table(head, rows[:room], left=left[k]))
        lines -= 3 + min(room, len(rows))
        cut_off += max(len(rows) - room, 0)
    return (
        texts
        if not cut_off
        else [*texts[:-1], f"{texts[-1]}\n... and {cut_off} rows more in page and JSON (--out DIR)"]
    )


def paragraphs(sentences: Sequence[str]) -> str:
    """Sentences as a list, each wrapped to the terminal's width."""
    return "\n".join(wrapped(sentence, "- ", "  ") for sentence in sentences)


def wrapped(sentence: str, first: str = "", others: str = "") -> str:
    """A sentence in lines of :data:`TERMINAL_WIDTH` or the terminal's; ``first`` and ``others`` are indents."""
    return textwrap.fill(
        sentence, min(int(TERMINAL_WIDTH), _room()), initial_indent=first, subsequent_indent=others
    )


def steps(commands: Sequence[tuple[str, str]]) -> str:
    """Commands to run next, a line each, with what they do as the comment of a shell; a command is never broken."""
    width = max((len(command) for command, _ in commands), default=0)
    lines = [f"  {command:<{width}}  # {what}" for command, what in commands]
    return "\n".join(["Next:", *lines]) if lines else ""
