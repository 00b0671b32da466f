"""The diagnosis page: plots/*.png and diagnosis.html."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import mffit
from mffit.report import page
from mffit.report.diagnosis_view import DiagnosisView, view_of


def write_diagnosis(diagnosis: Any, folder: Path) -> None:
    """Write ``plots/*.png`` and ``diagnosis.html`` of a diagnosis.

    Parameters
    ----------
    diagnosis : ``mffit.diagnose.Diagnosis``
    folder : existing folder to write to
    """
    write_view(view_of(diagnosis), folder)


def write_view(view: DiagnosisView, folder: Path) -> None:
    """The page of a view; :func:`write_diagnosis` makes the view first."""
    from mffit.report.figures import gap

    figures = {"gap": partial(gap.gap_bars, view)}
    if view.channels:
        frames = [*view.where, *view.unexplained_where]
        figures["gap_maps"] = partial(gap.residuals_before_after, view, frames)
    pictures = page.draw(folder, figures)
    page.render(
        "diagnosis.html.j2",
        folder / "diagnosis.html",
        view=view,
        pictures=pictures,
        version=mffit.__version__,
    )
