"""The fleet page: plots/*.png and fleet.html, and THE table of its pictures."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mffit.fleet import EPSILON, Fleet
from mffit.fleet.constants import FEWEST_TYRES_FOR_SCATTER
from mffit.quantities import COMPARED, DIRECT
from mffit.report import constants, labels, page, style
from mffit.report.drawing.records import NOTHING, Axis, Look, Panel, Sheet, Trace, in_rows
from mffit.report.text.many import misfit_channels
from tir.errors import listed

if TYPE_CHECKING:
    from tir import Quantity

LOOKS = {
    "file": Look(colour=style.CONTRAST, marker="^", size=4.0, width=1.2),
    "direct": Look(colour=style.FAINT, marker="s", size=4.0, width=1.2),
    "alone": Look(colour=style.CALM, marker="D", size=4.0, width=1.2),
    "together": Look(colour=style.ACCENT, marker="o", size=4.0, width=1.2),
}
COLUMNS = 3
APART = 0.22
"""Distance between the estimates of one tyre, as a share of the distance between two tyres."""


def epsilon_of_all(found: Fleet) -> Sheet:
    """Camber reduction factor of every specimen by each estimate; every bar is one standard uncertainty."""
    estimates = found.estimates
    if not estimates:
        return NOTHING
    series = [
        _bars(found.numbers(key), APART * (k - (len(estimates) - 1) / 2.0), LOOKS[key], words)
        for k, (key, words) in enumerate(estimates.items())
    ]
    panel = Panel(x=_names(found), y=Axis(label=labels.EPSILON.axis), series=series)
    return Sheet(rows=[[panel]], height=2.8, key={words: LOOKS[key] for key, words in estimates.items()})


def numbers_of_all(found: Fleet) -> Sheet:
    """Stiffnesses and peaks of every specimen."""
    panels = [
        Panel(
            title=quantity.column(f"{quantity.word} {quantity.mathtext}"),
            x=_names(found, COLUMNS),
            series=[_bars(found.numbers(key), 0.0, LOOKS["together"], quantity.word)],
        )
        for key, quantity in COMPARED.items()
    ]
    return Sheet(rows=in_rows(panels, columns=COLUMNS), height=1.9)


def _bars(numbers: Sequence[Quantity | None], shift: float, look: Look, name: str) -> Trace:
    known = [(k + shift, q.value, q.u) for k, q in enumerate(numbers) if q is not None]
    x, y, u = np.array(known, dtype=float).reshape(-1, 3).T
    return Trace(name=name, x=x, y=y, half=u, look=look)


def _names(found: Fleet, columns: int = 1) -> Axis:
    """The tyres' names if they fit side by side below one of ``columns`` panels, else their numbers in the table."""
    n = len(found.rows)
    names = [row.specimen.name for row in found.rows]
    if n * (2 + max(map(len, names))) * style.LETTER <= style.WIDTH / columns:
        return Axis(low=-0.6, high=n - 0.4, words={float(k): name for k, name in enumerate(names)})
    step = max(1, n // constants.MOST_ROWS)
    return Axis(low=-0.6, high=n - 0.4, words={float(k): str(k + 1) for k in range(0, n, step)})


SPIN = ("PECP1", "PECP2", "PKY6", "PKY7", "PDYP1", "PKYP1", "QDTP1", "QCRP1")
"""Coefficients of spin and camber stiffness that the page shows of a population; fleet.json holds all."""

FLEET: Mapping[str, Callable[[Fleet], Sheet]] = {"epsilon_gamma": epsilon_of_all, "numbers": numbers_of_all}
"""Every picture of the page."""


def headline(found: Fleet) -> str:
    """A sentence: in which numbers the tyres differ, and in which they agree within their uncertainty."""
    best = [key for key in EPSILON if found.scatter(key) is not None][
        -1:
    ]  # listed from the worst to the best
    words = dict.fromkeys(best, DIRECT["epsilon_gamma"].word) | {key: q.word for key, q in COMPARED.items()}
    scatters = {word: s for key, word in words.items() if (s := found.scatter(key)) is not None}
    apart = [word for word, s in scatters.items() if s.beyond > 0.0]
    alike = [word for word in scatters if word not in apart]
    parts = [
        f"The tyres scatter by more than their uncertainty in {listed(apart)}" if apart else "",
        f"{'they' if apart else 'The tyres'} agree within their uncertainty in {listed(alike)}"
        if alike
        else "",
    ]
    return "; ".join(filter(None, parts)) + "." if scatters else "No number is known of two tyres."


def write_fleet(found: Fleet, folder: Path, *, priors: bool) -> None:
    """Write ``plots/*.png`` and ``fleet.html`` to an existing folder; ``priors``: whether it holds ``priors.json``."""
    page.write(
        "fleet.html.j2",
        folder / "fleet.html",
        FLEET,
        found,
        headline=headline(found),
        misfits=misfit_channels(found),
        enough=FEWEST_TYRES_FOR_SCATTER,
        spin=SPIN,
        priors=priors,
    )
