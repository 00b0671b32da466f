"""The forms of lookup tables: what each holds of a tyre, and how its files are written (CSV, MATLAB)."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from mffit.csv_tables import csv_text
from mffit.export.grid import Grid


@dataclass(frozen=True, slots=True)
class LookupTable:
    """Values of a channel on a grid of conditions."""

    name: str  #: of the file or variable: ``Fy``, ``Fy_combined``
    heading: str  #: of the values, with their unit: ``Fy_N``
    grid: Grid  #: in degrees, N, Nm
    held: Mapping[str, float]  #: the other conditions that tables can have as axes
    slope: tuple[float, float] | None
    """Largest relative error found of the slope at zero slip, and its load [N]."""

    @property
    def sentence(self) -> str:
        """Size and error in words."""
        axes, error = self.grid.axes, self.grid.error
        return (
            f"{self.name}: {' x '.join(str(len(x)) for x in axes.values())} nodes of {', '.join(axes)}"
            f"{''.join(f'; {name} = {value:g}' for name, value in self.held.items())}; linear interpolation misses "
            f"{100.0 * error:.2f} % of the largest {self.heading} {self.grid.largest:.4g}, the largest found at "
            f"{self.grid.tested} conditions off the nodes{self._of_slope()}"
        )

    def _of_slope(self) -> str:
        """The error of the slope in words."""
        if self.slope is None:
            return ""
        off, load = self.slope
        return f"; its slope at zero slip is off by up to {100.0 * off:.1f} %, at {load:.0f} N"

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
            "slope_error": self.slope and self.slope[0],
            "slope_error_at_N": self.slope and self.slope[1],
        }


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


FORMS: Mapping[str, Callable[[Path, str, str, list[LookupTable]], list[str]]] = {"csv": _csv, "mat": _mat}
"""Writers of the kinds of files: folder, stem, title and tables; give the names of the files."""
