"""Lists of lines of a file, as in ``lines = "39-44, 60"``, and ``[fit] exclude``, which leaves them out with a reason."""

import re
from collections.abc import Collection, Iterable, Sequence
from typing import Annotated

import numpy as np
from pydantic import AfterValidator, BeforeValidator

from mffit.config import quantities as q
from mffit.config.table import Table
from mffit.errors import meant, shortened

LineRange = tuple[int, int]
"""First and last line, both included, counted from 1."""

ITEM = re.compile(r"\s*(\d+)\s*(?:-\s*(\d+)\s*)?", re.ASCII)
DIGITS = 12
"""Longest line number accepted; larger ones do not fit into an array, and Python refuses thousands of digits."""


class LineListError(ValueError):
    """Why a text is not a list of lines, and what to write."""


def line_ranges(text: str) -> tuple[LineRange, ...]:
    """Ranges of a list such as "39-44, 60", sorted; ranges that touch or overlap are joined.

    Raises LineListError if the text is not such a list.
    """
    found = []
    for item in text.split(","):
        match = ITEM.fullmatch(item)
        if match is None:
            raise LineListError(
                f'"{shortened(item)}" is not a line or a range of lines; write "39", "39-44" or "39-44, 60"'
            )
        digits = [number.lstrip("0") for number in (match[1], match[2] or match[1])]
        if max(map(len, digits)) > DIGITS:
            raise LineListError(f'"{shortened(item)}" is beyond the end of any file; correct it')
        first, last = (int(number or 0) for number in digits)
        if first < 1:
            raise LineListError(f'"{shortened(item)}" begins with line 0, but lines are counted from 1')
        if last < first:
            raise LineListError(f'"{shortened(item)}" ends before it begins; write "{last}-{first}"')
        found.append((first, last))
    return _joined(sorted(found))


def line_text(lines: Sequence[int] | np.ndarray) -> str:
    """A list such as "39-44, 60" of line numbers in any order."""
    known = np.unique(np.asarray(lines, dtype=int))
    if not len(known):
        return ""
    begins = np.r_[0, np.flatnonzero(np.diff(known) > 1) + 1]
    ends = np.r_[begins[1:] - 1, len(known) - 1]
    return ranges_text(zip(known[begins].tolist(), known[ends].tolist(), strict=True))


def ranges_text(ranges: Iterable[LineRange]) -> str:
    """The list that :func:`line_ranges` reads back."""
    return ", ".join(str(first) if first == last else f"{first}-{last}" for first, last in ranges)


def _joined(ranges: Sequence[LineRange]) -> tuple[LineRange, ...]:
    out: list[LineRange] = []
    for first, last in ranges:
        if out and first <= out[-1][1] + 1:
            out[-1] = (out[-1][0], max(last, out[-1][1]))
        else:
            out.append((first, last))
    return tuple(out)


def _checked_lines(text: str) -> str:
    try:
        line_ranges(text)
    except LineListError as error:
        raise q.wrong(str(error)) from None
    return text


def _reason(text: str) -> str:
    if not text.strip():
        raise q.wrong(
            "is empty; write why these readings are left out, because the report lists them with this reason"
        )
    return " ".join(text.split())


def _as_text(given: object) -> object:
    """A single line as the list of it."""
    return str(given) if isinstance(given, int) and not isinstance(given, bool) else given


class ExcludeTable(Table):
    """One entry of ``[fit] exclude``."""

    file: str  #: as in [[sweep]]
    lines: Annotated[str, BeforeValidator(_as_text), AfterValidator(_checked_lines)]
    """For example "39-44, 60"; counted from 1."""
    why: Annotated[str, AfterValidator(_reason)]

    @property
    def ranges(self) -> tuple[LineRange, ...]:
        """First and last line of every range, sorted."""
        return line_ranges(self.lines)


def check_exclusions(entries: Sequence[ExcludeTable], files: Collection[str]) -> None:
    """Refuse entries about a file that is not among the sweeps."""
    for index, entry in enumerate(entries):
        if entry.file not in files:
            raise q.wrong(_not_a_sweep(entry.file, files), f"fit.exclude.{index}.file")


def _not_a_sweep(file: str, files: Collection[str]) -> str:
    near = meant(file, files)
    hint = f'did you mean "{near}"?' if near else "write the name as [[sweep]] gives it"
    return f'"{file}" is not the file of a [[sweep]]; {hint}'
