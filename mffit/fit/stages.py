"""The stages of the fit, in order, and the kinds of coefficients that the table marks."""

from __future__ import annotations

from dataclasses import dataclass

from tir.parameters import TABLE


@dataclass(frozen=True, slots=True)
class Stage:
    """One step of the staged fit.

    It frees the coefficients that the table assigns to it, together with those of the stages in ``reopened``: each stage
    starts near its solution, and what an earlier one got slightly wrong for lack of data can still move.
    """

    name: str  #: the word in the table's ``stage`` column
    title: str
    channels: tuple[str, ...]  #: measured channels it is fitted to
    reopened: tuple[str, ...] = ()  #: earlier stages whose coefficients move again
    zero_camber: bool = False  #: uses only points without camber
    main_pressure: bool = False  #: uses only points at the pressure of most of the programme

    @property
    def parameters(self) -> tuple[str, ...]:
        return tuple(row.name for row in TABLE if row.stage == self.name)


@dataclass(frozen=True, slots=True)
class StageRecord:
    """What one stage of the fit did."""

    name: str
    title: str
    parameters: tuple[str, ...]
    rmse_Fy: float
    rmse_Mz: float
    note: str = ""


STAGES = (
    Stage("Fy", "Side force at zero camber", ("Fy",), zero_camber=True, main_pressure=True),
    Stage("camber", "Camber", ("Fy",), reopened=("Fy",), main_pressure=True),
    Stage("pressure", "Pressure", ("Fy",), reopened=("Fy",)),
    Stage("trail", "Pneumatic trail", ("Mz",), zero_camber=True),
    Stage("residual", "Residual torque", ("Mz",), reopened=("trail",)),
    Stage("spin", "Turn slip", ("Fy", "Mz")),
    Stage("shift", "Ply-steer and conicity", ("Fy", "Mz"), reopened=("spin",)),
)

ODD_TERMS = frozenset(row.name for row in TABLE if row.odd)
"""Terms that a tyre of perfect mirror symmetry does not have."""
SHIFT_TERMS = frozenset(row.name for row in TABLE if row.shift)
"""Odd terms that on a disc live in the even part, beside turn slip: only backward runs or flipped mounts show them."""
SMALL_ON_A_DISC = {row.name: row.disc_spread for row in TABLE if row.disc_spread is not None}
"""Spread, 1 sigma, of what a disc shows only beside something larger: conicity beside the turn-slip force, ply-steer beside the
zero of the sideslip axis. They are held to the size that road tyres have."""
WITH_CAMBER = frozenset(row.name for row in TABLE for need in row.needs if need.word in ("camber", "coupled"))
"""Coefficients that act only on a leaning wheel."""
