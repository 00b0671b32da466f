"""Does the joint estimate of all tyres of a rig reduce the error of each eps_gamma? `python tests/studies/fleet_study.py`.

Each rig has its own load-cell offset, misalignments and path radius, drawn from their declared uncertainties and common to
its tyres. Each tyre is that of a sample with all fitted coefficients up to a tenth off and an eps_gamma of its own, built with
default settings. Prints error and coverage of eps_gamma before and after; docs/fleet.md has the table.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "mffit" / "fit"))

import json
from dataclasses import dataclass, field
from typing import Any

from drawn_rigs import NO_FORCE_AT_REST, SAFE, SAMPLES, STAGED, model_error, plan_content

import mffit
import tir
from mffit import fleet, pipeline, virtual_rig
from mffit.scatter import rms

EPSILON_OFF = 0.08
"""Standard deviation of eps_gamma between tyres."""
SHARED = ("alpha_0_deg", "gamma_0_deg", "F0_N", "backlash_deg", "path_radius_m")
ESTIMATES = ("direct method", "joint estimate of each build", "joint estimate of the fleet")


@dataclass
class Rig:
    """Errors of the estimates for one rig."""

    epsilon: list[list[tuple[float, float]]] = field(default_factory=list)  #: tyre, estimate: (error, u)
    pulls: dict[str, float] = field(default_factory=dict)  #: of its own errors, (found - true) / u
    later: dict[str, list[tuple[float, float]]] = field(
        default_factory=lambda: {"base file": [], "fleet": []}
    )  #: of thin campaigns: error of PECP1 and rms error of Fy on the disc [N]


def drawn_tyre(sample: str, rng: np.random.Generator) -> tir.Tyre:
    true = tir.read(SAMPLES / sample / "true.tir").replace(**NO_FORCE_AT_REST)
    off: dict = {n: float(true[n] * (1.0 + 0.1 * rng.uniform(-1.0, 1.0))) for n in STAGED}
    return true.replace(**off | {"PECP1": float(true["PECP1"] + EPSILON_OFF * rng.standard_normal())})


def campaign(folder: Path, true: tir.Tyre, sample: str, faults: dict[str, Any], seed: int, **how: Any) -> Any:
    """Simulate one tyre into the project ``folder/rig``; returns the truth."""
    folder.mkdir()
    true.write(folder / "drawn.tir")
    tir.read(SAMPLES / sample / "base.tir").replace(**NO_FORCE_AT_REST).write(folder / "base.tir")
    content = plan_content(SAMPLES / sample, **how)
    content["truth"] = {"tyre": "drawn.tir"}
    content["tyre"]["base"] = "base.tir"
    content["faults"] = {"draw": True, **faults}
    return virtual_rig.simulate(virtual_rig.load_plan(content, folder=folder), folder / "rig", seed=seed)


def one_rig(seed: int, tyres: int, sample: str, later: int) -> Rig:
    """Estimates for a rig with its tyres, and for ``later`` tyres in thin campaigns with and without the fleet's priors."""
    rng = np.random.default_rng(5000 + seed)
    out, faults, known = Rig(), {}, []
    with tempfile.TemporaryDirectory() as made:
        for k in range(tyres):
            folder, true = Path(made) / str(k), drawn_tyre(sample, rng)
            truth = campaign(folder, true, sample, faults, 1000 * seed + k, pecp1="direct")
            faults = faults or {n: getattr(truth.faults, n) for n in SHARED}
            result = mffit.build(folder / "rig" / "tyre.toml")
            direct = result.measured.epsilon_gamma
            out.epsilon.append([(direct.value - truth.nominal.epsilon_gamma, direct.u)])
            known.append((fleet.information(result.fit.search), true["PECP1"]))
            print(".", end="", file=sys.stderr, flush=True)
        together = fleet.estimate([found for found, _ in known])
        for k, (found, eps) in enumerate(known):
            for estimate in (fleet.estimate([found]).tyres[0], together.tyres[k]):
                value, u = estimate.number("PECP1")
                out.epsilon[k].append((value - eps, u))
        out.pulls = {n: (v - faults[n]) / u for n, (v, u) in together.rig.items() if n in faults}
        priors = Path(made) / "priors.json"
        priors.write_text(json.dumps(pipeline.fleets.priors_of_rig(together, result.fit.tyre, tyres)))
        for k in range(later):
            folder, true = Path(made) / f"later {k}", drawn_tyre(sample, rng)
            campaign(folder, true, sample, faults, 1000 * seed + 500 + k, pecp1="model", thin=True)
            toml = folder / "rig" / "tyre.toml"
            for name, text in (("base file", ""), ("fleet", f'[tyre]\npriors = "{priors}"\n')):
                toml.write_text(toml.read_text().replace("[tyre]\n", text) if text else toml.read_text())
                found = mffit.build(toml)
                Fy, _ = model_error(
                    found.fit.tyre, true, -1.0 / 1.323, np.unique(np.round(found.points.Fz, -2))
                )
                out.later[name].append((found.fit.tyre["PECP1"] - true["PECP1"], Fy))
                print(",", end="", file=sys.stderr, flush=True)
    return out


def main() -> None:
    ask = argparse.ArgumentParser()
    ask.add_argument("--tyres", type=int, default=12)
    ask.add_argument("--rigs", type=int, default=1)
    ask.add_argument("--first", type=int, default=0)
    ask.add_argument("--later", type=int, default=3)
    ask.add_argument("--sample", default="front-120-70")
    given = ask.parse_args()
    rigs = [
        one_rig(seed, given.tyres, given.sample, given.later)
        for seed in range(given.first, given.first + given.rigs)
    ]
    errors = np.array([row for rig in rigs for row in rig.epsilon])
    print(f"\n{given.rigs} rigs with {given.tyres} tyres of the kind {given.sample}\n")
    print("| eps_gamma | error rms | largest | mean u | inside 95 % |\n|---|---|---|---|---|")
    for k, name in enumerate(ESTIMATES):
        e, u = errors[:, k, 0], errors[:, k, 1]
        inside = np.mean(np.abs(e) < SAFE * u)
        print(f"| {name} | {rms(e):.4f} | {np.max(np.abs(e)):.4f} | {np.mean(u):.4f} | {inside:.0%} |")
    print("\nrig errors of the fleet, (found - true) / u:")
    for rig in rigs:
        print("  " + ", ".join(f"{name} {pull:+.2f}" for name, pull in rig.pulls.items()))
    if given.later:
        print(
            "\n| later build, thin campaign, with priors of | PECP1 error rms | Fy error rms on the disc [N] |\n|---|---|---|"
        )
        for name in ("base file", "fleet"):
            x = np.array([row for rig in rigs for row in rig.later[name]])
            print(f"| {name} | {rms(x[:, 0]):.4f} | {rms(x[:, 1]):.1f} |")


if __name__ == "__main__":
    main()
