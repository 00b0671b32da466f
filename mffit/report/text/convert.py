"""A conversion, for the terminal."""

from mffit.conversion import Conversion, wording
from mffit.conversion.result import ROUNDING, RegionMisfit
from mffit.quantities import MODEL
from mffit.report.text.layout import blocks, paragraphs, table, wrapped
from mffit.rounding import number

SHARES = "Shares are of the largest original force of the same load and region."


def conversion_summary(found: Conversion) -> str:
    """The text that ``mffit convert`` prints: what was fitted, and the misfit of every channel and region."""
    head = ("channel", "region", "rms", "rms share", "worst share", "at", "misfit there", "within 2 %")
    rows = [
        (
            row.channel,
            wording.region(row),
            _size(row.rms, row),
            f"{row.rms_share:.1%}",
            f"{row.share:.1%}",
            f"{row.load:.0f} N",
            _size(row.largest, row),
            f"{row.within:.1%}",
        )
        for row in found.misfit
    ]
    return blocks(
        [
            wrapped(wording.headline(found)),
            table(head, rows, left=2) + f"\n{SHARES}" * bool(rows),
            paragraphs(wording.reasons(found)),
        ]
    )


def _size(x: float, row: RegionMisfit) -> str:
    """A misfit with its unit; 0 if it is rounding."""
    rounded = 0.0 if x < ROUNDING * row.greatest_force else x
    return f"{number(rounded, digits=2)} {MODEL[row.channel].unit}"
