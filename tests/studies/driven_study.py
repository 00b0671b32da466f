"""Recovery of longitudinal and combined slip: drawn tyres on a simulated drive/brake programme.

``python tests/studies/driven_study.py [DRAWS]`` prints a line per draw: whether the drawn tyre keeps the limits of the fit; by
channel the misfit and the rms error of the forces, over the noise; and the share of coefficients within 1.96 standard errors.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import tir
from mffit.fit.constraints import Envelope, violations
from tir.parameters import TABLE

sys.path.insert(0, str(Path(__file__).parents[2]))
from tests.mffit.fit import combined_programme as belt

ENVELOPE = Envelope(
    Fz=(900.0, 2100.0), gamma=np.radians(6.0), alpha=np.radians(10.0), pressure=(200e3, 300e3), kappa=0.2
)
SHAPES = ("PCX1", "RCX1", "RCY1", "PCY1", "QCZ1")
ADDED = {
    "PHX1": 0.002, "PVX2": 0.01, "PEX3": 0.2, "REX2": 0.2, "REY2": 0.2, "RBX3": 5.0, "RBY4": 5.0, "RHY2": 0.003, "RVY2": 0.02,
    "SSZ3": 0.1, "SSZ4": 0.1, "PPMX1": 0.2, "PKX3": 0.1, "PPX2": 0.3, "PPX4": 0.2,
}  # fmt: skip
"""Standard deviation of coefficients that are 0 in the tyre that the draws are around."""


def drawn(base: tir.Tyre, seed: int) -> tir.Tyre:
    """The tyre with every fitted coefficient that it has 25 % off, shape factors 6 %."""
    random = np.random.default_rng(1000 + seed)
    values = {}
    for row in TABLE:
        value = base[row.name]
        staged = row.stage not in ("", "held") and not row.section.startswith("TURN")
        if staged and isinstance(value, float) and value:
            scale = 0.06 if row.name in SHAPES else 0.25
            values[row.name] = float(np.clip(value * (1.0 + scale * random.standard_normal()), *row.bounds))
    values |= {name: base[name] + size * random.standard_normal() for name, size in ADDED.items()}
    return base.replace(**values)


def main(draws: int) -> None:
    """Print a line per draw."""
    base = belt.truth()
    random = np.random.default_rng(2)
    Fz, gamma = random.uniform(900.0, 2100.0, 400), np.radians(random.uniform(0.0, 6.0, 400))
    alpha, kappa = np.radians(random.uniform(-5.0, 5.0, 400)), random.uniform(-0.2, 0.2, 400)
    for seed in range(draws):
        true = drawn(base, seed)
        found = belt.fitted(belt.programme(tyre=true, seed=seed))
        expected, read = (
            tyre(Fz, alpha, gamma, kappa, p=250e3, turn_slip=False) for tyre in (true, found.written)
        )
        misfit = {name: found.channels[name].rmse / noise for name, noise in belt.NOISE.items()}
        error = {
            name: float(np.sqrt(np.mean((getattr(read, name) - getattr(expected, name)) ** 2))) / noise
            for name, noise in belt.NOISE.items()
        }
        free = [name for name, row in found.coefficients.items() if row.stderr]
        within = [
            abs(found.coefficients[name].value - true[name]) < 1.96 * found.coefficients[name].stderr
            for name in free
        ]
        breaks = "breaks a limit" if np.any(violations(true.p, ENVELOPE) > 1e-6) else "keeps the limits"
        shown = " ".join(f"{name} {misfit[name]:.2f} {error[name]:.2f}" for name in belt.NOISE)
        print(f"{seed:3d} {breaks}: {shown}, {np.mean(within):.1%} within", flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 24)
