"""The fleet page: plots/*.png and fleet.html."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from mffit.fleet import EPSILON, Fleet
from mffit.fleet.constants import FEWEST_TYRES_FOR_SCATTER
from mffit.quantities import COMPARED, DIRECT
from mffit.report import page
from mffit.report.drawing.records import Sheet
from mffit.report.figures import fleet
from mffit.report.text.fleet import misfit_channels
from mffit.rig_errors import meaning_of, unit_of, words_of

SPIN = ("PECP1", "PECP2", "PKY6", "PKY7", "PDYP1", "PKYP1", "QDTP1", "QCRP1")
"""Coefficients of spin and camber stiffness that the page shows of a population; fleet.json holds all."""


def write_fleet(found: Fleet, folder: Path, *, priors: bool) -> None:
    """Write ``plots/*.png`` and ``fleet.html``.

    Parameters
    ----------
    found : the record
    folder : existing folder to write to
    priors : whether the folder holds ``priors.json``
    """
    estimates = {key: words for key, words in EPSILON.items() if any(found.numbers(key))}
    figures: dict[str, Callable[[], Sheet]] = {}
    if estimates:
        figures["epsilon_gamma"] = partial(fleet.epsilon_of_all, found)
    figures["numbers"] = partial(fleet.numbers_of_all, found)
    page.write(
        "fleet.html.j2",
        folder / "fleet.html",
        figures,
        fleet=found,
        epsilon=DIRECT["epsilon_gamma"],
        estimates=estimates,
        compared=COMPARED,
        channels=misfit_channels(found),
        units=unit_of,
        meanings=meaning_of,
        words=words_of,
        enough=FEWEST_TYRES_FOR_SCATTER,
        spin=SPIN,
        priors=priors,
    )
