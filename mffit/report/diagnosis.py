"""The diagnosis page: plots/*.png and diagnosis.html."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from mffit.diagnosis import Diagnosis, wording
from mffit.diagnosis.constants import TIED_EVIDENCE
from mffit.quantities import CHANNELS
from mffit.report import page
from mffit.report.diagnosis_view import shown_steps, view_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def write_diagnosis(diagnosis: Diagnosis, folder: Path) -> None:
    """Write ``plots/*.png`` and ``diagnosis.html`` of a diagnosis.

    Parameters
    ----------
    diagnosis : the record
    folder : existing folder to write to
    """
    from mffit.report.figures import gap

    view = view_of(diagnosis)
    figures: dict[str, Callable[[], Figure]] = {"gap": partial(gap.gap_bars, view)}
    if view.shown:
        figures["curves"] = partial(gap.curves_before_after, view)
    if shown_steps(view):
        figures["evidence"] = partial(gap.evidence, view)
    if view.channels:
        figures["gap_maps"] = partial(gap.residuals_before_after, view)
    page.render(
        "diagnosis.html.j2",
        folder / "diagnosis.html",
        view=view,
        d=diagnosis,
        say=wording,
        tie=TIED_EVIDENCE,
        channels=CHANNELS,
        pictures=page.draw(folder, figures),
    )
