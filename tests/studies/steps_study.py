"""Do steps of sideslip and of slip give the relaxation lengths? `nice python tests/studies/steps_study.py 200`.

Draws tyres around a car's and a motorcycle's file with other carcasses, and recordings of steps with other noise, correlation of
the noise, sampling rate, speed, loads and pressures. ``--whole 40`` builds whole campaigns with sweeps and steps from a cold
start instead. Prints the tables of docs/recovery.md.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "mffit" / "fit"))

from drawn_rigs import SAFE, on_disk, scaled
from recovery_study import coverage
from slip_study import RIGHT, SPEED, UNSETTLED, VEHICLES, Kind, SlipDraw, Vehicle, sweeps

import mffit
import tir
from mffit import config as configuration
from mffit.fit.posterior import Posterior
from mffit.fit.relaxation import DIRECTIONS, Relaxation, relaxation
from mffit.points.loading import read
from mffit.rig import Simulation
from mffit.scatter import rms

NONE_KNOWN = Posterior((), np.zeros((0, 0)))
STEPPED = {"alpha": ("alpha_deg", (0, 1, 0, -1, 0)), "kappa": ("kappa", (0, 0.025, 0, -0.025, 0))}


@dataclass
class StepsDraw(SlipDraw):
    """A draw with the relaxation lengths of its runs."""

    lengths: list[tuple[str, float, float, float, int]] = field(default_factory=list)
    """Length, u and truth [m] of every run, with its direction and the samples per second."""
    unclear: int = 0  #: runs that gave no length


def drawn_tyre(vehicle: Vehicle, rng: np.random.Generator, off: float) -> tir.Tyre:
    """A tyre with another carcass in both directions."""
    tyre = scaled(tir.read(vehicle.true).replace(**UNSETTLED, LONGVL=SPEED), off, rng)
    carcass = {}
    for direction in DIRECTIONS:
        nominal, *terms = direction.names
        carcass[nominal] = tyre[nominal] * 1.6 ** rng.uniform(-1.0, 1.0)
        carcass |= dict(zip(terms, rng.normal(0.0, (0.15, 0.08, 0.3)).tolist(), strict=True))
    return tyre.replace(**carcass)


def step_runs(vehicle: Vehicle, rng: np.random.Generator) -> list[dict[str, Any]]:
    """Runs of steps in both directions, at one to three loads and one or two pressures."""
    loads = [vehicle.at(s) for s in ((1.0,), (0.5, 1.5), (0.5, 1.0, 1.5))[rng.integers(3)]]
    nominal = vehicle.tyre["nominal_pressure"]
    conditions = [(load, nominal) for load in loads]
    if rng.random() < 0.5:
        conditions.append((loads[-1], nominal - 40.0))
    rate, V = float(rng.choice([10, 20, 50, 100])), float(rng.choice([0.5, 1.0, 2.0]))
    share = vehicle.noise["Fy_N"] / 12.0
    recording = {
        "rate_Hz": rate, "hold_s": 6.0 / min(V, 1.0), "steering_deg_per_s": 50.0, "slip_per_s": 0.4,
        "correlation_s": float(rng.choice([0.0, 0.1, 0.4, 0.8])),
        "noise_Fx_N": share * 15.0 * 2.0 ** rng.uniform(-1.0, 1.0),
        "noise_Fy_N": share * 15.0 * 2.0 ** rng.uniform(-1.0, 1.0),
        "ripple_Fy_N": share * rng.uniform(0.0, 5.0),
    }  # fmt: skip
    return [
        {
            "file": f"steps_{setting}_{load:.0f}N_{p:.0f}kPa.csv", "load_N": load, "p_kPa": p, "V_mps": V,
            key: list(values), "recording": recording,
        }
        for setting, (key, values) in STEPPED.items()
        for load, p in conditions
    ]  # fmt: skip


def content_of(kind: Kind, runs: list[dict[str, Any]], noise: dict[str, float]) -> dict[str, Any]:
    """The campaign as a ``rig.toml``."""
    return {
        "faults": {"draw": True, **RIGHT},
        "noise": noise,
        "conditions": {"V_mps": SPEED},
        "tyre": {"name": "drawn", "nominal_speed": SPEED, "side": "left", **kind.vehicle.tyre},
        "rig": {"type": "flat-track", "axes": "sae"},
        "sweep": runs,
    }


def one(seed: int, whole: bool) -> StepsDraw:
    """Draw and simulate the steps, and fit them with the rest of the tyre known, or from a whole campaign."""
    rng = np.random.default_rng(17000 + seed)
    word = list(VEHICLES)[seed % 2]
    kind = Kind(VEHICLES[word], thin=seed % 4 < 2)
    true = drawn_tyre(kind.vehicle, rng, 0.12)
    draw = StepsDraw(kind=f"{word}, {'thin' if kind.thin else 'full'}", seed=seed)
    runs = step_runs(kind.vehicle, rng)
    noise = {key: float(x * 2.0 ** rng.uniform(-1.0, 1.0)) for key, x in kind.vehicle.noise.items()}
    content = content_of(kind, (sweeps(kind) if whole else []) + runs, noise)
    with on_disk(true, content, seed) as (path, _):
        if whole:
            result = mffit.build(path)
            draw.seconds, found = result.fit.seconds, result.fit.relaxation
            names = [name for direction in DIRECTIONS for name in direction.names]
            draw.note_coefficients(result.fit, true, names)
        else:
            start = true.replace(**{one.names[0]: 2.0 * true[one.names[0]] for one in DIRECTIONS})
            start = start.replace(**{name: 0.0 for one in DIRECTIONS for name in one.names[1:]})
            steps = read(configuration.load(path)).steps
            found = relaxation(steps, Simulation.of(start, turn_slip=False), NONE_KNOWN)
            for direction in found:
                for name, q in direction.found.items():
                    draw.note(name, q.value, q.u, true[name])
    _note_lengths(draw, found, true, runs)
    return draw


def _note_lengths(
    draw: StepsDraw, found: Sequence[Relaxation], true: tir.Tyre, runs: list[dict[str, Any]]
) -> None:
    for direction in found:
        for run in direction.runs:
            truth = float(getattr(true.state(run.load, p=run.pressure), direction.direction.sigma))
            rate = round(runs[0]["recording"]["rate_Hz"])
            draw.lengths.append((direction.direction.sigma, *run.length[:2], truth, rate))
    draw.unclear = len(runs) - len(draw.lengths)


def tables(draws: Sequence[StepsDraw]) -> Iterable[str]:
    """Lines of all tables."""
    yield "| length | runs | inside 95 % | rms error [mm] | rms u [mm] | mean pull | sd of pull |"
    yield "|---" * 7 + "|"
    rows = [(row, draw) for draw in draws for row in draw.lengths]
    groups = {
        "sigma_y": lambda r, d: r[0] == "sigma_y",
        "sigma_x": lambda r, d: r[0] == "sigma_x",
        **{f"{v}": lambda r, d, v=v: d.kind.startswith(v) for v in VEHICLES},
        **{f"{k} Hz": lambda r, d, k=k: r[4] == k for k in (10, 20, 50, 100)},
    }
    for word, belongs in groups.items():
        some = np.array([row[1:4] for row, draw in rows if belongs(row, draw)])
        if not len(some):
            continue
        error = some[:, 0] - some[:, 2]
        pull = error / some[:, 1]
        yield (
            f"| {word} | {len(some)} | {np.mean(np.abs(pull) < SAFE):.0%} | {1e3 * rms(error):.1f} | {1e3 * rms(some[:, 1]):.1f} "
            f"| {np.mean(pull):+.2f} | {np.std(pull):.2f} |"
        )
    for word in dict.fromkeys(d.kind for d in draws):
        some = [d for d in draws if d.kind == word]
        yield f"\n{word}: {len(some)} draws, {sum(d.unclear for d in some)} runs or draws that gave no length"
    yield from coverage(draws)


def main() -> None:
    ask = argparse.ArgumentParser()
    ask.add_argument("draws", type=int, nargs="?", default=200)
    ask.add_argument("--whole", action="store_true", help="build whole campaigns")
    ask.add_argument("--first", type=int, default=0, help="first seed")
    given = ask.parse_args()
    draws = [one(seed, whole=given.whole) for seed in range(given.first, given.first + given.draws)]
    print(f"{len(draws)} draws\n")
    print("\n".join(tables(draws)))


if __name__ == "__main__":
    main()
