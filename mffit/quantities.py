"""What is measured, simulated and plotted: word, symbol and unit, once for every sentence, table, picture and page."""

from __future__ import annotations

import re
from typing import NamedTuple

GREEK = str.maketrans(
    {
        "α": "alpha",
        "γ": "gamma",
        "ε": "eps",
        "φ": "phi",
        "κ": "kappa",
        "σ": "sigma",
        "μ": "mu",
        "χ": "chi",
        "²": "2",
    }
)


class Quantity(NamedTuple):
    """How an engineer names a number; the subscript of a symbol stands behind ``_``."""

    word: str
    symbol: str
    unit: str  #: "-" if it has none

    @property
    def ascii(self) -> str:
        """The symbol as a terminal shows it: ``eps_gamma``."""
        return self.symbol.translate(GREEK)

    @property
    def mathtext(self) -> str:
        """The symbol as a picture shows it."""
        return re.sub(r"_(\w+)", r"$_{\1}$", self.symbol)

    @property
    def html(self) -> str:
        """The symbol as a page shows it."""
        return re.sub(r"_(\w+)", r"<sub>\1</sub>", self.symbol)

    @property
    def unit_behind(self) -> str:
        """What stands behind a number of this quantity: empty without a unit."""
        return "" if self.unit == "-" else self.unit

    @property
    def axis(self) -> str:
        """The label of a picture's axis."""
        return f"{self.word} {self.mathtext} [{self.unit.replace('-', '–')}]"

    @property
    def short_axis(self) -> str:
        """The same without the word, where there is little room."""
        return f"{self.mathtext} [{self.unit.replace('-', '–')}]"

    def column(self, name: str) -> str:
        """The heading of a table's column."""
        return f"{name} [{self.unit}]" if self.unit_behind else name

    def of(self, value: float) -> str:
        """A round value with its unit, as conditions are named: ``1500 N``."""
        return f"{value:.0f} {self.unit}"


CONDITIONS = {
    "alpha_deg": Quantity("sideslip", "α", "deg"),
    "gamma_deg": Quantity("camber", "γ", "deg"),
    "Fz_N": Quantity("load", "F_z", "N"),
    "p_kPa": Quantity("pressure", "p", "kPa"),
    "V_mps": Quantity("speed", "V", "m/s"),
    "T_degC": Quantity("temperature", "T", "degC"),
    "t_s": Quantity("time", "t", "s"),
}
"""Conditions of a point, by their column."""
CHANNELS = {
    "Fy": Quantity("side force", "F_y", "N"),
    "Mz": Quantity("self-aligning moment", "M_z", "Nm"),
}
"""Measured channels that are simulated, by their name in sentences and files."""
DIRECT = {
    "epsilon_gamma": Quantity("camber reduction factor", "ε_γ", "-"),
    "C_phit": Quantity("turn-slip stiffness", "C_φt", "Nm"),
    "C_gamma": Quantity("camber stiffness", "C_γ", "N/rad"),
    "C_alpha": Quantity("cornering stiffness", "C_α", "N/rad"),
    "r_e": Quantity("effective radius", "r_e", "m"),
    "R": Quantity("path radius", "R", "m"),
    "F_phit": Quantity("turn-slip force", "F_φt", "N"),
    "alpha_M": Quantity("sideslip misalignment", "α_M", "rad"),
}
"""What the direct method measures, by the attribute of its records."""
CHARACTERISTICS = {
    "epsilon_gamma": DIRECT["epsilon_gamma"],
    "C_alpha_N_per_rad": DIRECT["C_alpha"],
    "C_gamma_N_per_rad": DIRECT["C_gamma"],
    "C_Mz_alpha_Nm_per_rad": Quantity("aligning stiffness", "C_Mα", "Nm/rad"),
    "C_phit_Nm": DIRECT["C_phit"],
    "mu_y": Quantity("peak of side force over load", "μ_y", "-"),
    "Mz_peak_Nm": Quantity("peak of self-aligning moment", "M_zmax", "Nm"),
    "trail_m": Quantity("pneumatic trail at zero slip", "t_0", "m"),
    "r_e_m": DIRECT["r_e"],
}
"""What an engineer compares first of two tyres, by its key in JSON."""
MODEL = {
    "Fz": CONDITIONS["Fz_N"],
    "alpha": CONDITIONS["alpha_deg"],
    "gamma": CONDITIONS["gamma_deg"],
    "kappa": Quantity("longitudinal slip", "κ", "-"),
    "phi_t": Quantity("path curvature", "φ_t", "1/m"),
    "Vx": CONDITIONS["V_mps"],
    "pressure": CONDITIONS["p_kPa"],
    "Fx": Quantity("longitudinal force", "F_x", "N"),
    **CHANNELS,
    "Mx": Quantity("overturning moment", "M_x", "Nm"),
    "My": Quantity("rolling resistance moment", "M_y", "Nm"),
    "K_ya": DIRECT["C_alpha"]._replace(symbol="K_yα"),
    "K_yg0": DIRECT["C_gamma"]._replace(symbol="K_yγ0"),
    "trail": Quantity("pneumatic trail", "t", "mm"),
    "sigma_y": Quantity("lateral relaxation length", "σ_y", "m"),
}
"""What the model of a tyre takes and gives, by tir's names; shown in these units, computed in SI."""
COMPARED = {
    "C_alpha_N_per_rad": DIRECT["C_alpha"],
    "C_gamma_N_per_rad": DIRECT["C_gamma"],
    "C_Mz_alpha_Nm_per_rad": Quantity("aligning stiffness", "C_Mα", "Nm/rad"),
    "mu_y": Quantity("largest side force over load", "μ_y", "-"),
    "Mz_peak_Nm": Quantity("largest aligning moment", "M_max", "Nm"),
}
"""What tyres are compared by, beside eps_gamma: of the fitted model at nominal load and pressure on a straight path."""
DIAGNOSED = {"chi2": Quantity("chi-squared", "χ²", "-")}
"""What a diagnosis judges by."""
