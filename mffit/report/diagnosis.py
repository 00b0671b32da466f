"""The diagnosis page: plots/*.png and diagnosis.html, and THE table of its pictures."""

from __future__ import annotations

from pathlib import Path

from mffit.diagnosis import Diagnosis, wording
from mffit.diagnosis.constants import TIED_EVIDENCE
from mffit.quantities import CHANNELS
from mffit.report import page, words
from mffit.report.catalogue import Picture
from mffit.report.figures import gap
from tir.parameters import BY_NAME

DIAGNOSIS: tuple[Picture[Diagnosis], ...] = (
    Picture(
        name="curves",
        title="The worst and the typical sweep: measured and simulated",
        shows="The sweeps with the largest and with the median misfit of the simulation, in units of the noise. Dashed lines are "
        "the simulation as given.",
        draw=gap.curves_before_after,
    ),
    Picture(
        name="evidence",
        title="Gain in log evidence of every candidate effect in each forward step",
        shows="Every effect that these data could show was refitted beside the effects accepted before. An effect is named if "
        "its bar passes the dashed line, which allows for the number of effects tried. The number at a bar is its distance to "
        f"the best in log evidence: within {TIED_EVIDENCE:g} the data do not tell them apart. The scale is logarithmic.",
        draw=gap.evidence,
    ),
    Picture(
        name="gap_maps",
        title="Maps of the residuals over sideslip and camber, a row per load and pressure",
        shows="Measured minus simulated in units of each point's noise, all on one scale. Frames mark the regions of the list "
        "below. Noise alone is pale and without order. A small dot marks a point that was run backwards. Maps of the driven "
        "and braked wheel are over slip and sideslip.",
        draw=gap.residuals_before_after,
    ),
)
"""Every picture of the page."""


def write_diagnosis(diagnosis: Diagnosis, folder: Path) -> None:
    """Write ``plots/*.png`` and ``diagnosis.html`` of a diagnosis to an existing folder."""
    page.write(
        "diagnosis.html.j2",
        folder / "diagnosis.html",
        DIAGNOSIS,
        diagnosis,
        d=diagnosis,
        measured=[channel.name for channel in gap.gap_channels(diagnosis)],
        say=wording,
        channels=CHANNELS,
        coefficients=BY_NAME,
        of_number=words.of_number,
        in_unit=words.in_unit,
    )
