"""Single outlying readings: they are listed and have zero weight in the fit."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mffit.as_json import keys
from mffit.constants import NAMED_IN_SENTENCE
from mffit.points import Points
from mffit.quantities import CHANNELS
from mffit.suspicion.rule import Outcome, Rule, When


@dataclass(frozen=True, slots=True)
class Outlier:
    """One reading with zero weight."""

    file: str
    line: int  #: counted from 1; 0 if unknown
    sweep: str
    row: int  #: index of the point
    channel: str
    measured: float  #: [N] or [Nm], in ISO-W axes
    expected: float  #: reading of the fitted model, in the same unit and axes
    ratio: float  #: difference of the two in units of the stated uncertainty

    @property
    def place(self) -> str:
        return f"{self.file}:{self.line}" if self.line else self.file


keys(Outlier, "file line? sweep channel measured expected ratio")


def outliers(
    points: Points,
    stated: Mapping[str, np.ndarray],
    weights: Mapping[str, np.ndarray],
    model: Mapping[str, np.ndarray],
) -> tuple[Outlier, ...]:
    """The readings to which the fit gave zero weight, in the order of the points.

    By channel, ``stated`` has the uncertainty (n,), inf where not measured, ``weights`` the one that the last fit used, inf for
    outliers, and ``model`` the readings of the fitted model (n,).
    """
    out = []
    for name, u in stated.items():
        measured, used, expected = points.channel(name), weights[name], model[name]
        for row in np.flatnonzero(np.isfinite(u) & ~np.isfinite(used)):
            out.append(
                Outlier(
                    file=points.files[points.file[row]],
                    line=int(points.line[row]),
                    sweep=points.sweep_names[points.sweep[row]],
                    row=int(row),
                    channel=name,
                    measured=float(measured[row]),
                    expected=float(expected[row]),
                    ratio=float(abs(measured[row] - expected[row]) / u[row]),
                )
            )
    return tuple(sorted(out, key=lambda o: o.row))


def marks(found: Iterable[Outlier], n: int) -> np.ndarray:
    """Outlying channels of every point (n,), such as "", "Fy" or "Fy Mz"."""
    out = np.full(n, "", dtype=object)
    for o in found:
        out[o.row] = f"{out[o.row]} {o.channel}".strip()
    return out


def outliers_sentence(found: Sequence[Outlier]) -> str:
    """The warning about all outliers, the worst by name."""
    worst = sorted(found, key=lambda o: -o.ratio)[:NAMED_IN_SENTENCE]
    named = "; ".join(
        f"{o.place} {o.channel} = {o.measured:.4g} {CHANNELS[o.channel].unit} where {o.expected:.4g} is expected"
        for o in worst
    )
    more = f"; and {len(found) - len(worst)} more, all in result.json" if len(found) > len(worst) else ""
    return OUTLYING.said({"number": len(found), "named": named + more})


OUTLYING = Rule(
    id="outlying-reading",
    when=When.AFTER,
    looks_at="Residual, and its prediction from all other readings, after the fit",
    outcome=Outcome.LEFT_OUT,
    sentence="readings that do not fit their sweep have no weight ({number}): {named}; correct or remove what is wrong",
    find=outliers,
)
