"""Builds whose folders the tests ask: a tyre of the formula on a disc, and one that is not of the formula on a flat belt."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import pytest
import tomli_w
from brush import SLIP, Brush
from small_rigs import disc, simulated

import mffit
from mffit.results import BuildResult

EXACT = {
    f"u_{name}": 0.0
    for name in ("loadcell_offset_N", "slip_alignment_N", "camber_alignment_deg", "camber_skew_deg")
}
EXACT |= {f"u_{channel}_gain": 0.0 for channel in ("Fy", "Fz", "Mz", "alpha", "gamma")}
"""Declares the zeros and calibrations of a rig that has none of these errors."""
LOADS = (800.0, 1200.0, 1800.0, 2600.0, 3400.0)
CAMBERS = (-4.0, 0.0, 4.0)
FY_NOISE, MZ_NOISE, OFFSET = 12.0, 0.6, 15.0
"""Of a reading [N], [Nm]; of a run [N]."""


class Built(NamedTuple):
    """A build and its folder."""

    result: BuildResult
    folder: Path

    def predict(self, **columns: Any) -> pd.DataFrame:
        return mffit.predict(self.folder, pd.DataFrame(columns))


def brush(alpha: Any, gamma: Any, Fz: Any) -> tuple[np.ndarray, np.ndarray]:
    """Fy [N] and Mz [Nm], ISO-W, of a brush tyre whose friction falls with the power of the load and with sliding.

    Parabolic pressure; camber shifts the sideslip. The Magic Formula has grip linear in the load, and no kink where the
    contact begins to slide everywhere.
    """
    length = 0.06 * np.sqrt(Fz / 2000.0)  # half of the contact [m]
    slip = np.tan(alpha) + 0.05 * np.sin(gamma)
    grip = 1.5 * (Fz / 2000.0) ** -0.3 * (1.0 - 0.25 * np.tanh(np.abs(slip) / 0.08) ** 2)
    stiffness = 2.0 * 5.5e6 * length**2
    share = np.minimum(stiffness * np.abs(slip) / (3.0 * grip * Fz), 1.0)
    Fy = -np.sign(slip) * grip * Fz * (3.0 * share - 3.0 * share**2 + share**3)
    Mz = np.sign(slip) * grip * Fz * length * share * (1.0 - share) ** 3
    return Fy, Mz


def belt(
    folder: Path,
    seed: int,
    offset: float = OFFSET,
    warm: bool = False,
    cambers: tuple[float, ...] = CAMBERS,
) -> Path:
    """Sideslip sweeps of the brush tyre on a flat belt at every load and camber, each with a zero of Fy of its own.

    ``warm``: runs at higher loads are warmer, and lose 1 % of the side force per kelvin around 50 degC. Returns ``tyre.toml``.
    """
    random = np.random.default_rng(seed)
    runs = []
    for k, (load, camber) in enumerate((load, camber) for load in LOADS for camber in cambers):
        table = pd.DataFrame(
            {"alpha_deg": np.linspace(-10.0, 10.0, 25), "gamma_deg": camber, "run": f"r{k:02d}"}
        )
        Fy, Mz = brush(np.radians(table.alpha_deg), np.radians(camber), load)
        if warm:
            table["T_degC"] = 41.0 + load / 260.0 + 4.0 * np.abs(np.sin(np.arange(25)))
            Fy = Fy * (1.0 - 0.01 * (table["T_degC"] - 50.0))
        table["Fz_N"] = load
        table["Fy_N"] = Fy + offset * random.standard_normal() + FY_NOISE * random.standard_normal(25)
        table["Mz_Nm"] = Mz + MZ_NOISE * random.standard_normal(25)
        runs.append(table)
    folder.mkdir(parents=True)
    pd.concat(runs).to_csv(folder / "runs.csv", index=False)
    config = {
        "tyre": {"name": "brush", "unloaded_radius": 0.3, "nominal_load": 2000.0, "nominal_pressure": 200.0},
        "rig": {"type": "flat-track", "axes": "iso", **EXACT},
        "sweep": [{"file": "runs.csv"}],
    }
    path = folder / "tyre.toml"
    path.write_text(tomli_w.dumps(config))
    return path


def build(path: Path) -> Built:
    out = path.parent / "out"
    return Built(mffit.build(path, out, with_report=False), out)


DISC = 1.323
"""Radius of the path on the disc [m]."""


def disc_of_a_brush(
    folder: Path,
    tyre: Brush,
    other_side: tuple[str, ...] = (),
    noise: float = 6.0,
    flipped: tuple[str, ...] = (),
    conicity: float = 0.0,
) -> Path:
    """Sweeps of a symmetric brush tyre on one side of a disc, without errors of the rig; returns ``tyre.toml``.

    The sweeps ``other_side`` are run on the other side too, the sweeps ``flipped`` also with the tyre turned on its rim. The
    force of ``conicity``, over the load, then changes its sign. ``noise`` is that of the side force [N].
    """
    random, files = np.random.default_rng(5), []
    lean = np.array([5.0, 10.0, 15.0, 20.0, 30.0, 40.0])
    plan = {
        "sideslip": (np.array(SLIP, dtype=float), 0.0),
        "camber": (0.0, np.concatenate([-lean[::-1], [0.0], lean])),
    }
    plan |= {f"{way}_roll": (np.linspace(-1.0, 1.0, 5), 0.0) for way in ("forward", "backward")}
    plan |= {f"leaned_{g}": (np.array(SLIP, dtype=float), float(g)) for g in (-30, -15, 15, 30)}
    folder.mkdir(parents=True)
    runs = [*((name, 1.0, "normal") for name in plan), *((name, -1.0, "normal") for name in other_side)]
    runs += [(name, 1.0, "flipped") for name in flipped]
    for load in (1000.0, 1700.0, 2600.0):
        for name, side, mount in runs:
            angles = plan[name]
            alpha, gamma = np.broadcast_arrays(*angles)
            way = -1.0 if name == "backward_roll" else 1.0
            Fy, Mz = tyre.forces(
                *np.radians((alpha, gamma)), np.full(len(alpha), load), phi_t=-side / DISC, direction=way
            )
            Fy = Fy + conicity * load * (1.0 if mount == "normal" else -1.0)
            table = {"alpha_deg": alpha, "gamma_deg": gamma, "Fz_N": load, "p_kPa": 250.0, "V_mps": 6.0,
                     "direction": "forward" if way > 0.0 else "backward",
                     "Fy_N": Fy + noise * random.standard_normal(len(Fy)),
                     "Mz_Nm": Mz + 0.05 * noise * random.standard_normal(len(Fy)),
                     "u_Fy_N": noise, "u_Mz_Nm": 0.05 * noise}  # fmt: skip
            run = {
                "file": f"{name}_{load:.0f}_{'left' if side > 0.0 else 'right'}_{mount}.csv",
                "mount": mount,
            }
            files.append(run if side > 0.0 else run | {"path_centre": "right"})
            pd.DataFrame(table).to_csv(folder / run["file"], index=False)
    shape = {"unloaded_radius": 0.306, "width": 0.15, "rim_radius": 0.2159}
    config = {
        "tyre": {"name": "brush", "nominal_load": tyre.nominal, "nominal_pressure": 250.0, **shape},
        "rig": {
            "type": "rotating-disk", "axes": "iso", "path_centre": "left", "path_radius": DISC, "backlash_deg": 0.0,
            "u_loadcell_offset_N": 10.0, "u_camber_alignment_deg": 0.5, "u_slip_alignment_N": 25.0,
        },
        "rolling_radius": {"load_N": tyre.nominal, "effective_radius": tyre.r_e, "u_effective_radius": 0.0005},
        "sweep": files,
    }  # fmt: skip
    path = folder / "tyre.toml"
    path.write_text(tomli_w.dumps(config))
    return path


@pytest.fixture(scope="session")
def of_formula(tmp_path_factory) -> Built:
    """The virtual rig's tyre, of the Magic Formula, on a disc."""
    folder = tmp_path_factory.mktemp("formula") / "tyre"
    simulated(disc(), folder)
    return build(folder / "tyre.toml")


@pytest.fixture(scope="session")
def in_sae(tmp_path_factory) -> Built:
    """The same campaign, reported in SAE axes."""
    folder = tmp_path_factory.mktemp("sae") / "tyre"
    simulated(disc(rig={"path_radius": 1.323, "u_path_radius": 0.0018, "axes": "sae"}), folder)
    return build(folder / "tyre.toml")


@pytest.fixture(scope="session")
def foreign(tmp_path_factory) -> Built:
    """The brush tyre on a flat belt."""
    return build(belt(tmp_path_factory.mktemp("foreign") / "tyre", seed=6))


@pytest.fixture(scope="session")
def warming(tmp_path_factory) -> Built:
    """The brush tyre, which loses side force with warmth."""
    return build(belt(tmp_path_factory.mktemp("warm") / "tyre", seed=6, warm=True))


@pytest.fixture(scope="session")
def straight(tmp_path_factory) -> Built:
    """The virtual rig's tyre, with the file for turn slip off as the plain one."""
    folder = tmp_path_factory.mktemp("straight") / "tyre"
    simulated(disc(spin={"exact": "normal"}), folder)
    return build(folder / "tyre.toml")
