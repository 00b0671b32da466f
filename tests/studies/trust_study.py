"""What does a build say of itself on sound rigs, and on rigs with a mistake? `python tests/studies/trust_study.py 40 --jobs 1`

For every world it draws rigs and tyres, front and rear in turn, with base files up to 30 % off or none, and builds. It prints how
many results are not trusted, how many are doubted, how many name the cause, and every sentence about a sound rig.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import tomllib
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import tomli_w

sys.path.insert(0, str(Path(__file__).parents[1] / "mffit" / "fit"))

from drawn_rigs import NO_FORCE_AT_REST, SAMPLES, _scaled, plan_content

import mffit
import tir
from mffit import virtual_rig
from mffit.config.radii import path_radius
from mffit.errors import InputError

Plan = dict[str, Any]


def _nothing(content: Any, folder: Path) -> None:
    """A sound rig."""


def _warmed(content: Plan, folder: Path) -> None:
    """The tyre warms up by 23 K from the first sweep to the last."""
    content["faults"] |= {"k_T_per_K": -0.004, "T_ref_degC": 36.0}
    ends = np.linspace(25.0, 48.0, len(content["sweep"]) + 1)
    for sweep, begin, end in zip(content["sweep"], ends[:-1], ends[1:], strict=True):
        sweep["T_degC"] = [float(begin), float(end)]


def _backward_camber(content: Plan, folder: Path) -> None:
    angles = [-40, -30, -20, -10, -5, 0, 5, 10, 20, 30, 40]
    load = content["tyre"]["nominal_load"]
    content["sweep"].append(
        {"file": "camber_backward.csv", "load_N": load, "gamma_deg": angles, "direction": "backward"}
    )


def _load_low(config: Plan, folder: Path) -> None:
    """The load of one sweep was 10 % lower than it reads."""
    path = sorted(folder.glob("coupled_*_20deg.csv"))[0]
    table = pd.read_csv(path)
    table["Fz_N"] *= 1.1
    table.to_csv(path, index=False)


def _diameter(config: Plan, folder: Path) -> None:
    """The path's diameter is entered as its radius, and the rolling radius is given."""
    tape = config["rig"].pop("path", None)
    config["rig"]["path_radius"] = 2.0 * (path_radius(**tape) if tape else config["rig"]["path_radius"])
    radius = 0.983 * config["tyre"]["unloaded_radius"]
    config["rolling_radius"] = [{"effective_radius": radius, "u_effective_radius": 0.0005}]


@dataclass(frozen=True)
class World:
    """What is wrong with the rigs."""

    faults: Mapping[str, float] = field(default_factory=dict)
    planned: tuple[Callable[[Plan, Path], None], ...] = ()  #: changes of the plan
    edited: tuple[Callable[[Plan, Path], None], ...] = ()  #: changes of tyre.toml and the files
    thin: bool = False
    word: str = ""  #: in a sentence that names the cause


WORLDS = {
    "sound": World(),
    "sound, backward camber": World(planned=(_backward_camber,)),
    "sound, thin": World(thin=True),
    "skew 0.5 deg": World(faults={"camber_skew_deg": 0.5}, word="square"),
    "skew 0.5 deg, backward camber": World(
        faults={"camber_skew_deg": 0.5}, planned=(_backward_camber,), word="square"
    ),
    "load falls by 6 % sin^2": World(faults={"load_camber": -0.06}, word="load that changes"),
    "warming by 23 K": World(planned=(_warmed,), word="temperature"),
    "one load 10 % low": World(edited=(_load_low,), word="looks like a load"),
    "diameter as radius": World(edited=(_diameter,), word="diameter"),
}


@dataclass(frozen=True)
class Said:
    """What one build says."""

    trusted: bool = True
    reasons: tuple[str, ...] = ()
    doubts: tuple[str, ...] = ()
    sweeps: int = 0  #: doubtful sweeps
    misfit: float = 0.0
    seconds: float = 0.0
    refused: str = ""


def one(job: tuple[int, str]) -> tuple[str, Said]:
    """Draw, simulate and build one rig."""
    seed, name = job
    world, rng = WORLDS[name], np.random.default_rng(7000 + seed)
    sample = SAMPLES / ("front-120-70", "rear-190-55")[seed % 2]
    true = _scaled(tir.read(sample / "true.tir").replace(**NO_FORCE_AT_REST), 0.1, rng)
    content = plan_content(sample, pecp1="direct", thin=world.thin)
    content["tyre"].pop("base", None)
    content["faults"] |= world.faults
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        for change in world.planned:
            change(content, folder)
        true.write(folder / "drawn.tir")
        content["truth"] = {"tyre": "drawn.tir"}
        virtual_rig.simulate(virtual_rig.load_plan(content, folder=folder), folder / "rig", seed=seed)
        path = folder / "rig" / "tyre.toml"
        config = tomllib.loads(path.read_text(encoding="utf-8"))
        if seed % 4 < 2:
            _scaled(true, 0.3, rng).write(folder / "rig" / "other.tir")
            config["tyre"]["base"] = "other.tir"
        for change in world.edited:
            change(config, folder / "rig")
        path.write_text(tomli_w.dumps(config), encoding="utf-8")
        try:
            result = mffit.build(path)
        except InputError as error:
            return name, Said(refused=str(error))
    return name, Said(
        trusted=result.trusted,
        reasons=result.reasons,
        doubts=result.trust.doubts,
        sweeps=len(result.fit.doubts),
        misfit=max(result.trust.over_noise.values()),
        seconds=result.seconds,
    )


def table(name: str, rows: list[Said]) -> list[str]:
    """Lines of one world."""
    built, n = [row for row in rows if not row.refused], len(rows)
    word = WORLDS[name].word
    named = (
        sum(any(word in s for s in (*row.reasons, *row.doubts, row.refused)) for row in rows) if word else 0
    )
    told = sum(not row.trusted or bool(row.doubts) or row.sweeps > 0 or bool(row.refused) for row in rows)
    out = [
        f"| {name} | {n} | {n - len(built)} | {sum(not r.trusted for r in built)} | {sum(bool(r.doubts) for r in built)} "
        f"| {sum(r.sweeps > 0 for r in built)} | {told / n:.0%} | {named / n:.0%} | {np.median([r.misfit for r in built]):.2f} |"
    ]
    if not word:
        out += [f"* {s}" for row in rows for s in (*row.reasons, *row.doubts, row.refused) if s]
    return out


def main() -> None:
    ask = argparse.ArgumentParser()
    ask.add_argument("rigs", type=int, nargs="?", default=40, help="per world")
    ask.add_argument("--jobs", type=int, default=1)
    ask.add_argument("--worlds", nargs="*", default=list(WORLDS))
    ask.add_argument("--each", action="store_true", help="print every build")
    given = ask.parse_args()
    jobs = [(seed, name) for name in given.worlds for seed in range(given.rigs)]
    found: dict[str, list[Said]] = {name: [] for name in given.worlds}
    print(
        "| rigs | n | refused | not trusted | doubted | doubtful sweeps | told | cause named | misfit |",
        flush=True,
    )
    with ProcessPoolExecutor(given.jobs) as pool:
        for name, row in pool.map(one, jobs):
            found[name].append(row)
            if given.each:
                print(f"{name} {len(found[name])}: {row}", flush=True)
            if len(found[name]) == given.rigs:
                print("\n".join(table(name, found[name])), flush=True)


if __name__ == "__main__":
    main()
