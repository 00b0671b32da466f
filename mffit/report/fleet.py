"""The fleet page: plots/*.png and fleet.html, and THE table of its pictures."""

from __future__ import annotations

from pathlib import Path

from mffit.fleet import EPSILON, Fleet
from mffit.fleet.constants import FEWEST_TYRES_FOR_SCATTER
from mffit.quantities import COMPARED, DIRECT
from mffit.report import page
from mffit.report.catalogue import Picture
from mffit.report.figures import fleet
from mffit.report.text.fleet import misfit_channels
from mffit.rig_errors import meaning_of, unit_of, words_of

SPIN = ("PECP1", "PECP2", "PKY6", "PKY7", "PDYP1", "PKYP1", "QDTP1", "QCRP1")
"""Coefficients of spin and camber stiffness that the page shows of a population; fleet.json holds all."""

NAMED = "Every bar is one standard uncertainty; tyres are named, or numbered as in the table if the names do not fit."
FLEET: tuple[Picture[Fleet], ...] = (
    Picture(
        name="epsilon_gamma",
        title="Camber reduction factor of every tyre by three estimates, with bars of one standard uncertainty",
        shows=f"{NAMED} The direct method uses the forces at zero of each tyre alone, and an error of the rig moves all results "
        "alike. The joint estimate uses all points of a tyre and fits the errors of the rig, too. All tyres together determine "
        "the rig best.",
        draw=fleet.epsilon_of_all,
        when=lambda found: any(any(found.numbers(key)) for key in EPSILON),
    ),
    Picture(
        name="numbers",
        title="Stiffnesses and peaks of every tyre with bars of one standard uncertainty",
        shows=NAMED,
        draw=fleet.numbers_of_all,
    ),
)
"""Every picture of the page."""


def write_fleet(found: Fleet, folder: Path, *, priors: bool) -> None:
    """Write ``plots/*.png`` and ``fleet.html``.

    Parameters
    ----------
    found : the record
    folder : existing folder to write to
    priors : whether the folder holds ``priors.json``
    """
    estimates = {key: words for key, words in EPSILON.items() if any(found.numbers(key))}
    page.write(
        "fleet.html.j2",
        folder / "fleet.html",
        (one for picture in FLEET for one in picture.planned(found)),
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
