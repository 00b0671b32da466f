"""The parameter table as frozen records; contains no file syntax and no equation."""

import csv
import math
from dataclasses import dataclass
from importlib.resources import files as resources
from typing import NamedTuple

from tir.constants import MARGIN_INSIDE_RANGE

REGULAR = ("", "motorcycle", "62")
"""Words of the column ``files``: a file with all keys of these rows is complete for every program."""
TURN_SLIP = "TURNSLIP_COEFFICIENTS"
AS_WRITTEN = ("name", "section", "kind", "unit", "stage", "channel", "files", "equation", "description")
"""Columns that are fields of a record as they stand."""
NORMAL_MODE = ("LATERAL_COEFFICIENTS", "ALIGNING_COEFFICIENTS")


class Need(NamedTuple):
    """A condition that the data must vary before a coefficient can be identified."""

    word: str  #: see docs/parameters.md
    levels: int  #: at least this many levels; 1 if presence is enough


@dataclass(frozen=True, slots=True)
class Parameter:
    """One row of ``parameters.csv``; its columns are explained in docs/parameters.md."""

    name: str
    section: str
    order: int  #: place in a written file: its row of the table, from 1
    kind: str  #: "number" or "text"
    unit: str  #: SI; "-" dimensionless, "" for text
    default: float | str  #: value of a key that the file lacks
    lower: float | None  #: usual range, in units of which priors are stated; None where nothing is fitted
    upper: float | None
    least: float | None  #: limits of the fit, beyond which no published tyre lies
    most: float | None
    divisor: bool  #: the equations divide by it, so that it cannot be 0
    stage: str  #: stage of the fit that frees it; "" where nothing is fitted
    channel: str
    """Force or moment that must be measured to identify it; "" if it is not a coefficient of one."""
    symmetry: frozenset[str]  #: "odd", "shift", "conicity"; see the properties of these names
    disc_spread: float | None  #: spread around the base file's value to which runs on a disc hold it, 1 sigma
    symmetric_spread: float | None  #: spread of an asymmetry among tyres of symmetric construction, 1 sigma
    side_spread: float | None  #: the same for sideslip to one side only, where no data show it
    tyres_spread: float | None
    """Size that two thirds of published tyres have at most, of those that have it at all."""
    tyres: int  #: of how many; 0 if judged from the range of a few
    needs: tuple[Need, ...]  #: what the data must vary
    files: str  #: which files have the key, see docs/parameters.md; "" for all, :data:`REGULAR` for complete ones
    equation: str  #: the equation that contains it
    description: str

    @property
    def bounds(self) -> tuple[float, float]:
        """The limits of the fit; infinite if the table has none."""
        return _range(self.least, self.most)

    @property
    def usual(self) -> tuple[float, float]:
        """The usual range, outside which a value is rare; infinite if the table has none."""
        return _range(self.lower, self.upper)

    @property
    def width(self) -> float:
        """Width of the usual range."""
        lower, upper = self.usual
        return upper - lower

    def rare(self, value: float) -> bool:
        """Whether the value lies outside the usual range."""
        lower, upper = self.usual
        return not lower <= value <= upper

    def inside(self, value: float) -> float:
        """The value, moved slightly inside the limits: a search that starts on a bound can stay there."""
        lower, upper = self.bounds
        margin = MARGIN_INSIDE_RANGE * self.width if math.isfinite(self.width) else 0.0
        return min(max(value, lower + margin), upper - margin)

    @property
    def odd(self) -> bool:
        """Whether it is 0 for a mirror-symmetric tyre."""
        return "odd" in self.symmetry

    @property
    def shift(self) -> bool:
        """Whether it is an odd term that a disc shows in the even part, together with turn slip."""
        return "shift" in self.symmetry

    @property
    def conicity(self) -> bool:
        """Whether it changes sign when the tyre is turned on its rim."""
        return "conicity" in self.symmetry

    @property
    def scaling(self) -> bool:
        """Whether it is a scaling factor, 1 in a fitted file."""
        return self.section == "SCALING_COEFFICIENTS"

    @property
    def normal_mode(self) -> bool:
        """Whether it is a coefficient of Fy or Mz at pure sideslip and camber, without turn slip."""
        return self.section in NORMAL_MODE and bool(self.stage) and not self.of_slip

    @property
    def of_slip(self) -> bool:
        """Whether it acts only where longitudinal slip was run, alone or with sideslip."""
        return any(need.word in ("kappa", "combined", "side_force") for need in self.needs)


def _range(lower: float | None, upper: float | None) -> tuple[float, float]:
    return -math.inf if lower is None else lower, math.inf if upper is None else upper


def _load() -> tuple[Parameter, ...]:
    text = (resources("tir") / "parameters.csv").read_text(encoding="ascii")
    return tuple(_parameter(i, row) for i, row in enumerate(csv.DictReader(text.splitlines()), start=1))


def _parameter(order: int, row: dict[str, str]) -> Parameter:
    number = row["kind"] == "number"
    (lower, least), (upper, most) = (_end(row[side]) for side in ("lower", "upper"))
    tied = dict(word.split(":") for word in row["tied"].split())
    return Parameter(
        **{column: row[column] for column in AS_WRITTEN},
        order=order,
        default=float(row["default"]) if number else row["default"],
        lower=lower,
        upper=upper,
        least=least,
        most=most,
        divisor=row["divisor"] == "yes",
        symmetry=frozenset(row["symmetry"].split()),
        disc_spread=float(tied["disc"]) if "disc" in tied else None,
        symmetric_spread=float(tied["symmetric"]) if "symmetric" in tied else None,
        side_spread=float(tied["side"]) if "side" in tied else None,
        tyres_spread=float(tied["tyres"].partition("/")[0]) if "tyres" in tied else None,
        tyres=int(tied.get("tyres", "").partition("/")[2] or 0),
        needs=tuple(_need(word) for word in row["needs"].split()),
    )


def _end(text: str) -> tuple[float | None, float | None]:
    """An end of the usual range, and the limit, which is written behind a colon where it lies further out."""
    usual, _, limit = text.partition(":")
    return (float(usual), float(limit or usual)) if usual else (None, None)


def _need(text: str) -> Need:
    word, _, levels = text.partition(":")
    return Need(word, int(levels or 1))


TABLE: tuple[Parameter, ...] = _load()
BY_NAME: dict[str, Parameter] = {row.name: row for row in TABLE}
SECTIONS: tuple[str, ...] = tuple(dict.fromkeys(row.section for row in TABLE))
