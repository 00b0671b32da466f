"""Campaigns of the virtual rig with drive, brake, combined slip and Mx, each with one hidden effect.

A hidden effect of the tyre is a change of the true tyre, one of the rig a fault of the virtual rig; the model that a diagnosis
is given lacks it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

import mffit
import tir
from mffit import virtual_rig
from mffit.diagnosis import Diagnosis

SAMPLE = Path(__file__).parents[3] / "samples" / "flat-track-combined"
SLIP = [-0.2, -0.12, -0.08, -0.05, -0.03, -0.015, 0, 0.015, 0.03, 0.05, 0.08, 0.12, 0.2]
SIDESLIP = [-10, -6, -4, -2.5, -1.5, -0.5, 0.5, 1.5, 2.5, 4, 6, 10]
STEERED = [-6, -2, 2, 6]
NOISE = {"Fx_N": 15.0, "Fy_N": 12.0, "Mx_Nm": 6.0, "Mz_Nm": 1.5, "My_Nm": 0.8}
SIZES = {"large": 1.0, "medium": 0.4, "small": 0.2}
SPREAD = 0.1
"""Standard deviation of the factors by which the sample's tyre is varied."""


@dataclass(frozen=True)
class Hidden:
    """One hidden effect at its large size."""

    tyre: Mapping[str, float] = field(default_factory=dict)  #: added to coefficients
    factor: Mapping[str, float] = field(default_factory=dict)  #: relative change of coefficients
    faults: Mapping[str, float] = field(default_factory=dict)  #: added to those of a perfect rig
    sweeps: Sequence[Mapping[str, Any]] = ()  #: without which it does not show


HIDDEN = {
    "loadcell-gain-fx": Hidden(faults={"gain_Fx": 0.04}),
    "crosstalk-fx-mz": Hidden(faults={"crosstalk_Fx_Mz_m": 0.004}),
    "crosstalk-fy-mx": Hidden(faults={"crosstalk_Fy_Mx_m": 0.006}),
    "slip-zero": Hidden(faults={"kappa_0": 0.003}),
    "loadcell-offset-fx": Hidden(faults={"Fx0_N": 60.0}),
    "loadcell-offset-mx": Hidden(faults={"Mx0_Nm": 60.0}),
    "longitudinal-drag": Hidden(faults={"drag_Fx_N": 60.0}),
    "longitudinal-grip": Hidden(factor={"PDX1": 0.1}),
    "longitudinal-grip-load": Hidden(tyre={"PDX2": 0.1}),
    "slip-stiffness": Hidden(factor={"PKX1": 0.15}),
    "slip-shift": Hidden(tyre={"PHX1": 0.003}),
    "rolling-force": Hidden(tyre={"PVX1": 0.01}),
    "combined-longitudinal": Hidden(factor={"RBX1": 0.25}),
    "combined-lateral": Hidden(factor={"RBY1": 0.25}),
    "combined-camber": Hidden(tyre={"RBX3": 60.0, "RBY4": 60.0}),
    "longitudinal-arm": Hidden(tyre={"SSZ1": 0.015}),
    "overturning-offset": Hidden(tyre={"QSX1": 0.02}),
    "overturning-camber": Hidden(tyre={"QSX2": 0.3}),
    "overturning-side-force": Hidden(tyre={"QSX3": 0.025}),
    "overturning-arm": Hidden(tyre={"QSX13": 0.02}),
    "crosstalk-fx-mx": Hidden(faults={"crosstalk_Fx_Mx_m": 0.006}),
    "overturning-pressure": Hidden(
        faults={"k_p_arm_per_kPa": 0.02},
        sweeps=[
            {"file": f"p_{p}.csv", "load_N": 4200, "alpha_deg": SIDESLIP, "p_kPa": p} for p in (200, 280)
        ],
    ),
}


def sweeps() -> list[dict[str, Any]]:
    """Sideslip, drive and brake, and both together at three loads and two cambers; one run backwards."""
    out: list[dict[str, Any]] = []
    for load in (2000, 4200, 6500):
        out += [
            {"file": f"sideslip_{load}.csv", "load_N": load, "alpha_deg": SIDESLIP, "gamma_deg": [0, 4]},
            {"file": f"drive_{load}.csv", "load_N": load, "kappa": SLIP, "gamma_deg": [0, 4]},
            {"file": f"combined_{load}.csv", "load_N": load, "kappa": SLIP, "alpha_deg": STEERED},
        ]
    leaned = {"file": "leaned.csv", "load_N": 4200, "kappa": SLIP, "alpha_deg": STEERED, "gamma_deg": [-6, 6]}
    return [*out, leaned]


def backwards() -> list[dict[str, Any]]:
    """Drive and brake in the other direction."""
    return [{"file": "backward.csv", "load_N": 4200, "kappa": SLIP, "direction": "backward"}]


def diagnosed(
    effect: str | Hidden, size: float, seed: int, folder: Path, *, added: Sequence[dict[str, Any]] = ()
) -> Diagnosis:
    """The diagnosis of a simulated campaign, with the tyre without its hidden effect as model."""
    simulated(effect, size, seed, folder, added=added)
    return mffit.diagnose(folder / "rig" / "tyre.toml", folder / "given.tir")


def simulated(
    effect: str | Hidden,
    size: float,
    seed: int,
    folder: Path,
    *,
    added: Sequence[dict[str, Any]] = (),
    noise: Mapping[str, float] = NOISE,
) -> tir.Tyre:
    """Write a campaign with a hidden effect of either sign on a drawn tyre; returns the tyre without the effect."""
    random = np.random.default_rng(seed)
    sample = tir.read(SAMPLE / "true.tir")
    varied = ("PDX1", "PKX1", "PDY1", "PKY1", "PEX1", "RBX1", "RBY1", "QDZ1", "PDX2", "PDY2", "PKY2", "QSX3")
    given = sample.replace(
        **{n: float(sample[n]) * (1.0 + SPREAD * random.standard_normal()) for n in varied}
    )
    hidden = HIDDEN.get(effect, Hidden()) if isinstance(effect, str) else effect
    sign = random.choice([-1.0, 1.0]) * size
    true = given.replace(
        **{n: float(given[n]) + sign * x for n, x in hidden.tyre.items()},
        **{n: float(given[n]) * (1.0 + sign * x) for n, x in hidden.factor.items()},
    )
    folder.mkdir(parents=True, exist_ok=True)
    true.write(folder / "drawn.tir")
    given.write(folder / "given.tir")
    neutral = {n: float(n == "gain_Fx") for n in hidden.faults}
    content = {
        "truth": {"tyre": "drawn.tir"},
        "faults": {n: neutral[n] + sign * x for n, x in hidden.faults.items()},
        "noise": dict(noise),
        "conditions": {"V_mps": 16.7},
        "tyre": {"name": "drawn", "unloaded_radius": 0.3185, "nominal_load": 4200, "nominal_pressure": 240},
        "rig": {"type": "flat-track"},
        "sweep": [*sweeps(), *hidden.sweeps, *added],
    }
    virtual_rig.simulate(virtual_rig.load_plan(content, folder=folder), folder / "rig", seed=seed)
    return given
