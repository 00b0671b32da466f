"""Do the stated uncertainties of a sister tyre's longitudinal force cover the truth? Drawn pairs of tyres, each with a build.

    python tests/studies/sister_study.py 40 --seed 1

The tyre is that of samples/flat-track-combined with friction and stiffness drawn; its sister differs by drawn ratios, and its Fx
by the scatter of the prior. The sweeps of sideslip have their noise, so that the ratios come from a fit.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import numpy as np

import mffit
import tir
from mffit import virtual_rig
from mffit.config.constants import SISTER_FRICTION_SCATTER, SISTER_STIFFNESS_SCATTER

SAMPLE = Path(__file__).parents[2] / "samples" / "flat-track-combined"
NAMES = ("PDX1", "PDX2", "PKX1", "PKX2")
RIG = """
[rig]
type = "flat-track"
axes = "iso"
"""
TYRE = """
[tyre]
name = "t"
unloaded_radius = 0.3185
width = 0.225
rim_radius = 0.2159
nominal_load = 4200
nominal_pressure = 240
nominal_speed = 16.7
"""
RUNS = """
[[sweep]]
file = "a{load}.csv"
load_N = {load}
alpha_deg = {{ from = -12, to = 12, step = 1.5 }}
gamma_deg = [0, 4]
"""


def drawn(random: np.random.Generator, folder: Path) -> dict[str, float]:
    """Error over stated standard uncertainty of the borrowed coefficients of one pair."""
    true = tir.read(SAMPLE / "true.tir")
    own = np.exp(random.normal(0.0, (0.1, 0.2)))
    apart = np.exp(random.normal(0.0, (float(SISTER_FRICTION_SCATTER), float(SISTER_STIFFNESS_SCATTER))))
    scaled = {name: own[0] * true[name] for name in ("PDY1", "PDY2")} | {"PKY1": own[1] * true["PKY1"]}
    scaled |= {name: own[0] * apart[0] * true[name] for name in ("PDX1", "PDX2")}
    scaled |= {name: own[1] * apart[1] * true[name] for name in ("PKX1", "PKX2")}
    true.write(folder / "sister.tir")
    true.replace(**scaled).write(folder / "true.tir")
    runs = "".join(RUNS.format(load=load) for load in (2000, 4200, 6500))
    faults = '[truth]\ntyre = "true.tir"\n[noise]\nFy_N = 12.0\nMz_Nm = 1.5\n'
    (folder / "rig.toml").write_text(f"seed = {random.integers(1 << 30)}\n{faults}{TYRE}{RIG}{runs}")
    virtual_rig.simulate(virtual_rig.load_plan(folder / "rig.toml"), folder / "data")
    toml = folder / "data" / "tyre.toml"
    text = toml.read_text().replace('name = "t"', 'name = "t"\nbase = "../sister.tir"', 1)
    toml.write_text(f'{text}\n[sister]\nFx = "scaled"\n')
    found = mffit.build(toml).fit.lent.found
    return {name: (found[name].value - scaled[name]) / found[name].u for name in NAMES}


def main() -> None:
    """Coverage of the 95 % intervals, and rms of the errors over their stated size."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    random = np.random.default_rng(given.seed)
    rows = []
    for _ in range(given.count):
        with tempfile.TemporaryDirectory() as folder:
            rows.append(drawn(random, Path(folder)))
    for name in NAMES:
        z = np.array([row[name] for row in rows])
        print(f"{name}: inside 95 % {np.mean(np.abs(z) < 1.96):.0%}, rms of z {np.sqrt(np.mean(z**2)):.2f}")


if __name__ == "__main__":
    main()
