"""The diagnosis page: plots/*.png and diagnosis.html, and THE table of its pictures."""

from __future__ import annotations

from pathlib import Path

from mffit.diagnosis import Diagnosis, wording
from mffit.diagnosis.constants import TIED_EVIDENCE
from mffit.diagnosis.rest import Answer
from mffit.quantities import CHANNELS
from mffit.report import page, words
from mffit.report.catalogue import Picture
from mffit.report.figures import gap
from tir.parameters import BY_NAME

DIAGNOSIS: tuple[Picture[Diagnosis], ...] = (
    Picture(
        name="gap_by_effect",
        title="The rms misfit as given and with one effect after the other",
        shows="Each bar adds one correction to those above it; the number is its length. Diamonds are left-out sweeps, predicted "
        "by a fit without them. The dashed line is the noise of the readings. The scale is logarithmic.",
        draw=gap.gap_by_effect,
    ),
    Picture(
        name="curves",
        title="The worst and the typical sweep: measured and simulated",
        shows="The sweeps with the largest and with the median misfit of the simulation, in units of the noise. Dashed lines are "
        "the simulation as given.",
        draw=gap.curves_before_after,
    ),
    Picture(
        name="evidence",
        title="Gain in log evidence of every candidate effect in the place of each accepted one",
        shows="Every effect that these data could show was tried in the place of each accepted one, in addition to the others. "
        "An effect is named if its bar passes the dashed line, which allows for the number of effects tried. The number at a bar "
        f"is its distance to the best in log evidence: within {TIED_EVIDENCE:g} the data cannot separate them. The scale is "
        "logarithmic.",
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


FIRST = {
    Answer.NOTHING: "curves",
    Answer.FOUND: "gap_by_effect",
    Answer.UNDECIDED: "evidence",
    Answer.UNKNOWN: "gap_maps",
}
"""By answer, the picture that the page shows first."""


def write_diagnosis(diagnosis: Diagnosis, folder: Path) -> None:
    """Write ``plots/*.png`` and ``diagnosis.html`` of a diagnosis to an existing folder."""
    page.write(
        "diagnosis.html.j2",
        folder / "diagnosis.html",
        DIAGNOSIS,
        diagnosis,
        d=diagnosis,
        first=FIRST[diagnosis.answer],
        measured=[channel.name for channel in gap.gap_channels(diagnosis)],
        say=wording,
        channels=CHANNELS,
        coefficients=BY_NAME,
        of_number=words.of_number,
        in_unit=words.in_unit,
    )
