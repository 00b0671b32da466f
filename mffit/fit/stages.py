"""The stages of the fit, in order, and groups of coefficients that the parameter table marks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from tir.parameters import TABLE


@dataclass(frozen=True, slots=True)
class Stage:
    """One step of the staged fit.

    It frees the coefficients that the parameter table assigns to it and those of the stages in ``reopened``, so that small
    errors of earlier stages, which had less data, can still be corrected.
    """

    name: str  #: the word in the table's ``stage`` column
    title: str
    channels: tuple[str, ...]  #: measured channels that it is fitted to
    reopened: tuple[str, ...] = ()  #: earlier stages whose coefficients are free again
    zero_camber: bool = False  #: uses only points without camber
    main_pressure: bool = False  #: uses only points at the most frequent pressure

    @property
    def parameters(self) -> tuple[str, ...]:
        """Coefficients that the parameter table assigns to the stage."""
        return tuple(row.name for row in TABLE if row.stage == self.name)


@dataclass(frozen=True, slots=True)
class StageRecord:
    """The coefficients of one stage and the misfit after it."""

    name: str
    title: str
    parameters: tuple[str, ...]
    rmse: Mapping[str, float]  #: by channel of the fit
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
"""Coefficients that are zero for a tyre of perfect mirror symmetry."""
SMALL_ON_A_DISC = {row.name: row.disc_spread for row in TABLE if row.disc_spread is not None}
"""Prior standard deviation, from road tyres, of coefficients that a disc shows only together with a larger effect: conicity with
the turn-slip force, ply-steer with the zero of the sideslip axis."""
WITH_CAMBER = frozenset(row.name for row in TABLE for need in row.needs if need.word in ("camber", "coupled"))
"""Coefficients that act only on a cambered wheel."""
