"""Runs that read a share more than the others are found, whatever else the model misses; no fit takes part."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.diagnosis.noise import Noise, Scatter
from mffit.diagnosis.odd_level import OddLevel, odd_level
from mffit.points import Points, make_points

LOADS, PRESSURES, ANGLES = (1000.0, 1800.0, 2700.0), (200.0, 250.0), np.linspace(-8.0, 8.0, 17)
NOISE = 6.0  # N


def campaign() -> tuple[Points, np.ndarray]:
    """One file per load and pressure, and a plain saturating force [N]."""
    load, p, alpha = (x.ravel() for x in np.meshgrid(LOADS, PRESSURES, ANGLES, indexing="ij"))
    file = np.repeat(np.arange(len(LOADS) * len(PRESSURES)), len(ANGLES))
    names = tuple(f"run_{k}.csv" for k in range(file.max() + 1))
    force = -1.1 * load * np.tanh(np.radians(alpha) * 14.0)
    points = make_points(
        np.radians(alpha), 0.0, load, p=1e3 * p, V=10.0, phi_t=0.0, Fy=force,
        sweep=file, file=file, sweep_names=names, files=names,
    )  # fmt: skip
    return points, force


def found(
    share: np.ndarray, left: float = 0.0, missed: np.ndarray | float = 0.0, seed: int = 1
) -> OddLevel | None:
    """What is found where every reading is larger by its ``share``, in noise and in what the model ``missed`` [N]."""
    points, force = campaign()
    residual = share * force + missed + np.random.default_rng(seed).normal(0.0, NOISE, len(force))
    u = np.full(len(force), NOISE)
    noise = Noise(u=u, stated=u, chain=points.sweep, origin=None, scatter={"Fy": Scatter()})
    return odd_level(points, residual, force, noise, {"Fy": left} if left else {})


@pytest.mark.parametrize("load", LOADS)
def test_the_load_whose_runs_read_more_is_found(load):
    points, _ = campaign()
    odd = found(np.where(points.Fz == load, 0.04, 0.0))
    assert odd is not None
    assert odd.region == {"Fz_N": (load, load)}
    assert abs(odd.share - 0.04) < 3.0 * 0.04 / odd.z
    assert f"runs at a load of {load:.0f} N is" in odd.said


def test_the_pressure_whose_runs_read_less_is_found():
    points, _ = campaign()
    odd = found(np.where(points.p > 2.2e5, -0.05, 0.0))
    assert odd is not None
    assert "runs at a pressure of 250 kPa" in odd.said
    assert "5" in odd.said.partition("smaller")[0]


def test_one_file_is_found_by_its_name():
    points, _ = campaign()
    odd = found(np.where(points.file == 3, 0.06, 0.0))
    assert odd is not None
    assert "runs of run_3.csv" in odd.said
    assert not odd.region


def test_a_gain_of_the_whole_test_is_that_of_no_level():
    points, _ = campaign()
    odd = found(np.full(len(points), 0.04))
    assert odd is not None
    assert odd.said == "the side force of all runs is 4.0 % larger than simulated"


@pytest.mark.parametrize("seed", range(20))
def test_noise_alone_has_no_odd_level(seed):
    points, _ = campaign()
    assert found(np.zeros(len(points)), seed=seed) is None


def test_what_a_build_left_needs_no_cause():
    """The formula misses every load by another share; as much was left of the build's own readings."""
    points, _ = campaign()
    missed = np.select([points.Fz == load for load in LOADS], (15.0, -12.0, 10.0)) * np.sign(points.alpha)
    assert found(np.zeros(len(points)), left=12.0, missed=missed) is None
    assert found(np.where(points.Fz == 2700.0, 0.04, 0.0), left=12.0, missed=missed) is not None
