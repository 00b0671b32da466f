"""The stages of the fit, in order, and what each coefficient needs to be seen in the data."""

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


STAGES = (
    Stage("Fy", "Side force at zero camber", ("Fy",), zero_camber=True, main_pressure=True),
    Stage("camber", "Camber", ("Fy",), reopened=("Fy",), main_pressure=True),
    Stage("pressure", "Pressure", ("Fy",), reopened=("Fy",)),
    Stage("trail", "Pneumatic trail", ("Mz",)),
    Stage("residual", "Residual torque", ("Mz",), reopened=("trail",)),
    Stage("spin", "Turn slip", ("Fy", "Mz")),
    Stage("shift", "Ply-steer and conicity", ("Fy", "Mz"), reopened=("spin",)),
)

TWO_LOADS = frozenset(
    [
        "PDY2",
        "PEY2",
        "PKY2",
        "PKY7",
        "PHY2",
        "PVY2",
        "PVY4",
        "QBZ2",
        "QDZ2",
        "QDZ7",
        "QDZ9",
        "QDZ11",
        "QEZ2",
        "QHZ2",
        "QHZ4",
        "PHYP3",
        "PDYP2",
    ]
)
THREE_LOADS = frozenset(["PKY4", "QBZ3", "QEZ3"])
TWO_PRESSURES = frozenset(["PPY1", "PPY2", "PPY3", "PPY5", "PPZ1", "PPZ2"])
THREE_PRESSURES = frozenset({"PPY4"})
CAMBER_MOMENT = frozenset(["QDZ8", "QDZ9", "QDZ10", "QDZ11", "QHZ3", "QHZ4"])
COUPLED = frozenset(["PKY3", "PKY5", "PEY4", "PEY5", "QBZ4", "QBZ5", "QDZ3", "QDZ4", "QEZ5", "PHYP4"])
ODD_TERMS = frozenset(
    ["PHY1", "PHY2", "PVY1", "PVY2", "PEY3", "QBZ4", "QDZ3", "QDZ6", "QDZ7", "QEZ4", "QHZ1", "QHZ2"]
)
"""Terms that a tyre of perfect mirror symmetry does not have."""
SHIFT_TERMS = frozenset(["PHY1", "PHY2", "PVY1", "PVY2", "PEY3", "QHZ1", "QHZ2", "QDZ6", "QDZ7", "QEZ4"])
"""Odd terms that on a disc live in the even part, beside turn slip: only backward runs or flipped mounts show them."""
IF_IDENTIFIED = frozenset(
    ["PHYP1", "PHYP2", "PHYP3", "PHYP4", "PDYP2", "PDYP3", "PDYP4", "QCRP1", "QCRP2", "QBRP1", "QDRP1"]
)
"""Spin coefficients that stay tied to the base file's value unless their relative standard error is below 0.5."""
CONICITY_ON_A_DISC = {"PVY1": 0.003, "PVY2": 0.003}
"""Spread of conicity over load, 1 sigma. On a disc it hides beside the turn-slip force, from which only the shape of the
curve tells it, so it is held to the size that road tyres have."""
