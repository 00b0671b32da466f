"""What does a build with sideslip to one side know of the other? `nice python tests/studies/one_side_study.py 60`.

The campaigns of slip_study, with sideslip and combined slip to one side only (camber to both, or to one too), of tyres whose
asymmetries are drawn around zero with the scatter of published files (``side`` in tir/parameters.csv), or, where that is not
stated, twice the size of the sample's. Prints, for the tested side and for the other one, the rms
error against the noise-free truth, the half width of the 95 % bands and the share of the truth inside them, and the
coefficients inside their 95 % intervals.
"""

from __future__ import annotations

import argparse
import sys
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "mffit" / "fit"))

from drawn_rigs import STAGED, Band, Draw, half_of_mean, on_disk
from slip_study import FOUND, RIGHT, SPEED, UNSETTLED, VEHICLES, Kind, _drawn, sweeps

import mffit
import tir
from mffit.errors import InputError
from mffit.fit.stages import ODD_TERMS
from mffit.points import make_points
from mffit.rig import Simulation
from mffit.scatter import rms
from tir.parameters import BY_NAME

ASYMMETRY = 2.0
"""Standard deviation of an asymmetry over its value in the sample's file, where none is published."""
ONE_SIDE = {"from": 0, "to": 12, "step": 1.5}
CONDITIONS = 200
"""Drawn conditions per range and side."""
CHANNELS = ("Fx", "Fy", "Mz")


@dataclass(frozen=True)
class OneSide(Kind):
    """A campaign with sideslip to one side."""

    one_lean: bool = False  #: camber to one side too

    @property
    def cambers(self) -> list[float]:
        return (
            [0.0, self.vehicle.camber] if self.one_lean else [-self.vehicle.camber, 0.0, self.vehicle.camber]
        )

    @property
    def sideslips(self) -> list[float]:
        return [2.0, 6.0]


@dataclass
class SideDraw(Draw):
    """A draw with the bands on both sides, in :attr:`bands` by side, range and channel."""

    seed: int = 0
    at_bound: tuple[str, ...] = ()


def one(seed: int, off: float, size: float) -> SideDraw:
    """Draw, simulate and build one campaign."""
    rng = np.random.default_rng(17_000 + seed)
    vehicle = list(VEHICLES.values())[seed % 2]
    kind = OneSide(vehicle=vehicle, base=seed % 4 > 1, one_lean=seed % 8 > 3)
    true = _drawn(tir.read(vehicle.true).replace(**UNSETTLED, LONGVL=SPEED), off, rng)
    base = _drawn(true, 0.3, rng) if kind.base else None
    sizes = {n: BY_NAME[n].side_spread or ASYMMETRY * float(true[n]) for n in STAGED if n in ODD_TERMS}
    true = true.replace(**{n: size * x * rng.standard_normal() for n, x in sizes.items()})
    content = {
        "faults": {"draw": True, **RIGHT},
        "noise": dict(vehicle.noise),
        "conditions": {"V_mps": SPEED},
        "tyre": {"name": "drawn", "nominal_speed": SPEED, "side": "left", **vehicle.tyre},
        "rig": {"type": "flat-track", "axes": "sae"},
        "sweep": [
            {**row, "alpha_deg": ONE_SIDE} if isinstance(row.get("alpha_deg"), dict) else row
            for row in sweeps(kind)
        ],
    }
    draw = SideDraw(seed=seed)
    with on_disk(true, content, seed, base=base) as (path, _):
        try:
            result = mffit.build(path)
        except InputError as error:
            draw.refused = str(error)
            return draw
    fit = result.fit
    draw.seconds = fit.seconds
    draw.at_bound = tuple(name for name, row in fit.coefficients.items() if row.at_bound)
    draw.note_coefficients(fit, true, [name for name in FOUND if true[name]])
    for side, sign in (("tested", 1.0), ("other", -1.0)):
        for word, combined in (("sideslip", False), ("combined", True)):
            draw.bands |= {
                f"{side} side, {word}, {name}": band
                for name, band in _in_bands(fit, true, kind, sign, combined, rng).items()
            }
    return draw


def _in_bands(
    fit: Any, true: tir.Tyre, kind: OneSide, sign: float, combined: bool, rng: np.random.Generator
) -> dict[str, Band]:
    """Error and 95 % band at drawn conditions of one side; camber leans as it was run, mirrored with the sideslip."""
    vehicle, n = kind.vehicle, CONDITIONS
    where = make_points(
        sign * np.radians(rng.uniform(0.0, 6.0 if combined else 12.0, n)),
        0.0 if combined else sign * np.radians(rng.uniform(kind.cambers[0], kind.cambers[-1], n)),
        rng.uniform(vehicle.at(kind.shares[0]), vehicle.at(kind.shares[-1]), n),
        kappa=rng.uniform(-0.2, 0.2, n) if combined else 0.0,
        p=1e3 * vehicle.tyre["nominal_pressure"],
        V=SPEED,
        phi_t=0.0,
    )
    tyre, truth = (Simulation(t.values, turn_slip=False) for t in (fit.tyre, true))
    channels = CHANNELS if combined else CHANNELS[1:]
    found, right = tyre.readings(where, channels), truth.readings(where, channels)
    half = half_of_mean(fit, tyre, where)
    return {
        name: Band(
            float(np.mean(np.abs(found[name] - right[name]) <= half[name])),
            rms(half[name]),
            rms(found[name] - right[name]),
        )
        for name in channels
    }


def lines(draws: list[SideDraw]) -> Iterable[str]:
    """Lines of the tables."""
    yield from (f"* seed {d.seed}: refused: {d.refused}" for d in draws if d.refused)
    draws = [d for d in draws if not d.refused]
    yield f"\n{len(draws)} builds, fit {np.median([d.seconds for d in draws]):.1f} s\n"
    yield "| conditions | rms error | median of a draw | half width of the band | truth inside |"
    yield "|---" * 5 + "|"
    for key in draws[0].bands:
        rows = [d.bands[key] for d in draws]
        error = np.array([row.error for row in rows])
        half, inside = rms(np.array([row.half for row in rows])), np.mean([row.inside for row in rows])
        yield f"| {key} | {rms(error):.3g} | {np.median(error):.3g} | {half:.3g} | {inside:.1%} |"
    found: dict[str, list[tuple[bool, float]]] = defaultdict(list)
    for d in draws:
        for name, inside in d.inside.items():
            found[name].append((inside, d.pulls[name]))
    for word in ("", "regularised"):
        every = [x for name, rows in found.items() if ("(" in name) == bool(word) for x, _ in rows]
        yield f"\n{word or 'fitted'} coefficients inside 95 %: {np.mean(every):.1%} of {len(every)}"
    worst = sorted(found, key=lambda n: np.mean([x for x, _ in found[n]]))[:12]
    yield "least often inside: " + ", ".join(
        f"{n} {np.mean([x for x, _ in found[n]]):.0%} of {len(found[n])}" for n in worst
    )
    bounds = [name for d in draws for name in d.at_bound]
    yield "at a bound: " + ", ".join(f"{n} {bounds.count(n)}" for n in sorted(set(bounds)))


def main() -> None:
    ask = argparse.ArgumentParser()
    ask.add_argument("builds", type=int, nargs="?", default=60)
    ask.add_argument("--first", type=int, default=0)
    ask.add_argument("--off", type=float, default=0.12, help="largest relative distance of a coefficient")
    ask.add_argument("--size", type=float, default=1.0, help="factor on the asymmetries")
    given = ask.parse_args()
    draws = []
    for seed in range(given.first, given.first + given.builds):
        draws.append(one(seed, given.off, given.size))
        print(f"seed {seed} {draws[-1].seconds:.1f} s", file=sys.stderr, flush=True)
    print("\n".join(lines(draws)))


if __name__ == "__main__":
    main()
