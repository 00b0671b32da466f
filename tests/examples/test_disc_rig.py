"""The virtual rig's files against the forward model, which works the rig's faults out by itself."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

SAMPLES = Path(__file__).parents[2] / "samples" / "front-120-70"
PLAN = """\
seed = 3
[truth]
tyre = "{tyre}"
[faults]
alpha_0_deg = 0.1
gamma_0_deg = -0.3
F0_N = 7.0
M0_Nm = 0.4
gain = 1.01
path_radius_m = 1.35
{noise}
[tyre]
name = "front"
unloaded_radius = 0.2992
nominal_load = 1400
nominal_pressure = 250
[rig]
path_radius = 1.323
backlash_deg = 0.17
{sweeps}
"""
SWEEP = '[[sweep]]\nfile = "{}_{:g}.csv"\nload_N = {:g}\n{}\n'
SWEEPS = "".join(
    SWEEP.format("sideslip", load, load, "alpha_deg = { from = -6, to = 6, step = 1 }")
    + SWEEP.format("camber", load, load, "gamma_deg = { from = -40, to = 40, step = 5 }")
    + SWEEP.format("back", load, load, 'alpha_deg = [-1, 0, 1]\ndirection = "backward"')
    for load in (900.0, 1400.0)
)
NOISE = "[noise]\nFy_N = 6.0\nMz_Nm = 0.6"


def plan(folder: Path, noise: str = "") -> Path:
    file = folder / "rig.toml"
    file.write_text(PLAN.format(tyre=(SAMPLES / "true.tir").as_posix(), noise=noise, sweeps=SWEEPS))
    return file


def test_the_sweeps_are_reproduced(example, tmp_path):
    """To the digits of the files, with every fault at work."""
    measured, left = example("disc_rig").compare(plan(tmp_path), tmp_path / "out")
    assert len(measured) == 66
    Fy, Mz = left["path and faults"]
    assert np.max(np.abs(Fy)) < 0.02
    assert np.max(np.abs(Mz)) < 0.002
    lacking = {name: np.sqrt(np.mean(rest[0] ** 2)) for name, rest in left.items()}
    assert (
        lacking["straight path"] > 5.0 * lacking["path, a perfect rig"] > 1000.0 * lacking["path and faults"]
    )


def test_with_noise_the_noise_is_left(run, tmp_path):
    """66 points: the root mean square of 6 N and 0.6 Nm is that to 35 per cent, four of its standard deviations."""
    out = run("disc_rig", plan(tmp_path, NOISE), tmp_path / "out", "--picture", tmp_path / "a.png")
    assert "66 points" in out
    words = next(line for line in out.splitlines() if line.startswith("path and faults")).split()
    assert float(words[words.index("Fy") + 1]) == pytest.approx(6.0, rel=0.35)
    assert float(words[words.index("Mz") + 1]) == pytest.approx(0.6, rel=0.35)
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
