"""What the page of files draws and what moves it: panels, and sliders with their ranges for the tyres of the page."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from mffit.quantities import MODEL
from tir import Tyre
from tir.codegen.program import INPUTS
from tir.errors import begun
from tir.units import KINDS


@dataclass(frozen=True, slots=True)
class ViewerPanel:
    """An output of the model over one of its inputs, the other inputs as the sliders have them."""

    x: str
    y: str
    name: str = ""  #: for the heading; empty for the name of the output
    sign: int = 1  #: -1 for outputs that are negative in ISO-W and drawn by their size
    sweep: str = ""  #: the input that is swept where x is an output too
    fan: Sequence[float] = ()  #: sideslip angles [deg] beside the slider's
    turn_slip: bool = False  #: constant without turn slip

    @property
    def key(self) -> str:
        """The panel's name in the page."""
        return f"{self.y}-{self.x}"

    @property
    def word(self) -> str:
        """The heading."""
        word = self.name or MODEL[self.y].word
        return begun(word)


FAN = (-12.0, -8.0, -4.0, -2.0, 2.0, 4.0, 8.0, 12.0)
"""Sideslips [deg] of the thin lines over longitudinal slip."""
PANELS = (
    ViewerPanel("alpha", "Fy"),
    ViewerPanel("alpha", "Mz"),
    ViewerPanel("kappa", "Fx"),
    ViewerPanel("gamma", "Fy", "camber thrust"),
    ViewerPanel("Fx", "Fy", "friction ellipse", sweep="kappa", fan=FAN),
    ViewerPanel("kappa", "Fy", "side force over slip", fan=FAN),
    ViewerPanel("kappa", "Mz", "aligning moment over slip", fan=FAN),
    ViewerPanel("alpha", "trail"),
    ViewerPanel("Fz", "K_ya", sign=-1),
    ViewerPanel("Fz", "K_yg0", sign=-1),
    ViewerPanel("Fz", "K_xk"),
    ViewerPanel("phi_t", "Fy", "turn-slip force", turn_slip=True),
    ViewerPanel("phi_t", "Mz", "turn-slip moment", turn_slip=True),
    ViewerPanel("gamma", "Mx"),
    ViewerPanel("Fz", "sigma_y"),
    ViewerPanel("Vx", "My"),
)
OUTPUTS = tuple(dict.fromkeys(name for panel in PANELS for name in (panel.x, panel.y) if name not in INPUTS))
"""The outputs that the page computes."""


@dataclass(frozen=True, slots=True)
class Control:
    """An input of the model that the page moves; numbers in SI, or shares of the value of ``relative_to``."""

    name: str  #: as tir calls it
    usual: Sequence[float]  #: range if a file states none
    widest: Sequence[float]  #: a file's range is cut to this
    limits: tuple[str, str] | None = None  #: the file's keys of its range
    start: str = ""  #: the file's key of the value when the page opens; 0 without a key
    relative_to: str = ""

    def range_of(self, tyre: Tyre) -> tuple[float, float]:
        """The range of a tyre [SI]: the one in its file if that is a range, else the usual one."""
        scale = float(tyre[self.relative_to]) if self.relative_to else 1.0
        usual, widest = ([x * scale for x in bounds] for bounds in (self.usual, self.widest))
        written = written_range(tyre, self)
        if written is None:
            return usual[0], usual[1]
        low, high = (min(max(x, widest[0]), widest[1]) for x in written)
        return (low, high) if low < high else (usual[0], usual[1])


def _either_way(x: float) -> tuple[float, float]:
    return -x, x


def _angle(x_deg: float) -> tuple[float, float]:
    return _either_way(math.radians(x_deg))


CONTROLS = (
    Control("Fz", (0.1, 2.0), (0.05, 3.0), ("FZMIN", "FZMAX"), start="FNOMIN", relative_to="FNOMIN"),
    Control("gamma", _angle(10.0), _angle(60.0), ("CAMMIN", "CAMMAX")),  # cars lean, motorcycles lean at most
    Control(
        "pressure", (0.8, 1.2), (0.5, 1.5), ("PRESMIN", "PRESMAX"), start="INFLPRES", relative_to="NOMPRES"
    ),
    Control("alpha", _angle(15.0), _angle(20.0), ("ALPMIN", "ALPMAX")),  # beyond the peak of every tyre
    Control("kappa", _either_way(0.3), _either_way(0.4), ("KPUMIN", "KPUMAX")),
    Control("phi_t", _either_way(1.0), _either_way(1.0)),  # rigs with a disc reach about 0.8 1/m
    Control("Vx", (-20.0, 60.0), (-20.0, 60.0), start="LONGVL"),
)


def written_range(tyre: Tyre, control: Control) -> tuple[float, float] | None:
    """The range in the tyre's file [SI]; None if the file states none."""
    if control.limits is None or not set(control.limits) <= tyre.present:
        return None
    low, high = (float(tyre[key]) for key in control.limits)
    return low, high


def settings(tyres: Sequence[Tyre]) -> list[dict[str, object]]:
    """The settings of each slider in the units of the page; ends and steps are round numbers within the ranges of the files."""
    return [_setting(control, tyres) for control in CONTROLS]


def _setting(control: Control, tyres: Sequence[Tyre]) -> dict[str, object]:
    quantity = MODEL[control.name]
    si = in_si(quantity.unit)
    ranges = [control.range_of(tyre) for tyre in tyres]
    low, high = min(r[0] for r in ranges) / si, max(r[1] for r in ranges) / si
    start = float(tyres[0][control.start]) / si if control.start else 0.0
    low, high = min(low, start, high), max(high, start, low)
    step = _round_step((high - low) / 200.0)  # moves the curves by less than a line's width
    digits = max(0, -math.floor(math.log10(step) + 1e-9))
    return {
        "name": control.name,
        "si": si,
        "min": round(min(math.ceil(low / step - 1e-9), math.floor(start / step)) * step, digits),
        "max": round(max(math.floor(high / step + 1e-9), math.ceil(start / step)) * step, digits),
        "step": round(step, digits),
        "start": start,
    }


def _round_step(x: float) -> float:
    """The largest of 1, 2, 5, 10, ... not above ``x``."""
    power = 10.0 ** math.floor(math.log10(x))
    return power * max(n for n in (1.0, 2.0, 5.0) if n * power <= x * (1.0 + 1e-9))


def in_si(unit: str) -> float:
    """One of the unit in SI: 1 for SI units and for no unit."""
    return next((known[unit.lower()] for known in KINDS.values() if unit.lower() in known), 1.0)
