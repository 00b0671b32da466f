"""What does a build with sideslip to one side know of the other? `nice python tests/studies/one_side_study.py 60`.

The campaigns of slip_study, with sideslip and combined slip to one side only (camber to both, or to one too), of tyres whose
asymmetries are drawn around zero with the scatter of published files (``side`` in tir/parameters.csv), or, where that is not
stated, twice the size of the sample's. Prints the tables of slip_study, over ranges of the tested side and of the other one.
``--size`` multiplies the asymmetries.
"""

from __future__ import annotations

from dataclasses import dataclass

import harness
import numpy as np
from drawn_rigs import STAGED
from slip_study import VEHICLES, Kind, SlipDraw, built, page

import tir
from mffit.fit.stages import ODD_TERMS
from tir.parameters import BY_NAME

ASYMMETRY = 2.0
"""Standard deviation of an asymmetry over its value in the sample's file, where none is published."""
CONDITIONS = 200
"""Drawn conditions per range and side."""


@dataclass(frozen=True)
class OneSide(Kind):
    """A campaign with sideslip to one side."""

    one_lean: bool = False  #: camber to one side too
    first: int = 17_000

    @property
    def cambers(self) -> list[float]:
        lean = self.vehicle.camber
        return [0.0, lean] if self.one_lean else [-lean, 0.0, lean]

    @property
    def sideslips(self) -> list[float]:
        return [2.0, 6.0]

    @property
    def swept(self) -> dict[str, float]:
        return {"from": 0, "to": 12, "step": 1.5}

    def noise(self, rng: np.random.Generator) -> dict[str, float]:
        return dict(self.vehicle.noise)

    def asymmetric(self, tyre: tir.Tyre, size: float, rng: np.random.Generator) -> tir.Tyre:
        sizes = {n: BY_NAME[n].side_spread or ASYMMETRY * float(tyre[n]) for n in STAGED if n in ODD_TERMS}
        return tyre.replace(**{n: size * x * rng.standard_normal() for n, x in sizes.items()})

    def ranges(self, rng: np.random.Generator) -> dict[str, dict[str, np.ndarray]]:
        """Conditions (n,) of each side; camber leans as it was run, mirrored with the sideslip."""
        vehicle, n, out = self.vehicle, CONDITIONS, {}
        loads, lean = [vehicle.at(share) for share in self.shares], self.cambers
        p = np.full(n, 1e3 * vehicle.tyre["nominal_pressure"])
        for side, sign in (("tested", 1.0), ("other", -1.0)):
            for word, most in (("sideslip", 12.0), ("combined", 6.0)):
                alone = word == "sideslip"
                alpha = sign * np.radians(rng.uniform(0.0, most, n))
                gamma = sign * np.radians(rng.uniform(lean[0], lean[-1], n)) if alone else np.zeros(n)
                Fz = rng.uniform(loads[0], loads[-1], n)
                kappa = np.zeros(n) if alone else rng.uniform(-0.2, 0.2, n)
                here = {"Fz": Fz, "alpha": alpha, "gamma": gamma, "kappa": kappa, "p": p}
                out[f"{side} side, {word}"] = here
        return out


KINDS = {
    f"{word}, {'one lean' if lean else 'both leans'}{', base 30 % off' if base else ''}": OneSide(
        vehicle, base=base, one_lean=lean
    )
    for lean in (False, True)
    for base in (False, True)
    for word, vehicle in VEHICLES.items()
}


def one(job: harness.Job) -> SlipDraw:
    return built(job, KINDS[job.world])


if __name__ == "__main__":
    harness.study(one, page, worlds=KINDS, draws=60, in_turn=True, off=0.12, exact=True, size=1.0)
