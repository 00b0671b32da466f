"""Remarks on the result of a fit: where its bands hold, and which coefficients only zeros have changed."""

from __future__ import annotations

from dataclasses import replace

from mffit.config import Config
from mffit.fit.bands import band_of_combined, band_of_other_side, bands_by_pressure
from mffit.fit.coverage import why_held
from mffit.fit.result import FitResult
from mffit.fit.rig.zeros import TurningZeros
from mffit.fit.wording import (
    bands_sentence,
    combined_sentence,
    other_side_sentence,
    zeros_of_rig_sentence,
    zeros_sentence,
)
from mffit.points import Points
from mffit.quantities import SIDEWAYS
from mffit.rig import Simulation
from mffit.rig_errors import ZEROS


def with_remarks(
    found: FitResult, config: Config, points: Points, zeros: TurningZeros | None, *, from_base: bool
) -> FitResult:
    """The result with what its bands and zeros without a measured eps_gamma have to say."""
    fitted, values = found.search, found.tyre.values
    assert fitted is not None
    tyre = Simulation(values, turn_slip=config.rig.on_disc)
    sideways = (error.name for error in ZEROS if error.shows_in(SIDEWAYS))
    zeros_of_rig = {name: fitted.rig[name] for name in sideways if name in fitted.rig}
    bands = bands_by_pressure(fitted.posterior, fitted.held, tyre, points, zeros_of_rig)
    why = why_held(bands.unseen, points, config.tyre.side) or "these sweeps do not determine it"
    note = bands_sentence(bands, fitted.held, values, why)
    moved = zeros_sentence(zeros, fitted, from_base=from_base) if zeros else ""
    warned = zeros is not None and zeros.contradicted and from_base
    combined = band_of_combined(fitted.posterior, tyre, points)
    between = combined_sentence(combined) if combined is not None else ""
    opposite = band_of_other_side(fitted.posterior, tyre, points)
    other = other_side_sentence(opposite) if opposite is not None else ""
    of_rig = zeros_of_rig_sentence(zeros_of_rig, bands) if zeros_of_rig and not config.rig.on_disc else ""
    remarks = [note, between, other, "" if warned else moved, of_rig]
    return replace(
        found,
        bands=bands,
        band_of_combined=combined,
        bands_note=note,
        explanations=(*found.explanations, *(f"{text[0].upper()}{text[1:]}." for text in remarks if text)),
        warnings=(*([moved] if warned else []), *found.warnings),
    )
