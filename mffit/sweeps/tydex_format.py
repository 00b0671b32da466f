"""Names of sections and columns of a row in TYDEX-Format, release 1.3, for reader and writer.

A row of constants or channels has a name of 10 characters, a description of 30, a unit of 10, then values. A channel has three:
a factor, an offset of the measured and an offset of the physical value; physical = factor (measured + offset 1) + offset 2.
"""

from __future__ import annotations

from typing import Any, NamedTuple

RELEASE = "1.3"
HEADER, COMMENTS, CONSTANTS, END = "HEADER", "COMMENTS", "CONSTANTS", "END"
CHANNEL_SECTION, DATA = "MEASURCHANNELS", "MEASURDATA"
MARK = "**"
"""Prefix of the name of a section."""
REMARK = "!"
"""Prefix of a remark."""
MISSING = "NOTAVAIL"
"""Text for a number that was not measured."""
NAME, DESCRIPTION, UNIT, VALUE = 10, 30, 10, 10
"""Widths of the columns."""


class FixedRow(NamedTuple):
    """A row of constants or channels, split at its fixed columns."""

    name: str
    description: str
    unit: str
    values: str

    @classmethod
    def of(cls, line: str) -> FixedRow:
        """The row in a line with fixed columns."""
        name, rest = line[:NAME], line[NAME:]
        description, rest = rest[:DESCRIPTION], rest[DESCRIPTION:]
        return cls(name.strip(), description.strip(), rest[:UNIT].strip(), rest[UNIT:].strip())


def fixed_row(name: str, description: str, unit: str, *values: Any) -> str:
    """A line of constants or channels in fixed columns; a name or description that is too long is cut."""
    head = f"{name[:NAME]:<{NAME}}{description[:DESCRIPTION]:<{DESCRIPTION}}{unit:<{UNIT}}"
    return (head + " ".join(map(str, values))).rstrip()
