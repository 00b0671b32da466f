"""The parameter table as frozen records; knows no file syntax and no equation."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from importlib.resources import files


@dataclass(frozen=True, slots=True)
class Parameter:
    """One row of ``parameters.csv``."""

    name: str
    section: str
    order: int  #: place in a written file
    kind: str  #: "number" or "text"
    unit: str  #: SI; "-" dimensionless, "" for text
    default: float | str  #: value of a key that a file does not have
    lower: float | None  #: plausible range, used by the fit; None where nothing is fitted
    upper: float | None
    stage: str  #: stage of the fit that frees it; "" where nothing is fitted
    equation: str  #: where it enters
    description: str

    @property
    def bounds(self) -> tuple[float, float]:
        """The plausible range; all numbers where the table has none."""
        return (
            -math.inf if self.lower is None else self.lower,
            math.inf if self.upper is None else self.upper,
        )

    @property
    def width(self) -> float:
        """Width of the plausible range."""
        lower, upper = self.bounds
        return upper - lower


def _load() -> tuple[Parameter, ...]:
    text = (files("tir") / "parameters.csv").read_text(encoding="ascii")
    return tuple(_parameter(row) for row in csv.DictReader(text.splitlines()))


def _parameter(row: dict[str, str]) -> Parameter:
    number = row["kind"] == "number"
    return Parameter(
        name=row["name"],
        section=row["section"],
        order=int(row["order"]),
        kind=row["kind"],
        unit=row["unit"],
        default=float(row["default"]) if number else row["default"],
        lower=float(row["lower"]) if row["lower"] else None,
        upper=float(row["upper"]) if row["upper"] else None,
        stage=row["stage"],
        equation=row["equation"],
        description=row["description"],
    )


TABLE: tuple[Parameter, ...] = _load()
BY_NAME: dict[str, Parameter] = {row.name: row for row in TABLE}
SECTIONS: tuple[str, ...] = tuple(dict.fromkeys(row.section for row in TABLE))
