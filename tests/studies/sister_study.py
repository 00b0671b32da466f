"""Do the stated uncertainties of a sister tyre's longitudinal force cover the truth? Drawn pairs of tyres, each with a build.

    python tests/studies/sister_study.py 40 --seed 1

The tyre is that of samples/flat-track-combined with friction and stiffness drawn; its sister differs by drawn ratios, and its Fx
by the scatter of the prior. The sweeps of sideslip have their noise, so that the ratios come from a fit.
"""

from __future__ import annotations

import argparse
import sys
import tomllib
from functools import partial
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "mffit" / "fit"))

from drawn_rigs import SAMPLES, on_disk

import mffit
import tir
from mffit.config.constants import SISTER_FRICTION_SCATTER, SISTER_STIFFNESS_SCATTER

SAMPLE = SAMPLES / "flat-track-combined"
NAMES = ("PDX1", "PDX2", "PKX1", "PKX2")
SIDESLIP = {"from": -12, "to": 12, "step": 1.5}  # deg


def drawn(random: np.random.Generator) -> dict[str, float]:
    """Error over stated standard uncertainty of the borrowed coefficients of one pair."""
    true = tir.read(SAMPLE / "true.tir")
    own = np.exp(random.normal(0.0, (0.1, 0.2)))
    apart = np.exp(random.normal(0.0, (float(SISTER_FRICTION_SCATTER), float(SISTER_STIFFNESS_SCATTER))))
    scaled = {name: own[0] * true[name] for name in ("PDY1", "PDY2")} | {"PKY1": own[1] * true["PKY1"]}
    scaled |= {name: own[0] * apart[0] * true[name] for name in ("PDX1", "PDX2")}
    scaled |= {name: own[1] * apart[1] * true[name] for name in ("PKX1", "PKX2")}
    content = {
        "noise": {"Fy_N": 12.0, "Mz_Nm": 1.5},
        "tyre": tomllib.loads((SAMPLE / "tyre.toml").read_text())["tyre"],
        "rig": {"type": "flat-track", "axes": "iso"},
        "sweep": [
            {"file": f"a{load}.csv", "load_N": load, "alpha_deg": SIDESLIP, "gamma_deg": [0, 4]}
            for load in (2000, 4200, 6500)
        ],
    }
    seed = int(random.integers(1 << 30))
    edit = partial(dict.update, sister={"Fx": "scaled"})
    with on_disk(true.replace(**scaled), content, seed, base=true, edit=edit) as (toml, _):
        found = mffit.build(toml).fit.lent.found
    return {name: (found[name].value - scaled[name]) / found[name].u for name in NAMES}


def main() -> None:
    """Coverage of the 95 % intervals, and rms of the errors over their stated size."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    random = np.random.default_rng(given.seed)
    rows = [drawn(random) for _ in range(given.count)]
    for name in NAMES:
        z = np.array([row[name] for row in rows])
        print(f"{name}: inside 95 % {np.mean(np.abs(z) < 1.96):.0%}, rms of z {np.sqrt(np.mean(z**2)):.2f}")


if __name__ == "__main__":
    main()
