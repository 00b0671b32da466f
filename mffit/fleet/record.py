"""The record of a fleet: the numbers of every specimen, and the joint estimate of each rig's tyres."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.special import gammaincc

from mffit.as_json import keys
from mffit.constants import PREDICTION_FALSE_ALARM
from mffit.fleet.hierarchy import Hierarchy
from mffit.fleet.specimen import Specimen
from mffit.scatter import rms
from tir import Quantity

EPSILON = {
    "file": "as its file carries it",
    "direct": "direct method",
    "alone": "joint estimate of its own build",
    "together": "joint estimate of all tyres",
}
"""The estimates of eps_gamma in words."""


@dataclass(frozen=True, slots=True)
class Row:
    """One specimen with the estimates of eps_gamma, each None if not measured."""

    specimen: Specimen
    rig: int  #: index of its rig in the fleet
    numbers: Mapping[str, Quantity]  #: stiffnesses and peaks of the fitted model
    alone: Quantity | None = None  #: eps_gamma, joint estimate of its own build
    together: Quantity | None = None  #: eps_gamma, joint estimate of all tyres of its rig
    strain: Mapping[str, float] = field(default_factory=dict)

    @property
    def direct(self) -> Quantity | None:
        """eps_gamma by the direct method."""
        return self.specimen.epsilon_direct

    @property
    def file(self) -> Quantity | None:
        """eps_gamma as the property file carries it."""
        return self.specimen.epsilon_gamma


keys(
    Row,
    "name=specimen.name folder=specimen.folder rig epsilon_gamma **numbers rmse=specimen.misfit strain "
    "warnings=specimen.warnings",
    rig=lambda row: row.rig + 1,
    epsilon_gamma=lambda row: {key: getattr(row, key) for key in EPSILON},
)


@dataclass(frozen=True, slots=True)
class FleetScatter:
    """Scatter of one number between tyres, and the typical uncertainty."""

    mean: float | None  #: None of unlike kinds of tyres
    sd: float  #: between the tyres of one kind
    u: float  #: rms of the stated standard uncertainties
    tyres: int
    chance: float  #: probability that tyres which are equal scatter so much

    @property
    def differ(self) -> bool:
        """Whether the tyres differ, rather than scatter by chance."""
        return self.chance < PREDICTION_FALSE_ALARM

    @property
    def beyond(self) -> float:
        """Scatter in excess of the uncertainties."""
        return math.sqrt(max(self.sd**2 - self.u**2, 0.0))


keys(FleetScatter, "* differ beyond")


@dataclass(frozen=True, slots=True)
class Fleet:
    """All specimens, rig by rig."""

    rows: tuple[Row, ...]
    rigs: tuple[Hierarchy | None, ...]  #: None if no build of the rig has free numbers
    notes: tuple[str, ...]

    @property
    def kinds(self) -> list[int]:
        """The kind of each tyre, counted from 0: those of one nominal load and pressure, and of one size if all state one."""
        return kinds_of([row.specimen for row in self.rows])

    @property
    def estimates(self) -> dict[str, str]:
        """The known estimates of eps_gamma, in words; without the direct method's where all files carry it."""
        known = {key: words for key, words in EPSILON.items() if any(self.numbers(key))}
        if self.numbers("direct") == self.numbers("file"):
            known.pop("direct", None)
        return known

    def numbers(self, key: str) -> list[Quantity | None]:
        """One number of every specimen; those of :data:`EPSILON` are eps_gamma."""
        if key in EPSILON:
            return [getattr(row, key) for row in self.rows]
        return [row.numbers.get(key) for row in self.rows]

    @property
    def scattered(self) -> bool:
        """Whether two tyres of one kind have any number."""
        return bool(_scatters(self))

    def scatter(self, key: str) -> FleetScatter | None:
        """Scatter of one number between tyres of one kind; None if no two that have it are of one."""
        kinds: dict[int, list[Quantity]] = {}
        for kind, q in zip(self.kinds, self.numbers(key), strict=True):
            if q is not None:
                kinds.setdefault(kind, []).append(q)
        several = [found for found in kinds.values() if len(found) > 1]
        return scatter_of(*several) if several else None


keys(Fleet, "tyres=rows scatter rigs notes", scatter=lambda found: _scatters(found))


def kinds_of(specimens: Sequence[Specimen]) -> list[int]:
    """The kind of each tyre, see :attr:`Fleet.kinds`."""
    sized = all(one.size for one in specimens)
    kinds = [(*one.conditions, one.size if sized else "") for one in specimens]
    return [list(dict.fromkeys(kinds)).index(kind) for kind in kinds]


def scatter_of(*kinds: Sequence[Quantity]) -> FleetScatter:
    """Mean, scatter and typical uncertainty of at least two numbers of tyres of one kind; of several kinds, within them."""
    n, squares, chi2 = 0, 0.0, 0.0
    for found in kinds:
        values, u = np.array([q.value for q in found]), np.array([q.u for q in found])
        rounding = 1e-12 * np.abs(values) + 1e-300
        weight = 1.0 / np.maximum(u, rounding) ** 2
        apart, off = values - np.average(values, weights=weight), values - values.mean()
        n += len(found)
        squares += float(np.sum(off[np.abs(off) > rounding] ** 2))
        chi2 += float(np.sum(weight * apart**2))
    free, every = n - len(kinds), [q for found in kinds for q in found]
    return FleetScatter(
        mean=float(np.mean([q.value for q in every])) if len(kinds) == 1 else None,
        sd=math.sqrt(squares / free),
        u=rms(np.array([q.u for q in every])),
        tyres=n,
        chance=float(gammaincc(0.5 * free, 0.5 * chi2)),
    )


def _scatters(found: Fleet) -> dict[str, object]:
    """JSON of the scatter of every number that at least two tyres have."""
    names = {key: f"epsilon_gamma_{key}" for key in EPSILON} | {key: key for key in found.rows[0].numbers}
    return {name: scatter for key, name in names.items() if (scatter := found.scatter(key)) is not None}
