"""The diagnosis page: plots/*.png and diagnosis.html, and THE table of its pictures."""

from collections.abc import Callable, Mapping
from pathlib import Path

from mffit.diagnosis import Diagnosis, wording
from mffit.diagnosis.constants import TIED_EVIDENCE
from mffit.report import page
from mffit.report.drawing.records import Sheet
from mffit.report.figures import gap

DIAGNOSIS: Mapping[str, Callable[[Diagnosis], Sheet]] = {
    "gap_by_effect": gap.gap_by_effect,
    "curves": gap.curves_before_after,
    "evidence": gap.evidence,
    "gap_maps": gap.residuals_before_after,
}
"""Every picture of the page."""


def write_diagnosis(diagnosis: Diagnosis, folder: Path) -> None:
    """Write ``plots/*.png`` and ``diagnosis.html`` of a diagnosis to an existing folder."""
    page.write(
        "diagnosis.html.j2",
        folder / "diagnosis.html",
        DIAGNOSIS,
        diagnosis,
        measured=[channel.name for channel in gap.gap_channels(diagnosis)],
        say=wording,
        tied=f"{TIED_EVIDENCE:g}",
    )
