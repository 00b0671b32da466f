"""The records of a comparison."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import compress

import numpy as np

from mffit.as_json import keys
from mffit.brief import Brief
from mffit.comparison.of_rig import ExplainedByRig
from mffit.fleet import Specimen
from mffit.numbers import Numbers
from mffit.points import Points
from mffit.prediction import Predictor
from mffit.rig import Simulation
from mffit.scatter import significant
from tir import Tyre
from tir.frozen import ReadOnlyArrays
from tir.parameters import BY_NAME

OF_ORDER_ONE = frozenset({"epsilon_gamma"})
"""Numbers that are ranked by absolute difference, because they may be near zero."""

Shared = Mapping[tuple[str, str], tuple[Mapping[str, float], Mapping[str, float]]]
"""By rig error, the changes of the numbers of both sides, see ``Specimen.moved_by``."""


@dataclass(frozen=True, slots=True)
class ComparedSubject:
    """One side of a comparison."""

    name: str
    tyre: Tyre
    turn_slip: bool  #: whether the simulation that uses the file computes turn slip
    known: Numbers | None = None  #: covariance of its coefficients; None if it is unknown
    build: Specimen | None = None  #: the build that wrote the file with this covariance
    #: Predictor of its build, and the fitted model of the build; None if unknown.
    foretold: tuple[Predictor, Tyre] | None = None
    missed: Mapping[str, float] = field(default_factory=dict)
    """By channel, the rms [N], [Nm] by which the file misses the readings of its build beyond their noise, as that states."""


@dataclass(frozen=True, slots=True)
class Difference:
    """A number of both sides; the difference is ``second`` minus ``first``."""

    key: str  #: key of CHARACTERISTICS or DIRECT, or name of a coefficient
    load: float | None  #: [N]; None for a coefficient
    first: float
    second: float
    u_first: float | None = None  #: k = 1; None if unknown
    u_second: float | None = None
    covariance: float = 0.0  #: covariance of both sides from errors of a common rig
    at_least_first: bool = False  #: a largest force that is not a peak, see :class:`mffit.rounding.AtLeast`
    at_least_second: bool = False
    estimated_first: bool = False  #: the first side did not measure it
    estimated_second: bool = False

    @property
    def change(self) -> float:
        return self.second - self.first

    @property
    def u(self) -> float | None:
        """Uncertainty of the difference; None if those of both sides are unknown, or if one side did not measure the number."""
        if self.estimated_first or self.estimated_second:
            return None
        known = [u for u in (self.u_first, self.u_second) if u is not None]
        return math.sqrt(max(sum(u**2 for u in known) - 2.0 * self.covariance, 0.0)) if known else None

    @property
    def z(self) -> float | None:
        """The difference in units of its uncertainty."""
        return self.change / self.u if self.u else None

    @property
    def relative(self) -> float:
        """The absolute change over the usual range for a coefficient, over 1 for eps_gamma, else over the larger side."""
        size = max(abs(self.first), abs(self.second))
        if self.key in OF_ORDER_ONE:
            size = 1.0
        elif self.load is None and math.isfinite(BY_NAME[self.key].width):
            size = BY_NAME[self.key].width
        return abs(self.change) / size if size else 0.0


keys(Difference, "* change u_change=u in_u=z")


def ranked(rows: list[Difference]) -> tuple[Difference, ...]:
    """The differences, sorted: first those with known uncertainty, by their ratio to it; then the others, by relative size."""
    return tuple(sorted(rows, key=lambda row: (row.z is None, -abs(row.z or 0.0), -row.relative)))


@dataclass(frozen=True, slots=True)
class CurveGap(ReadOnlyArrays):
    """Two files' curves over an angle or over slip at a load, on their common range."""

    channel: str
    over: str  #: the varied quantity: "alpha", "gamma" or "kappa"; the others are 0
    load: float  #: [N]
    x: np.ndarray  #: (m,) [rad], over slip [-]
    first: np.ndarray  #: (m,) [N] or [Nm]
    second: np.ndarray
    half_first: np.ndarray | None  #: half width of the 95 % band; None if unknown
    half_second: np.ndarray | None

    @property
    def rms(self) -> float:
        return float(np.sqrt(np.mean((self.second - self.first) ** 2)))

    @property
    def largest(self) -> tuple[float, float]:
        """The largest difference, with its sign, and its angle [rad] or slip [-]."""
        k = int(np.argmax(np.abs(self.second - self.first)))
        return float(self.second[k] - self.first[k]), float(self.x[k])


keys(
    CurveGap,
    "channel over load_N rms largest=largest.0 **at",
    at=lambda gap: (
        {"at_kappa": gap.largest[1]} if gap.over == "kappa" else {"at_deg": math.degrees(gap.largest[1])}
    ),
)


@dataclass(frozen=True, slots=True)
class SweepGap:
    """Readings of one sweep against a file: measured minus file."""

    sweep: str
    channel: str
    rms: float
    bias: float  #: mean
    noise: float | None  #: typical stated uncertainty of a reading
    over_noise: float | None  #: rms gap over the stated uncertainty of the readings
    n: int


@dataclass(frozen=True, slots=True)
class Comparison(Brief):
    """Two sides and their differences."""

    first: str
    second: str
    numbers: tuple[Difference, ...]  #: ranked
    coefficients: tuple[Difference, ...]  #: ranked; empty against data
    curves: tuple[CurveGap, ...]
    sweeps: tuple[SweepGap, ...]  #: against data, worst first
    notes: tuple[str, ...]
    apart: str = ""  #: words on different uses or nominal conditions of the files; empty if they agree
    points: Points | None = None  #: the data, if the second side is measured
    simulation: Simulation | None = None  #: the file on the rig, compared with these data
    by_rig: ExplainedByRig | None = None  #: what errors of the rig explain, if the second side is measured
    fitted: bool = False  #: whether a build fitted the file to these data

    @property
    def unequal(self) -> tuple[Difference, ...]:
        """The numbers that differ at all."""
        return tuple(row for row in self.numbers if row.change)

    @property
    def judged(self) -> bool:
        """Whether the uncertainty of any difference is known."""
        return any(row.z is not None for row in (*self.numbers, *self.coefficients))

    @property
    def significant(self) -> tuple[Difference, ...]:
        """The numbers, then the coefficients, that differ beyond chance, at a false discovery rate of 1 %."""
        rows = (*self.numbers, *self.coefficients)
        known = [row for row in rows if row.z is not None and math.isfinite(row.z)]
        return tuple(compress(known, significant(np.array([row.z for row in known], dtype=float))))


keys(
    Comparison,
    "first second headline by_rig numbers coefficients curves sweeps notes",
    headline="mffit.comparison.wording.headline",
)
