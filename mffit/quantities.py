"""Word, symbol and unit of all quantities, for sentences, tables, pictures and pages alike."""

import re
from typing import NamedTuple

GREEK = str.maketrans({
    "α": "alpha", "γ": "gamma", "ε": "eps", "φ": "phi", "κ": "kappa", "σ": "sigma", "ω": "omega", "μ": "mu", "χ": "chi", "²": "2",
})  # fmt: skip


class QuantityName(NamedTuple):
    """The name of a quantity: word, symbol and unit; ``_`` precedes the subscript of a symbol."""

    word: str
    symbol: str
    unit: str  #: "-" without one
    how: str = ""  #: how a result is obtained, and on which path
    enters: str = ""  #: coefficients of the property file that are the result

    @property
    def ascii(self) -> str:
        """The symbol for a terminal: ``eps_gamma``."""
        return self.symbol.translate(GREEK)

    @property
    def mathtext(self) -> str:
        """The symbol for a picture: its subscript is marked."""
        return re.sub(r"_(\w+)", r"$_{\1}$", self.symbol)

    @property
    def html(self) -> str:
        """The symbol for a page."""
        return re.sub(r"_(\w+)", r"<sub>\1</sub>", self.symbol)

    @property
    def unit_behind(self) -> str:
        """The unit to write after a number; empty without one."""
        return "" if self.unit == "-" else self.unit

    @property
    def axis(self) -> str:
        """The label of an axis in a picture."""
        return f"{self.word} {self.mathtext} [{self.unit.replace('-', '–')}]"

    @property
    def short_axis(self) -> str:
        """Symbol and unit, for an axis with little room."""
        return f"{self.mathtext} [{self.unit.replace('-', '–')}]"

    def column(self, name: str) -> str:
        """The heading of a column in a table."""
        return f"{name} [{self.unit}]" if self.unit_behind else name

    def of(self, value: float) -> str:
        """A rounded value with its unit: ``1500 N``; a slip has none: ``0.1``."""
        return f"{round(value) + 0.0:.0f} {self.unit}" if self.unit_behind else f"{round(value, 2) + 0.0:g}"


def column(channel: str, of: str = "") -> str:
    """Heading of a channel in tables and keys, with its unit: ``Fy_N``; ``Fy_model_N`` of the model, ``Fy_odd_N``."""
    unit = CHANNELS[channel].unit.replace("/", "p")
    return "_".join(part for part in (channel, of, unit) if part)


def u_column(channel: str) -> str:
    """Heading of the standard uncertainty of a channel: ``u_Fy_N``."""
    return f"u_{column(channel)}"


CONDITIONS = {
    "alpha_deg": QuantityName("sideslip", "α", "deg"),
    "gamma_deg": QuantityName("camber", "γ", "deg"),
    "kappa": QuantityName("longitudinal slip", "κ", "-"),
    "Fz_N": QuantityName("load", "F_z", "N"),
    "p_kPa": QuantityName("pressure", "p", "kPa"),
    "V_mps": QuantityName("speed", "V", "m/s"),
    "T_degC": QuantityName("temperature", "T", "degC"),
    "t_s": QuantityName("time", "t", "s"),
}
"""Conditions of a point, by their column."""
COLUMNS = {column.partition("_")[0]: column for column in CONDITIONS}
"""Column of a condition by the field of the points."""
CHANNELS = {
    "Fx": QuantityName("longitudinal force", "F_x", "N"),
    "Fy": QuantityName("side force", "F_y", "N"),
    "Mx": QuantityName("overturning moment", "M_x", "Nm"),
    "My": QuantityName("rolling resistance moment", "M_y", "Nm"),
    "Mz": QuantityName("self-aligning moment", "M_z", "Nm"),
    "RL": QuantityName("loaded radius", "R_L", "m"),
    "omega": QuantityName("wheel speed", "ω", "rad/s"),
}
"""Everything that a rig may read of a tyre, by its name in sentences, files, points and the model, in this order everywhere."""
SIDEWAYS = {name: CHANNELS[name] for name in ("Fy", "Mz")}
"""Channels of every test: Fy is required, and Mz is simulated with it whether or not it was measured."""
REVERSED_BY_A_MIRROR = frozenset({"Fy", "Mx", "Mz"})
"""Channels with the other sign in a mirror, where sideslip, camber and the path's curvature have the other sign."""
REVERSED_BY_HALF_A_TURN = frozenset({"Fx", "Fy", "Mx", "My"})
"""Channels with the other sign in axes turned by half a revolution about z, where a wheel that rolls backwards rolls forwards."""
SLOPE_ON_PATH = "slope at zero on the path of the measurement"
DIRECT = {
    "epsilon_gamma": QuantityName("camber reduction factor", "ε_γ", "-", "1 + r_e C_gamma / C_phit (17)", "PECP1 and PECP2"),
    "C_phit": QuantityName("turn-slip stiffness", "C_φt", "Nm", "turn-slip force over the curvature of the path (21)"),
    "F_phit": QuantityName("turn-slip force", "F_φt", "N", "at zero angles, corrected for rig errors (23)"),
    "C_gamma": QuantityName("measured camber stiffness", "C_γ", "N/rad", SLOPE_ON_PATH),
    "C_alpha": QuantityName("measured cornering stiffness", "C_α", "N/rad", SLOPE_ON_PATH),
    "C_alpha_straight": QuantityName("cornering stiffness", "C_α0", "N/rad", "slope at zero on a straight path"),
    "r_e": QuantityName("effective radius", "r_e", "m", "of the freely rolling wheel (18)", "Q_RE0, BREFF, DREFF and FREFF"),
    "R": QuantityName("path radius", "R", "m", "of the usual path (19)"),
    "alpha_M": QuantityName("misalignment plus ply-steer", "α_M", "rad", "from zeros both ways"),
    "misalignment": QuantityName("sideslip misalignment", "α_0", "rad", "part of alpha_M, by usual sizes"),
    "ply_steer": QuantityName("ply-steer", "α_ply", "rad", "part of alpha_M, by usual sizes"),
    "mu_y": QuantityName("peak side force per load", "μ_y", "-", "on a straight path"),
    "M_zmax": QuantityName("peak of self-aligning moment", "M_zmax", "Nm", "on a straight path"),
}  # fmt: skip
"""Results that users come for, by the attribute of their records, in the order of terminal, page and files."""
ON_ROAD = ("mu_y", "M_zmax")
"""Of these, results of the fit; the others are results of the direct method."""
KEYS = {
    name: name if quantity.unit == "-" else f"{name}_{quantity.unit.replace('/', '_per_')}"
    for name, quantity in DIRECT.items()
    if quantity.unit != "rad" and name not in ON_ROAD
}
"""Keys in property files and JSON of the results of the direct method, by name; of all but angles, which are stated in deg."""
CHARACTERISTICS = {
    "epsilon_gamma": DIRECT["epsilon_gamma"],
    "C_alpha_N_per_rad": DIRECT["C_alpha_straight"],
    "C_gamma_N_per_rad": QuantityName("camber stiffness", "C_γ0", "N/rad"),
    "C_Mz_alpha_Nm_per_rad": QuantityName("aligning stiffness", "C_Mα", "Nm/rad"),
    "C_phit_Nm": QuantityName("turn-slip stiffness at zero spin", "C_φt0", "Nm"),
    "K_xk_N": QuantityName("slip stiffness", "K_xκ", "N"),
    "mu_x": QuantityName("peak longitudinal force per load", "μ_x", "-"),
    "mu_y": DIRECT["mu_y"],
    "Mz_peak_Nm": DIRECT["M_zmax"],
    "trail_m": QuantityName("pneumatic trail at zero slip", "t_0", "m"),
    "r_e_m": DIRECT["r_e"],
}
"""Characteristics of a property file, its slopes at zero on a straight path, by their key in JSON."""
OF_ROAD = {key: name for name in ON_ROAD for key, known in CHARACTERISTICS.items() if known is DIRECT[name]}
"""Of these, the ones that a build states on the road, with their names there; a build as a whole has the lesser of both sides."""
MODEL = {
    "Fz": CONDITIONS["Fz_N"],
    "alpha": CONDITIONS["alpha_deg"],
    "gamma": CONDITIONS["gamma_deg"],
    "kappa": CONDITIONS["kappa"],
    "phi_t": QuantityName("path curvature", "φ_t", "1/m"),
    "Vx": CONDITIONS["V_mps"],
    "pressure": CONDITIONS["p_kPa"],
    **{name: CHANNELS[name] for name in ("Fx", "Fy", "Mz", "Mx", "My")},
    "K_ya": CHARACTERISTICS["C_alpha_N_per_rad"]._replace(symbol="K_yα"),
    "K_yg0": CHARACTERISTICS["C_gamma_N_per_rad"]._replace(symbol="K_yγ0"),
    "trail": QuantityName("pneumatic trail", "t", "mm"),
    "K_xk": CHARACTERISTICS["K_xk_N"],
    "sigma_y": QuantityName("lateral relaxation length", "σ_y", "m"),
}
"""Inputs and outputs of the tyre model, by their names in tir; shown in these units, computed in SI."""
COMPARED = {
    key: CHARACTERISTICS[key]._replace(
        word=CHARACTERISTICS[key].word + " of the lesser side" * (key in OF_ROAD)
    )
    for key in ("C_alpha_N_per_rad", "C_gamma_N_per_rad", "C_Mz_alpha_Nm_per_rad", "mu_y", "Mz_peak_Nm")
}
"""Characteristics of the tyres of a fleet at nominal load and pressure on a straight path: those of :data:`OF_ROAD` as on the
road, the others of the fitted model."""
DIAGNOSED = {"chi2": QuantityName("chi-squared", "χ²", "-")}
"""Statistics of a diagnosis."""
