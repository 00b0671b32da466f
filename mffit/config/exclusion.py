"""``[fit] exclude``: readings that the engineer leaves out, each with a reason."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Annotated

from pydantic import AfterValidator, BeforeValidator

from mffit.config import quantities as q
from mffit.config.lines import LineListError, LineRange, line_ranges
from mffit.config.table import Table
from mffit.errors import meant


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
    lines: Annotated[
        str, BeforeValidator(_as_text), AfterValidator(_checked_lines)
    ]  #: "39-44, 60", counted from 1
    why: Annotated[str, AfterValidator(_reason)]

    @property
    def ranges(self) -> tuple[LineRange, ...]:
        """First and last line of every range, sorted."""
        return line_ranges(self.lines)


def check_exclusions(entries: Sequence[ExcludeTable], files: Collection[str]) -> None:
    """Refuse entries about a file that is not among the sweeps, and lines that are excluded twice."""
    for index, entry in enumerate(entries):
        if entry.file not in files:
            raise q.wrong(_not_a_sweep(entry.file, files), f"fit.exclude.{index}.file")
        for earlier in entries[:index]:
            twice = _common(earlier.ranges, entry.ranges) if earlier.file == entry.file else None
            if twice is not None:
                raise q.wrong(
                    f'line {twice} of "{entry.file}" is in an earlier entry of exclude too; name it once',
                    f"fit.exclude.{index}.lines",
                )


def _not_a_sweep(file: str, files: Collection[str]) -> str:
    near = meant(file, files)
    hint = f'did you mean "{near}"?' if near else "write the name as [[sweep]] gives it"
    return f'"{file}" is not the file of a [[sweep]]; {hint}'


def _common(first: Sequence[LineRange], second: Sequence[LineRange]) -> int | None:
    """The first line that both have; None without one."""
    found = [max(a, c) for a, b in first for c, d in second if max(a, c) <= min(b, d)]
    return min(found, default=None)
