"""A comparison, for the terminal."""

from mffit.comparison import Comparison, Difference, wording
from mffit.quantities import CHANNELS
from mffit.report.text.layout import blocks, lines_left, paragraphs, tables_within, wrapped
from mffit.rounding import number, with_u


def comparison_table(found: Comparison) -> str:
    """What ``mffit compare`` prints on one screen: the main sentence, the largest differences of each, the worst sweeps."""
    worst = {row.key: row for row in reversed(found.unequal)}  # of each number, the first of its loads
    numbers = [row for row in found.unequal if row is worst[row.key]]
    of_files = found.first, found.second, "difference", *(["in u"] if found.judged else [])
    sweeps: list[tuple[str, ...]] = [
        (
            gap.sweep,
            gap.channel,
            f"{number(gap.rms, digits=3)} {CHANNELS[gap.channel].unit}",
            f"{number(gap.bias, digits=3)} {CHANNELS[gap.channel].unit}",
            number(gap.over_noise, digits=3) if gap.over_noise else "–",
        )
        for gap in found.sweeps
    ]
    mean = f"mean, {found.second} less {found.first}"
    tables: list[tuple[tuple[str, ...], list[tuple[str, ...]], int]] = [
        (("number", "load", *of_files), [_number(found, row) for row in numbers], 2),
        (("coefficient", *of_files), [(row.key, *_values(found, row)) for row in found.coefficients], 1),
        (("sweep", "channel", "rms", mean, "rms over noise"), sweeps, 2),
    ]
    shown = [(head, *rows) for head, rows, _ in tables if rows]
    headline, notes = wrapped(wording.headline(found)), paragraphs(found.notes)
    room = lines_left(headline, notes) - 1
    return blocks([headline, *tables_within(room, shown, [left for _, rows, left in tables if rows]), notes])


def _number(found: Comparison, row: Difference) -> tuple[str, ...]:
    known = wording.quantity(found, row)
    return (known.column(known.word), wording.place(row), *_values(found, row))


def _values(found: Comparison, row: Difference) -> tuple[str, ...]:
    apart = with_u(row.change, row.u) if row.u else number(row.change, digits=3)
    in_u = number(row.z, 1) if row.z is not None else "–"
    return (*wording.sides(row), apart, *([in_u] if found.judged else []))
