"""The build report: plots/*.png and report.html, and THE table of its pictures."""

import math
from collections.abc import Callable, Mapping
from itertools import groupby
from pathlib import Path

from mffit.diagnosis import wording as of_residuals
from mffit.measured import wording
from mffit.prediction import road_sentences
from mffit.report import page
from mffit.report.build_view import BuildView, CoefficientRow, sweep_rows, view_of
from mffit.report.drawing.records import Sheet
from mffit.report.figures import bands, decomposition, fit, missed, radii, residuals, road, slip, spin
from mffit.report.text.direct import PER_LOAD
from mffit.report.verdict import headlines, judgement, purposes, verdict
from mffit.results import BuildResult
from mffit.suspicion import unpublished

OTHERS = "EVERYTHING_ELSE"
"""The section of dimensions, ranges and nominal conditions."""

BUILD: Mapping[str, Callable[[BuildView], Sheet]] = {
    "road": road.road,
    "overview": fit.overview,
    "files": bands.files_on_a_straight_path,
    "camber_reduction": spin.camber_reduction,
    "alignment": spin.alignment,
    "parts": decomposition.parts,
    **fit.OF_CHANNELS,
    "friction_ellipse": slip.friction_ellipse,
    "radii": radii.radii,
    "bands": bands.bands,
    "residuals": residuals.residual_maps,
    "missed": missed.missed,
}
"""Every picture of the report."""


def write_build(result: BuildResult, folder: Path) -> None:
    """Write ``plots/*.png`` and ``report.html`` of a build to an existing folder."""
    view = view_of(result)
    because = result.reasons or result.trust.doubts
    page.write(
        "build.html.j2",
        folder / "report.html",
        BUILD,
        view,
        verdict=verdict(result),
        judgement=judgement(result),
        because=because,
        warnings=[said for said in result.warnings if not said.endswith(tuple(because))],
        on_road=road_sentences(result.road, view.normal_file) if result.road is not None else [],
        sweeps=sweep_rows(view.points),
        headlines=headlines(result),
        purposes=purposes(result),
        sections=groupby(sorted(view.rows, key=lambda row: _section(row) == OTHERS), key=_section),
        of_spin=wording,
        of_residuals=of_residuals,
        per_load=PER_LOAD,
        degrees=math.degrees(1.0),
        published=unpublished.SOURCE,
    )


def _section(row: CoefficientRow) -> str:
    """The section of the table in which a coefficient is."""
    section = row.known.section
    return section if section.endswith("_COEFFICIENTS") else OTHERS
