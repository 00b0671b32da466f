"""Recovery of known truth over many simulated rigs; tests/studies/recovery_study.py runs it.

Every rig has its own load-cell offset, misalignments, radii and noise, drawn from the uncertainties that it declares.
Counted is how often the 95 % interval (1.96 standard errors) holds the truth.
"""

from __future__ import annotations

import tempfile
import tomllib
from pathlib import Path
from typing import Any

import numpy as np

import mffit
import tir
from mffit import virtual_rig

SAMPLE = Path(__file__).parents[3] / "samples" / "front-120-70"
COEFFICIENTS = [
    "PCY1",
    "PDY1",
    "PDY2",
    "PKY1",
    "PKY2",
    "PKY6",
    "PPY1",
    "PPY3",
    "QBZ1",
    "QDZ1",
    "QDZ2",
    "QDZ8",
    "QDTP1",
]


def plan_content(exact: str = "turn-slip", pecp1: str = "model") -> dict[str, Any]:
    """The sample's campaign with drawn faults, and without its recorded sweep."""
    content = tomllib.loads((SAMPLE / "rig.toml").read_text(encoding="utf-8"))
    content["faults"] = {"draw": True}
    for sweep in content["sweep"]:
        sweep.pop("recording", None)
    content["spin"] = {"exact": exact, "pecp1": pecp1}
    return content


def one_rig(seed: int) -> dict[str, float]:
    """Build one drawn rig; deviations from the truth in standard errors, and errors of the model in newtons."""
    plan = virtual_rig.load_plan(plan_content(), folder=SAMPLE)
    with tempfile.TemporaryDirectory() as folder:
        truth = virtual_rig.simulate(plan, folder, seed=seed)
        result = mffit.build(Path(folder) / "tyre.toml")
    known = truth.to_json()
    true, fitted = tir.read(SAMPLE / "true.tir"), result.fit.tyre
    out = {
        "eps_gamma": _pull(result.measured.epsilon_gamma, known["epsilon_gamma"]),
        "C_phit": _pull(result.measured.C_phit, known["C_phit_secant_Nm"]),
        "error of eps_gamma": result.measured.epsilon_gamma.value - known["epsilon_gamma"],
        "error of PECP1": fitted["PECP1"] - true["PECP1"],
    }
    for name in COEFFICIENTS:
        found = result.fit.coefficients[name]
        if found.stderr:
            out[name] = (found.value - true[name]) / found.stderr
    for place, phi_t in (("disc", -1.0 / 1.323), ("straight", 0.0)):
        Fy, Mz = model_error(fitted, true, phi_t, np.unique(np.round(result.points.Fz, -2)))
        out[f"Fy rms on {place} [N]"], out[f"Mz rms on {place} [Nm]"] = Fy, Mz
    return out


def model_error(
    model: tir.Tyre, true: tir.Tyre, phi_t: float, loads: np.ndarray, pressure: float = 250e3
) -> tuple[float, float]:
    """Rms difference of Fy [N] and Mz [Nm] from the noise-free truth, between the measured conditions."""
    alpha = np.radians(np.concatenate([np.linspace(-7.5, 7.5, 31), np.linspace(-7.5, 7.5, 31), np.zeros(19)]))
    gamma = np.radians(np.concatenate([np.zeros(31), np.full(31, 15.0), np.linspace(-45.0, 45.0, 19)]))
    Fz = loads[:, None] * 1.03
    a, b = (tyre(Fz, alpha, gamma, phi_t=phi_t, Vx=6.0, p=pressure) for tyre in (model, true))
    return float(np.sqrt(np.mean((a.Fy - b.Fy) ** 2))), float(np.sqrt(np.mean((a.Mz - b.Mz) ** 2)))


def _pull(quantity: Any, truth: float) -> float:
    return (quantity.value - truth) / quantity.u


def report(rigs: int) -> str:
    """Run the study and write its table."""
    rows = [one_rig(seed) for seed in range(rigs)]
    lines = [
        f"{rigs} rigs",
        "",
        "| quantity | 95 % interval holds the truth | mean pull | sd of pull |",
        "|---|---|---|---|",
    ]
    errors = []
    for name in rows[0]:
        x = np.array([row[name] for row in rows if name in row])
        if "error" in name or "rms" in name:
            errors.append(f"| {name} | {np.mean(x):+.3f} | {np.std(x):.3f} | {np.max(np.abs(x)):.3f} |")
        else:
            inside = 100.0 * np.mean(np.abs(x) < 1.96)
            lines.append(f"| {name} | {inside:.0f} % | {np.mean(x):+.2f} | {np.std(x):.2f} |")
    return "\n".join([*lines, "", "| error | mean | sd | largest |", "|---|---|---|---|", *errors])
