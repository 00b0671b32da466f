"""The panels of the page, one record each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from mffit.quantities import MODEL, QuantityName
from tir.codegen.program import INPUTS


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
        word = self.name or self.output.word
        return word[0].upper() + word[1:]

    @property
    def output(self) -> QuantityName:
        return MODEL[self.y]

    @property
    def input(self) -> QuantityName:
        return MODEL[self.x]


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
