"""The forms of lookup tables: what each holds of a tyre, and how its files are written (CSV, MATLAB, the text of CarSim)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

import tir
from mffit.csv_tables import csv_text
from mffit.errors import InputError
from mffit.export import constants
from mffit.export.grid import Function, Grid, Ranges
from mffit.quantities import column

CONDITIONS = {"Fz_N": "FZM", "alpha_deg": "ALPM", "gamma_deg": "CAMM", "kappa": "KPUM"}
"""Axes of the tables in the order of a call of the tyre, with the beginning of the keys of their ranges."""
PURE = {
    "Fx": ("Fz_N", "gamma_deg", "kappa"),
    "Fy": ("Fz_N", "alpha_deg", "gamma_deg"),
    "Mx": ("Fz_N", "alpha_deg", "gamma_deg"),
    "Mz": ("Fz_N", "alpha_deg", "gamma_deg"),
}
"""Channels and the axes of their tables in pure slip. My is left out: it depends on speed and jumps where the wheel locks."""
SLIP_IN_CARSIM = {
    "FX_TIRE": ("Fx", "kappa", 1.0),
    "FY_TIRE": ("Fy", "alpha_deg", -1.0),
    "MZ_TIRE": ("Mz", "alpha_deg", 1.0),
}
"""CarSim's keywords: channel, slip, and the sign that makes the force of a small positive slip positive, as it is there."""
CAMBER_IN_CARSIM = "KGAMMA"


@dataclass(frozen=True, slots=True)
class LookupTable:
    """Values of a channel on a grid of conditions."""

    name: str  #: of the file or variable: ``Fy``, ``Fy_combined``
    heading: str  #: of the values, with their unit: ``Fy_N``
    grid: Grid  #: in degrees, N, Nm
    held: Mapping[str, float]  #: the other conditions that tables can have as axes
    asymmetry: float = 0.0  #: largest part that CarSim's form cannot hold, over the largest value

    @property
    def sentence(self) -> str:
        """Size and error in words."""
        axes, error = self.grid.axes, self.grid.error
        text = (
            f"{self.name}: {' x '.join(str(len(x)) for x in axes.values())} nodes of {', '.join(axes)}"
            f"{''.join(f'; {name} = {value:g}' for name, value in self.held.items())}; linear interpolation misses "
            f"{100.0 * error:.2f} % of the largest {self.heading} {self.grid.largest:.4g} at most "
            f"({self.grid.tested} conditions off the nodes)"
        )
        return text + (
            f"; {100.0 * self.asymmetry:.2f} % are not symmetric and left out" if self.asymmetry else ""
        )

    def keys(self) -> dict[str, Any]:
        """The same for programs."""
        axes = {name: {"nodes": len(x), "from": x[0], "to": x[-1]} for name, x in self.grid.axes.items()}
        return {
            "name": self.name,
            "axes": axes,
            "held": dict(self.held),
            f"largest_{self.heading}": self.grid.largest,
            "error": self.grid.error,
            "tested": self.grid.tested,
            "asymmetry": self.asymmetry,
        }


class Asked(NamedTuple):
    """A table to make."""

    function: Function
    ranges: Ranges
    held: dict[str, float]
    heading: str
    left_out: Function | None = None  #: what the form cannot hold of the force

    def lost(self, grid: Grid) -> float:
        """The largest of it at the nodes, over the largest force."""
        if self.left_out is None:
            return 0.0
        return float(np.abs(self.left_out(**grid.mesh(), **grid.held)).max()) / grid.largest


def _force(tyre: tir.Tyre, channel: str, on: bool) -> Function:
    """The channel as a function of the conditions by their columns; those not given are zero."""

    def force(Fz_N: Any, alpha_deg: Any = 0.0, gamma_deg: Any = 0.0, kappa: Any = 0.0) -> Any:
        forces = tyre(Fz_N, np.radians(alpha_deg), np.radians(gamma_deg), kappa, turn_slip=on)
        return getattr(forces, channel)

    return force


def _all_slips(tyre: tir.Tyre, on: bool, inside: Ranges) -> dict[str, Asked]:
    asked = {}
    for end, axes in (("", PURE), ("_combined", dict.fromkeys(PURE, tuple(CONDITIONS)))):
        for channel, names in axes.items():
            held = {name: 0.0 for name in CONDITIONS if name not in names}
            ranges = {name: inside[name] for name in names}
            asked[channel + end] = Asked(_force(tyre, channel, on), ranges, held, column(channel))
    return asked


def _csv(folder: Path, stem: str, about: str, tables: list[LookupTable]) -> list[str]:
    names = []
    for table in tables:
        columns = {**table.grid.mesh(), table.heading: table.grid.values}
        text = csv_text(pd.DataFrame({name: np.ravel(x) for name, x in columns.items()}))
        names.append(f"{stem}-{table.name.replace('_', '-')}.csv")
        (folder / names[-1]).write_text(
            f"# {about}\n# {table.sentence}\n{text}", encoding="utf-8", newline="\n"
        )
    return names


def _mat(folder: Path, stem: str, about: str, tables: list[LookupTable]) -> list[str]:
    from scipy.io import savemat

    content = {
        table.name: {
            **{name: x[:, None] for name, x in table.grid.axes.items()},
            table.heading: table.grid.values if table.grid.values.ndim > 1 else table.grid.values[:, None],
            "error": table.grid.error,
            "about": table.sentence,
        }
        for table in tables
    }
    savemat(folder / f"{stem}.mat", {"about": about, **content}, do_compression=True)
    return [f"{stem}.mat"]


def _first_quadrant(tyre: tir.Tyre, on: bool, inside: Ranges) -> dict[str, Asked]:
    """CarSim's tables begin at zero: the odd part over slip of an upright wheel, and its camber stiffness over load."""
    if not inside["gamma_deg"][0] <= 0.0 <= inside["gamma_deg"][1]:
        raise InputError("the tables of CarSim are for an upright wheel: include 0", key="--range gamma_deg")
    asked = {}
    for keyword, (channel, slip, sign) in SLIP_IN_CARSIM.items():
        end = min(-inside[slip][0], inside[slip][1])
        if end <= 0.0:
            raise InputError("the tables of CarSim need both signs of slip", key=f"--range {slip}")
        force, ranges = _force(tyre, channel, on), {"Fz_N": inside["Fz_N"], slip: (0.0, end)}
        odd, even = _part(force, slip, sign, -1.0), _part(force, slip, sign, 1.0)
        asked[keyword] = Asked(odd, ranges, {"gamma_deg": 0.0}, column(channel), even)
    camber = float(constants.TABLE_CAMBER)
    odd = _part(_force(tyre, "Fy", on), "gamma_deg", 1.0 / camber, -1.0)

    def stiffness(Fz_N: Any) -> Any:
        return odd(Fz_N=Fz_N, gamma_deg=camber)

    asked[CAMBER_IN_CARSIM] = Asked(
        stiffness, {"Fz_N": inside["Fz_N"]}, {"alpha_deg": 0.0}, "dFy_dgamma_N_per_deg"
    )
    return asked


def _part(force: Function, name: str, sign: float, mirror: float) -> Function:
    """The part of a force that is odd (``mirror`` -1) or even (1) in a condition, times the sign."""

    def part(**at: Any) -> Any:
        return 0.5 * sign * (force(**at) + mirror * force(**{**at, name: -np.asarray(at[name])}))

    return part


def _carsim(folder: Path, stem: str, about: str, tables: list[LookupTable]) -> list[str]:
    lines = ["PARSFILE", f"! {about}"]
    for table in tables:
        load = table.grid.axes.get("Fz_N", np.array([table.held.get("Fz_N", 0.0)]))
        values = table.grid.values.reshape(len(load), -1).T
        lines.append(f"! {table.sentence}")
        if table.name == CAMBER_IN_CARSIM:
            lines.append(f"{table.name}_TABLE LINEAR")
            rows = np.column_stack([load, values[0]])
        else:
            lines.append(f"{table.name}_CARPET 2D_FROM_ZERO")
            slip = table.grid.axes[SLIP_IN_CARSIM[table.name][1]]
            # The zeros at zero slip and load are implied; the last row is repeated, so that forces stay beyond it.
            further = 2.0 * slip[-1] - slip[-2]
            rows = np.column_stack([[0.0, *slip[1:], further], np.vstack([load, values[1:], values[-1:]])])
            rows = rows[:, [0, *(1 + np.flatnonzero(load))]]
        lines += [" " + ", ".join(f"{x:.10g}" for x in row) for row in rows]
        lines.append("ENDTABLE")
    text = "\n".join([*lines, "END", ""])
    (folder / f"{stem}-carsim.par").write_text(text, encoding="ascii", errors="replace", newline="\r\n")
    return [f"{stem}-carsim.par"]


class Form(NamedTuple):
    """A kind of file."""

    asked: Callable[[tir.Tyre, bool, Ranges], dict[str, Asked]]
    write: Callable[[Path, str, str, list[LookupTable]], list[str]]
    signs: str  #: what the files say of axes and units


ISO_W = "ISO-W axes, degrees, N, Nm"
FORMS = {
    "csv": Form(_all_slips, _csv, ISO_W),
    "mat": Form(_all_slips, _mat, ISO_W),
    "carsim": Form(
        _first_quadrant,
        _carsim,
        "degrees, N, Nm, signs as in public examples of CarSim: positive for a small positive slip; not tried in CarSim",
    ),
}
"""The kinds of files by the name of their program."""
