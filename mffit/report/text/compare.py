"""A comparison, for the terminal."""

from __future__ import annotations

from mffit.comparison import Comparison, Difference, wording
from mffit.quantities import CHANNELS
from mffit.report import constants
from mffit.report.text.layout import blocks, paragraphs, table, wrapped
from mffit.rounding import number, with_u


def comparison_table(found: Comparison) -> str:
    """The text that ``mffit compare`` prints: the main sentence, the largest differences, the worst sweeps."""
    parts = [wrapped(wording.headline(found))]
    if found.numbers:
        head = ("number", "load", found.first, found.second, "difference", "in u")
        parts.append(table(head, [_number(row) for row in found.numbers[: constants.MOST_ROWS]], left=2))
    if found.coefficients:
        of_coefficients = ("coefficient", found.first, found.second, "difference", "in u")
        parts.append(
            table(
                of_coefficients,
                [_coefficient(row) for row in found.coefficients[: constants.MOST_ROWS]],
            )
        )
    if found.sweeps:
        rows = [
            (
                gap.sweep,
                gap.channel,
                f"{number(gap.rms, digits=3)} {CHANNELS[gap.channel].unit}",
                f"{number(gap.bias, digits=3)} {CHANNELS[gap.channel].unit}",
                number(gap.over_noise, digits=3) if gap.over_noise else "–",
            )
            for gap in found.sweeps[: constants.MOST_ROWS]
        ]
        mean = f"mean, {found.second} less {found.first}"
        parts.append(table(("sweep", "channel", "rms", mean, "rms over noise"), rows, left=2))
    parts.append(paragraphs(found.notes))
    return blocks(parts)


def _number(row: Difference) -> tuple[str, ...]:
    known = wording.quantity(row)
    return (known.column(known.word), wording.place(row), *_values(row))


def _coefficient(row: Difference) -> tuple[str, ...]:
    return (row.key, *_values(row))


def _values(row: Difference) -> tuple[str, ...]:
    apart = with_u(row.change, row.u) if row.u else number(row.change, digits=3)
    return (
        with_u(row.first, row.u_first),
        with_u(row.second, row.u_second),
        apart,
        number(row.z, 1) if row.z is not None else "–",
    )
