"""Words for the numbers of a fit and of a diagnosis: people read these instead of keys of the rig."""

from mffit.rig.simulation import SWITCH
from mffit.rig_errors import error_of, shown, words_of
from mffit.rig_errors import unit_of as rig_unit_of
from tir.parameters import BY_NAME


def of_number(name: str) -> str:
    """Words for a number of the rig and for the switch of turn slip; a coefficient of the tyre keeps its name."""
    return "turn slip of the simulation" if name == SWITCH else words_of(name) or name


def in_unit(name: str, value: float, u: float) -> tuple[float, float, str]:
    """A number and its uncertainty in the unit in which people read it, and that unit."""
    return shown(name, value, u) if error_of(name) else (value, u, unit_of(name))


def unit_of(name: str) -> str:
    """Unit of a coefficient or of a number of the rig; empty without one."""
    unit = rig_unit_of(name) if error_of(name) else BY_NAME[name].unit if name in BY_NAME else ""
    return "" if unit == "-" else unit
