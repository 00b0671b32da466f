"""Sweeps of the virtual rig against the forward model, which computes the rig errors independently."""

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


def test_the_forward_model_reproduces_the_sweeps(example, tmp_path):
    """To the digits of the files, with all rig errors acting."""
    measured, residuals = example("disc_rig").compare(plan(tmp_path), tmp_path / "out")
    assert len(measured) == 66
    Fy, Mz = residuals["path and rig errors"]
    assert np.max(np.abs(Fy)) < 0.02
    assert np.max(np.abs(Mz)) < 0.002
    rms = {name: np.sqrt(np.mean(rest[0] ** 2)) for name, rest in residuals.items()}
    assert rms["straight path"] > 5.0 * rms["path, no rig errors"] > 1000.0 * rms["path and rig errors"]


def test_the_residuals_are_the_noise(run, tmp_path):
    """The rms of 66 points scatters by 9 %; the bound of 35 % is four standard deviations."""
    out = run("disc_rig", plan(tmp_path, NOISE), tmp_path / "out", "--picture", tmp_path / "a.png")
    assert "66 points" in out
    words = next(line for line in out.splitlines() if line.startswith("path and rig errors")).split()
    assert float(words[words.index("Fy") + 1]) == pytest.approx(6.0, rel=0.35)
    assert float(words[words.index("Mz") + 1]) == pytest.approx(0.6, rel=0.35)
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
