"""Does the joint estimate of all tyres of a rig reduce the error of each eps_gamma? `python tests/studies/fleet_study.py 2`.

Each rig has its own load-cell offset, misalignments and path radius, drawn from their declared uncertainties and common to
its tyres. Each tyre is that of a sample with all fitted coefficients up to a tenth off and an eps_gamma of its own, built with
default settings. Prints error and coverage of eps_gamma before and after; docs/fleet.md has the table. ``--later`` further tyres
are built from thin campaigns with and without the priors of the fleet.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import harness
import numpy as np
from drawn_rigs import NO_FORCE_AT_REST, SAMPLES, STAGED, Draw, model_error, plan_content

import mffit
import tir
from mffit import fleet, virtual_rig
from mffit.fleet.specimen import freed
from mffit.pipeline.fleets import priors_of_rig
from mffit.scatter import rms

EPSILON_OFF = 0.08
"""Standard deviation of eps_gamma between tyres."""
SHARED = ("alpha_0_deg", "gamma_0_deg", "F0_N", "backlash_deg", "path_radius_m")
DIRECT, ALONE, TOGETHER = "direct method", "joint estimate of each build", "joint estimate of the fleet"


@dataclass
class Rig:
    """The tyres of one rig."""

    tyres: list[Draw] = field(default_factory=list)  #: eps_gamma by estimate
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


def one(job: harness.Job) -> Rig:
    """Estimates for a rig with its tyres, and for later tyres with and without the fleet's priors."""
    seed, sample, tyres = job.seed, job.given.sample, job.given.tyres
    rng = np.random.default_rng(5000 + seed)
    out, faults, known = Rig(), {}, []
    with tempfile.TemporaryDirectory() as made:
        for k in range(tyres):
            folder, true = Path(made) / str(k), drawn_tyre(sample, rng)
            truth = campaign(folder, true, sample, faults, 1000 * seed + k, pecp1="direct")
            faults = faults or {n: truth.faults[n] for n in SHARED}
            result = mffit.build(folder / "rig" / "tyre.toml", folder / "out", with_report=False)
            direct, draw = result.measured.epsilon_gamma, Draw()
            draw.note(DIRECT, direct.value, direct.u, truth.nominal.epsilon_gamma)
            out.tyres.append(draw)
            known.append((freed(fleet.read(folder / "out").numbers), true["PECP1"]))
        together = fleet.estimate([found for found, _ in known])
        for draw, (found, eps), joint in zip(out.tyres, known, together.tyres, strict=True):
            draw.note(ALONE, *fleet.estimate([found]).tyres[0].number("PECP1"), eps)
            draw.note(TOGETHER, *joint.number("PECP1"), eps)
        out.pulls = {n: (v - faults[n]) / u for n, (v, u) in together.rig.items() if n in faults}
        priors = Path(made) / "priors.json"
        conditions = result.fit.tyre["FNOMIN"], result.fit.tyre["NOMPRES"]
        priors.write_text(json.dumps(priors_of_rig(together, conditions, tyres)))
        for k in range(job.given.later):
            folder, true = Path(made) / f"later {k}", drawn_tyre(sample, rng)
            campaign(folder, true, sample, faults, 1000 * seed + 500 + k, pecp1="model", thin=True)
            toml = folder / "rig" / "tyre.toml"
            for name, text in (("base file", "[tyre]\n"), ("fleet", f'[tyre]\npriors = "{priors}"\n')):
                toml.write_text(toml.read_text().replace("[tyre]\n", text))
                found = mffit.build(toml, with_report=False)
                loads = np.unique(np.round(found.points.Fz, -2))
                Fy, _ = model_error(found.fit.tyre, true, -1.0 / 1.323, loads)
                out.later[name].append((found.fit.tyre["PECP1"] - true["PECP1"], Fy))
    return out


def page(_: Any, rigs: list[Rig]) -> Iterator[str]:
    yield f"{len(rigs)} rigs with {len(rigs[0].tyres)} tyres each: eps_gamma by estimate"
    draws = [draw for rig in rigs for draw in rig.tyres]
    yield from harness.coverage(draws)
    worst = {name: max(abs(d.pulls[name]) * d.stderr[name] for d in draws) for name in draws[0].pulls}
    yield "\nlargest errors: " + ", ".join(f"{name} {error:.4f}" for name, error in worst.items())
    yield "\nrig errors of the fleet, (found - true) / u:"
    yield from ("  " + ", ".join(f"{name} {pull:+.2f}" for name, pull in rig.pulls.items()) for rig in rigs)
    if rigs[0].later["fleet"]:
        x = {name: np.array([row for rig in rigs for row in rig.later[name]]) for name in rigs[0].later}
        head = (
            "later build, thin campaign, with priors of",
            "PECP1 error rms",
            "Fy error rms on the disc [N]",
        )
        yield from harness.table(
            head, ((n, f"{rms(e[:, 0]):.4f}", f"{rms(e[:, 1]):.1f}") for n, e in x.items())
        )


if __name__ == "__main__":
    harness.study(one, page, draws=1, tyres=12, later=3, sample="front-120-70")
