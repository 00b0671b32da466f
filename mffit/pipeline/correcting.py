"""The readings corrected for the rig errors that a diagnosis found, as files that build."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import tomli_w

from mffit.config import Config, axis_signs, path_curvature, resolved
from mffit.csv_tables import write_csv
from mffit.diagnosis import Diagnosis, corrected_points
from mffit.points import Points
from mffit.quantities import column, u_column
from mffit.rig.lag import lagged_setting

CORRECTED_TOML, CORRECTED_POINTS = "corrected.toml", "points-corrected.csv"
FLIPPED_POINTS = "points-corrected-flipped.csv"
ABOUT = (
    "# The readings that a rig without errors would have given at reference conditions: corrected for the rig and environment\n"
    "# effects of a diagnosis and for the declared backlash. Build it with: mffit build {name}\n\n"
)


def write_corrected(diagnosis: Diagnosis, config: Config, out: Path, folder: Path) -> None:
    """Write the corrected points and a ``tyre.toml`` that builds from them to a temporary ``folder``, to be moved to ``out``."""
    points = _corrected(diagnosis, config)
    not_always = (*(name for name in diagnosis.noise.channels if name != "Fy"), "T", "t")
    sweeps: list[dict[str, Any]] = []
    for name, part in _files(points, not_always):
        write_csv(corrected_table(part, diagnosis, axis_signs(config)), folder / name)
        sweeps.append({"file": name, **_conditions(part, config)})
    content = resolved(config, out)
    content["sweep"] = sweeps
    content.get("fit", {}).pop("exclude", None)  # these points are not in the corrected files
    content["rig"] |= {"backlash_deg": 0.0, "force_frame": "W", "moments": "contact"}
    text = ABOUT.format(name=CORRECTED_TOML) + tomli_w.dumps(content)
    (folder / CORRECTED_TOML).write_text(text, encoding="utf-8", newline="\n")


def corrected_table(
    points: Points, diagnosis: Diagnosis, signs: Mapping[str, float] | None = None
) -> pd.DataFrame:
    """Corrected points with the headings of sweep files in the axes of the first rig or with ``signs``, a row per point."""
    sign = signs or diagnosis.signs
    channels = [name for name in diagnosis.noise.channels if np.any(np.isfinite(points.channel(name)))]
    columns = {
        "run": np.array(points.sweep_names, dtype=object)[points.sweep],
        "alpha_deg": sign["alpha"] * np.degrees(points.alpha),
        "gamma_deg": sign["gamma"] * np.degrees(points.gamma),
        "Fz_N": points.Fz,
        "p_kPa": 1e-3 * points.p,
        "V_mps": points.V,
        "direction": np.where(points.direction > 0, "forward", "backward"),
        "T_degC": points.T,
        "t_s": points.t,
        **({"kappa": points.kappa} if np.any(points.kappa) else {}),
        **{column(name): sign.get(name, 1.0) * points.channel(name) for name in channels},
        **{u_column(name): points.u(name) for name in channels},
    }
    known = {n: c for n, c in columns.items() if c.dtype.kind not in "f" or np.isfinite(c).any()}
    return pd.DataFrame(known).replace([np.inf, -np.inf], np.nan)


def _conditions(points: Points, config: Config) -> dict[str, Any]:
    """What [[sweep]] states of the points of one file: mount, path and set-up."""
    phi_t, setup = float(points.phi_t[0]), points.setups[points.setup[0]]
    out: dict[str, Any] = {"mount": "normal" if points.mount[0] > 0 else "flipped"}
    if phi_t != path_curvature(config.rig):
        out |= {"path_centre": "left" if phi_t < 0.0 else "right", "path_radius": abs(1.0 / phi_t)}
    return out | ({"setup": setup} if setup else {})


def _files(points: Points, not_always: Sequence[str]) -> Iterator[tuple[str, Points]]:
    """Name and points of each file: one mount, path and set-up, and the same channels in every row.

    ``not_always`` are channels that only some sweeps may have.
    """
    for mount, name in ((1, CORRECTED_POINTS), (-1, FLIPPED_POINTS)):
        channels = np.column_stack(
            [*(np.isfinite(getattr(points, name)) for name in not_always), -points.setup, points.phi_t]
        )
        kinds = np.unique(channels[points.mount == mount], axis=0)[::-1]
        for k, kind in enumerate(kinds, 1):
            rows = (points.mount == mount) & np.all(channels == kind, axis=1)
            yield name if k == 1 else name.replace(".csv", f"-{k}.csv"), points.select(rows)


def _corrected(diagnosis: Diagnosis, config: Config) -> Points:
    """The corrected points, steady: the angles of moving sweeps are corrected for the lag that was found."""
    points = corrected_points(diagnosis.points, diagnosis.state, diagnosis.noise.channels)
    if not np.any(points.continuous):
        return points
    if config.rig.on_disc:
        return points.select(~points.continuous)
    follows, _ = lagged_setting(points, diagnosis.state.faults["relaxation_m"])
    return points.replace(alpha=follows, continuous=False)
