"""Do steps of sideslip and of slip give the relaxation lengths? `nice python tests/studies/steps_study.py 200`.

Draws tyres around a car's and a motorcycle's file with other carcasses, and recordings of steps with other noise, correlation of
the noise, sampling rate, speed, loads and pressures. ``--whole`` builds whole campaigns with sweeps and steps from a cold
start instead. Prints the tables of docs/recovery.md.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import harness
import numpy as np
from drawn_rigs import SAFE, on_disk, scaled
from slip_study import RIGHT, SPEED, UNSETTLED, VEHICLES, Kind, SlipDraw, Vehicle, sweeps

import mffit
import tir
from mffit import config as configuration
from mffit.fit.relaxation import DIRECTIONS, relaxation
from mffit.numbers import Numbers
from mffit.points.loading import read
from mffit.rig import Simulation
from mffit.scatter import rms

NONE_KNOWN = Numbers.of((), (), np.zeros((0, 0)))
STEPPED = {"alpha": ("alpha_deg", (0, 1, 0, -1, 0)), "kappa": ("kappa", (0, 0.025, 0, -0.025, 0))}
KINDS = {
    f"{word}, {size}": Kind(vehicle, thin=size == "thin")
    for size in ("thin", "full")
    for word, vehicle in VEHICLES.items()
}


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


def one(job: harness.Job) -> StepsDraw:
    """Draw and simulate the steps, and fit them with the rest of the tyre known, or from a whole campaign."""
    rng, kind, whole = np.random.default_rng(17000 + job.seed), KINDS[job.world], job.given.whole
    true = drawn_tyre(kind.vehicle, rng, 0.12)
    draw = StepsDraw(kind=job.world, seed=job.seed)
    runs = step_runs(kind.vehicle, rng)
    noise = {key: float(x * 2.0 ** rng.uniform(-1.0, 1.0)) for key, x in kind.vehicle.noise.items()}
    content = kind.vehicle.content((sweeps(kind) if whole else []) + runs, RIGHT, noise)
    with on_disk(true, content, job.seed) as (path, _):
        if whole:
            result = mffit.build(path, with_report=False)
            draw.seconds, found = result.fit.seconds, result.fit.relaxation
            draw.note_coefficients(result.fit, true, [name for one in DIRECTIONS for name in one.names])
        else:
            start = true.replace(**{one.names[0]: 2.0 * true[one.names[0]] for one in DIRECTIONS})
            start = start.replace(**{name: 0.0 for one in DIRECTIONS for name in one.names[1:]})
            steps = read(configuration.load(path)).steps
            found = relaxation(steps, Simulation.of(start, turn_slip=False), NONE_KNOWN)
            for direction in found:
                for name, q in direction.found.items():
                    draw.note(name, q.value, q.u, true[name])
    rate = round(runs[0]["recording"]["rate_Hz"])
    for direction in found:
        sigma = direction.direction.sigma
        for run in direction.runs:
            truth = float(getattr(true.state(run.load, p=run.pressure), sigma))
            draw.lengths.append((sigma, *run.length[:2], truth, rate))
    draw.unclear = len(runs) - len(draw.lengths)
    return draw


def page(_: Any, drawn: Mapping[str, list[StepsDraw]]) -> Iterator[str]:
    draws = [d for rows in drawn.values() for d in rows]
    yield f"{len(draws)} draws"
    lengths = [(row, d.kind.split(", ")[0]) for d in draws for row in d.lengths]
    groups: dict[str, list[tuple[float, ...]]] = {}
    for (sigma, *found, rate), vehicle in lengths:
        for word in (sigma, vehicle, f"{rate} Hz"):
            groups.setdefault(word, []).append(tuple(found))
    rows = []
    for word in sorted(groups):
        length, u, truth = np.array(groups[word]).T
        pull = (length - truth) / u
        errors = (f"{1e3 * rms(length - truth):.1f}", f"{1e3 * rms(u):.1f}", f"{np.mean(pull):+.2f}")
        rows.append((word, len(u), harness.percent(np.abs(pull) < SAFE), *errors, f"{np.std(pull):.2f}"))
    head = ("length", "runs", "inside 95 %", "rms error [mm]", "rms u [mm]", "mean pull", "sd of pull")
    yield from harness.table(head, rows)
    for word, some in drawn.items():
        yield f"* {word}: {len(some)} draws, {sum(d.unclear for d in some)} runs or draws that gave no length"
    yield from harness.coverage(draws)


if __name__ == "__main__":
    harness.study(one, page, worlds=KINDS, draws=200, in_turn=True, whole=False)
