"""The diagnosis page: plots/*.png and diagnosis.html."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from mffit.diagnosis import Diagnosis, wording
from mffit.diagnosis.constants import TIED_EVIDENCE
from mffit.quantities import CHANNELS
from mffit.report import page
from mffit.report.diagnosis_view import DiagnosisView, shown_steps, view_of
from mffit.report.drawing.records import Sheet
from mffit.report.figures import gap


def write_diagnosis(diagnosis: Diagnosis, folder: Path) -> None:
    """Write ``plots/*.png`` and ``diagnosis.html`` of a diagnosis to an existing folder."""
    view = view_of(diagnosis)
    page.write(
        "diagnosis.html.j2",
        folder / "diagnosis.html",
        _figures(view),
        view=view,
        d=diagnosis,
        say=wording,
        tie=TIED_EVIDENCE,
        channels=CHANNELS,
    )


def _figures(view: DiagnosisView) -> dict[str, Callable[[], Sheet]]:
    out: dict[str, Callable[[], Sheet]] = {"gap": partial(gap.gap_bars, view)}
    if view.shown:
        out["curves"] = partial(gap.curves_before_after, view)
    if shown_steps(view):
        out["evidence"] = partial(gap.evidence, view)
    if view.channels:
        out["gap_maps"] = partial(gap.residuals_before_after, view)
    return out
