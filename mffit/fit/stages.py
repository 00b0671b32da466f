"""The stages of the parameter table: groups of coefficients with the channels that show them."""

from dataclasses import dataclass

from mffit.rig_errors import ZEROS, error_of
from tir.parameters import TABLE


@dataclass(frozen=True, slots=True)
class Stage:
    """A row of the coverage matrix: the coefficients that the parameter table assigns to it."""

    name: str  #: the word in the table's ``stage`` column
    title: str
    channels: tuple[str, ...]  #: measured channels that determine the coefficients
    where_measured: bool = False  #: listed only if its channels were measured
    where_run: bool = False  #: listed only if longitudinal slip was run

    @property
    def parameters(self) -> tuple[str, ...]:
        """Coefficients that the parameter table assigns to the stage."""
        return tuple(row.name for row in TABLE if row.stage == self.name)


STAGES = (
    Stage("Fx", "Longitudinal force at zero camber", ("Fx",), where_measured=True),
    Stage("Fx-camber", "Longitudinal force with camber", ("Fx",), where_measured=True),
    Stage("Fx-pressure", "Longitudinal force over pressure", ("Fx",), where_measured=True),
    Stage("Fy", "Side force at zero camber", ("Fy",)),
    Stage("camber", "Camber", ("Fy",)),
    Stage("pressure", "Pressure", ("Fy",)),
    Stage("combined-Fx", "Longitudinal force with sideslip", ("Fx",), where_measured=True),
    Stage("combined-Fy", "Side force with longitudinal slip", ("Fy",), where_run=True),
    Stage("trail", "Pneumatic trail", ("Mz",)),
    Stage("residual", "Residual torque", ("Mz",)),
    Stage("combined-Mz", "Self-aligning moment with longitudinal slip", ("Mz",), where_run=True),
    Stage("spin", "Turn slip", ("Fy", "Mz")),
    Stage("shift", "Ply-steer and conicity", ("Fy", "Mz")),
    Stage("Mx", "Overturning moment", ("Mx",), where_measured=True),
)

BY_STAGE = {stage.name: stage for stage in STAGES}
"""Every stage by its word in the table."""
ODD_TERMS = frozenset(row.name for row in TABLE if row.odd)
"""Coefficients that are zero for a tyre of perfect mirror symmetry."""
SMALL_ON_A_DISC = {row.name: row.disc_spread for row in TABLE if row.disc_spread is not None}
"""Prior standard deviation, from road tyres, of coefficients that a disc cannot separate from a larger effect: conicity from the
turn-slip force, ply-steer from the zero of the sideslip axis."""


def is_asymmetry(number: str) -> bool:
    """Whether a number is zero for a tyre of perfect mirror symmetry on a rig whose zeros are right."""
    return number in ODD_TERMS or error_of(number) in ZEROS


OF_CAMBER_OR_SPIN = frozenset(
    row.name for row in TABLE for need in row.needs if need.word in ("camber", "coupled", "curvature")
)
"""Coefficients that act only on a cambered wheel or on a curved path."""
