"""A small campaign on a disc, from a tyre model of four lines; tests may change every file.

The tyre has only the properties that reading and checking rely on: signs and rough sizes of its slopes, a camber thrust of
about 0.7 Fz tan(gamma), and a turn-slip force of a fifth of the load. It is independent of the project's model.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import tomli_w

TURN_SLIP = 0.22  # of the load
CORNERING = 13.0  # per load [1/rad]


def side_force(alpha: Any, gamma: Any, Fz: Any, *, side: float = -1.0, direction: Any = 1.0) -> Any:
    """Fy [N], ISO-W, angles in rad; ``side`` is the sign of phi_t, 0 on a flat track."""
    slip = -1.1 * np.tanh(CORNERING / 1.1 * alpha)
    return Fz * (direction * slip - 1.05 * np.sin(gamma) + side * TURN_SLIP)


def moment(alpha: Any, gamma: Any, Fz: Any, *, side: float = -1.0, direction: Any = 1.0) -> Any:
    """Mz [Nm], ISO-W: a trail that decreases with sideslip, and the moment of path curvature."""
    return Fz * (
        0.2 * alpha * np.exp(-((alpha / 0.1) ** 2)) - 0.006 * np.sin(gamma) + 0.004 * side * direction
    )


def rows(
    alpha_deg: Any,
    gamma_deg: Any,
    Fz: float = 1500.0,
    *,
    direction: int = 1,
    noise: float = 5.0,
    seed: int = 1,
    side: float = -1.0,
) -> pd.DataFrame:
    """Finished points with the columns of sweep files, ISO-W."""
    alpha_deg, gamma_deg = (a.astype(float) for a in np.broadcast_arrays(alpha_deg, gamma_deg))
    alpha, gamma = np.radians(alpha_deg), np.radians(gamma_deg)
    scatter = np.random.default_rng(seed).standard_normal((2, len(alpha)))
    return pd.DataFrame(
        {
            "alpha_deg": alpha_deg,
            "gamma_deg": gamma_deg,
            "Fz_N": Fz,
            "Fy_N": np.round(
                side_force(alpha, gamma, Fz, side=side, direction=direction) + noise * scatter[0], 2
            ),
            "Mz_Nm": np.round(
                moment(alpha, gamma, Fz, side=side, direction=direction) + noise / 10 * scatter[1], 3
            ),
            "p_kPa": 250.0,
            "V_mps": 6.0,
        }
    )


@dataclass
class Project:
    """``tyre.toml`` and its sweeps; change either, then :meth:`write`."""

    folder: Path
    config: dict[str, Any]
    tables: dict[str, pd.DataFrame] = field(default_factory=dict)

    def add(self, file: str, table: pd.DataFrame, **keys: Any) -> None:
        """Add a sweep."""
        self.tables[file] = table
        self.config["sweep"].append({"file": file, **keys})

    def keep(self, *files: str) -> None:
        """Drop all other sweeps."""
        self.tables = {name: table for name, table in self.tables.items() if name in files}
        self.config["sweep"] = [entry for entry in self.config["sweep"] if entry["file"] in files]

    def each(self, **columns: float) -> None:
        """Multiply columns of every file by factors."""
        for table in self.tables.values():
            for name, factor in columns.items():
                table[name] = table[name] * factor

    def write(self) -> Path:
        """Write all files; returns the path of ``tyre.toml``."""
        self.folder.mkdir(parents=True, exist_ok=True)
        for name, table in self.tables.items():
            table.to_csv(self.folder / name, index=False)
        path = self.folder / "tyre.toml"
        sweeps = [
            "[[sweep]]\n" + tomli_w.dumps(entry).replace("[columns", "[sweep.columns")
            for entry in self.config["sweep"]
        ]
        rest = tomli_w.dumps({name: table for name, table in self.config.items() if name != "sweep"})
        path.write_text("\n".join([rest, *sweeps]))
        return path

    def text(self, file: str) -> str:
        """The content of a written file."""
        return (self.folder / file).read_text()

    def overwrite(self, file: str, content: str | bytes) -> None:
        """Replace the content of a written file."""
        path = self.folder / file
        path.write_bytes(content if isinstance(content, bytes) else content.encode())


SIDESLIP = np.array([-8, -6, -4, -3, -2, -1, 0, 1, 2, 3, 4, 6, 8.0])
CAMBER = np.array([-50, -35, -20, -15, -10, -5, 0, 5, 10, 15, 20, 35, 50.0])
ZEROS = np.array([-0.5, 0.0, 0.0, 0.5])


def disc_project(folder: Path) -> Project:
    """Sideslip, camber and zeros both ways at two loads; ISO axes, path centre on the left."""
    config: dict[str, Any] = {
        "tyre": {
            "name": "toy",
            "unloaded_radius": 0.3,
            "nominal_load": 1500.0,
            "nominal_pressure": 250.0,
        },
        "rig": {"type": "rotating-disk", "axes": "iso", "path_centre": "left", "path_radius": 1.323},
        "rolling_radius": [{"load_N": 1500.0, "effective_radius": 0.2945, "u_effective_radius": 0.0005}],
        "sweep": [],
    }
    project = Project(folder, config)
    for k, Fz in enumerate((1000.0, 1500.0)):
        project.add(f"sideslip_{Fz:.0f}.csv", rows(SIDESLIP, 0.0, Fz, seed=4 * k))
        project.add(f"camber_{Fz:.0f}.csv", rows(0.0, CAMBER, Fz, seed=4 * k + 1))
        project.add(f"forward_{Fz:.0f}.csv", rows(ZEROS, 0.0, Fz, seed=4 * k + 2))
        project.add(
            f"backward_{Fz:.0f}.csv",
            rows(ZEROS, 0.0, Fz, direction=-1, seed=4 * k + 3),
            direction="backward",
        )
    return project
