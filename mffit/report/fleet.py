"""The fleet page: plots/*.png and fleet.html, and THE table of its pictures."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mffit.constants import FEWEST
from mffit.fleet import EPSILON, Fleet
from mffit.quantities import COMPARED, DIRECT
from mffit.report import labels, page, style
from mffit.report.drawing.records import Look, Panel, Sheet, Trace, in_rows, listed
from mffit.report.text.many import misfit_channels
from tir.errors import listed as words_listed

if TYPE_CHECKING:
    from tir import Quantity

LOOKS = {
    "file": Look(colour=style.CONTRAST, marker="^", size=4.0, width=1.2),
    "direct": Look(colour=style.FAINT, marker="s", size=4.0, width=1.2),
    "alone": Look(colour=style.CALM, marker="D", size=4.0, width=1.2),
    "together": Look(colour=style.ACCENT, marker="o", size=4.0, width=1.2),
}
STATED = Look(colour=style.INK, marker="o", size=4.0, width=1.2)
"""Of a number of which there is one estimate."""
COLUMNS = 3
LINE = 0.28
"""Height for each tyre in a panel [in]."""
APART = 0.22
"""Distance between the estimates of one tyre, as a share of the distance between two tyres."""


def numbers_of_all(found: Fleet) -> Sheet:
    """Every number of every tyre, a panel each and a line for each tyre; every bar is one standard uncertainty."""
    estimates, names = found.estimates, listed([row.specimen.name for row in found.rows])
    many = len(estimates) - 1
    panels = [
        Panel(
            title=quantity.column(f"{quantity.word} {quantity.mathtext}"),
            y=names,
            series=[_bars(found.numbers(key), 0.0, STATED, quantity.word)],
        )
        for key, quantity in COMPARED.items()
        if any(found.numbers(key))
    ]
    if estimates:
        series = [
            _bars(found.numbers(key), APART * (k - 0.5 * many), LOOKS[key], words)
            for k, (key, words) in enumerate(estimates.items())
        ]
        panels.insert(0, Panel(title=labels.EPSILON.axis, y=names, series=series))
    key = {words: LOOKS[key] for key, words in estimates.items()}
    return Sheet(rows=in_rows(panels, columns=COLUMNS), height=LINE * len(found.rows) + 0.3, key=key)


def _bars(numbers: Sequence[Quantity | None], shift: float, look: Look, name: str) -> Trace:
    known = [(k + shift, q.value, q.u) for k, q in enumerate(numbers) if q is not None]
    y, x, u = np.array(known, dtype=float).reshape(-1, 3).T
    return Trace(name=name, x=x, y=y, half_x=u, look=look)


SPIN = ("PECP1", "PECP2", "PKY6", "PKY7", "PDYP1", "PKYP1", "QDTP1", "QCRP1")
"""Coefficients of spin and camber stiffness that the page shows of a population; fleet.json holds all."""

FLEET: Mapping[str, Callable[[Fleet], Sheet]] = {"numbers": numbers_of_all}
"""The picture of the page."""


def headline(found: Fleet) -> str:
    """A sentence: in which numbers the tyres differ, and in which they agree within their uncertainty."""
    best = [key for key in EPSILON if found.scatter(key) is not None][-1:]  # the best is the last
    words = dict.fromkeys(best, DIRECT["epsilon_gamma"].word) | {key: q.word for key, q in COMPARED.items()}
    scatters = {word: s for key, word in words.items() if (s := found.scatter(key)) is not None}
    apart = [word for word, s in scatters.items() if s.differ]
    alike = [word for word in scatters if word not in apart]
    kinds = len(set(found.kinds))
    unlike = f"Tyres of {kinds} kinds (size, nominal load or pressure) are compared within a kind: they"
    who = "The tyres" if kinds == 1 else unlike
    parts = [
        f"{who} differ by more than their uncertainty in {words_listed(apart)}" if apart else "",
        f"{'they' if apart else who} agree within their uncertainty in {words_listed(alike)}"
        if alike
        else "",
    ]
    if scatters:
        return "; ".join(filter(None, parts)) + "."
    if kinds > 1:
        return "No two tyres are of one kind (size, nominal load and pressure), so their numbers are listed and not compared."
    return "No number is known of two tyres."


def write_fleet(found: Fleet, folder: Path, *, priors: bool) -> None:
    """Write ``plots/*.png`` and ``fleet.html`` to an existing folder; ``priors``: whether it holds ``priors.json``."""
    page.write(
        "fleet.html.j2",
        folder / "fleet.html",
        FLEET,
        found,
        headline=headline(found),
        misfits=misfit_channels(found),
        enough=FEWEST,
        spin=SPIN,
        priors=priors,
    )
