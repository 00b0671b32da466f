"""The rolling radius over load from radii under load: these leave the free radius where it is declared."""

from __future__ import annotations

import numpy as np
import pytest
from disc_project import disc_project, rows

import tir
from mffit.config import loading
from mffit.fit.beginning import sketch
from mffit.fit.known import estimates
from mffit.fit.wheel.rolling import effective_radius
from mffit.fit.wheel.vertical import OF_ROLLING_RADIUS, SPREADS, vertical_coefficients
from mffit.numbers import Numbers
from mffit.pipeline.inputs import read_points
from mffit.pipeline.measuring import measure
from mffit.points import make_points
from tir.derivatives import gradient, plain, traced

R0, FNOMIN, SPEED = 0.3, 1500.0, 6.0
LOADS = np.array([900.0, 1500.0, 2200.0])
LAWS = {
    "a third of the deflection": lambda Fz, stiffness: R0 - Fz / stiffness / 3.0,
    "saturating": lambda Fz, stiffness: R0 - 700.0 / stiffness * (1.0 - np.exp(-Fz / 1000.0)),
    "power": lambda Fz, stiffness: R0 - 650.0 / stiffness * (Fz / FNOMIN) ** 0.6,
}


def known(stiffness: float) -> dict:
    """Values before the fit, with a vertical stiffness [N/m] that may be wrong."""
    start = tir.Tyre.from_values({}).replace(UNLOADED_RADIUS=R0, FNOMIN=FNOMIN, LONGVL=16.0)
    return {**start.values, **estimates(start.values), "VERTICAL_STIFFNESS": stiffness}


def stated(values: dict, posterior: Numbers, loads: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The rolling radius [m] of a fit at loads (n,) [N], and its standard uncertainty."""
    free = traced({name: float(values[name]) for name in OF_ROLLING_RADIUS})
    radius = effective_radius({**values, **free}, loads, SPEED)
    slopes = gradient(radius, list(free.values()))
    return plain(radius), posterior.spread_of(np.broadcast_to(slopes, (len(loads), len(free))), list(free))


@pytest.mark.parametrize("law", LAWS)
def test_wheel_speeds_give_the_radius_within_and_beyond_the_loads(law):
    """The estimated stiffness is wrong by up to 30 %."""
    pulls, free = [], []
    for seed in range(12):
        draw = np.random.default_rng(seed)
        stiffness = draw.uniform(80e3, 200e3)
        read = LAWS[law](LOADS, stiffness) + 2e-4 * draw.standard_normal(3)
        points = make_points(
            0.0, 0.0, LOADS, p=250e3, V=SPEED, phi_t=0.0, sweep=np.arange(3), sweep_names=list("abc"), Fy=0.0, kappa=0.0,
            omega=SPEED / read,
        )  # fmt: skip
        before = known(draw.uniform(0.7, 1.3) * stiffness)
        found = vertical_coefficients(before, points)
        own = found.beside
        posterior = Numbers.of(list(own.values), list(own.values.values()), own.covariance)
        loads = np.array([*LOADS, 0.3 * LOADS[-1], 1.5 * LOADS[-1]])
        radius, u = stated({**before, **own.values}, posterior, loads)
        error = radius - LAWS[law](loads, stiffness)
        assert np.all(np.abs(error[:3]) < np.maximum(5e-4, 2.0 * u[:3]))
        assert np.all(np.abs(error) < 2e-3)
        pulls.append(error / u)
        free.append((own.values["Q_RE0"] - 1.0) / found.found["Q_RE0"].u)
    assert np.sqrt(np.mean(np.square(pulls))) < 1.3
    assert np.max(np.abs(free)) < 1.5


@pytest.mark.parametrize("track", ["disc", "straight"])
def test_three_radii_on_a_line_leave_the_free_radius(track, tmp_path):
    """A straight line of radii through the unloaded radius: the curve that arctan adds must not lift the wheel off its radius."""
    project = disc_project(tmp_path)
    stiffness = 85e3
    radii = LAWS["a third of the deflection"](LOADS, stiffness)
    project.config["rolling_radius"] = [
        {"load_N": load, "effective_radius": float(radius), "u_effective_radius": 7e-4}
        for load, radius in zip(LOADS.tolist(), radii, strict=True)
    ]
    if track == "straight":
        project.config["rig"] = {"type": "flat-track", "axes": "iso"}
        project.config["sweep"] = []
        for load in (1000.0, 1500.0):
            project.add(f"s_{load:.0f}.csv", rows(np.linspace(-8.0, 8.0, 17), 0.0, load, side=0.0))
            project.add(f"c_{load:.0f}.csv", rows(0.0, np.linspace(-40.0, 40.0, 17), load, side=0.0))
    config = loading.load(project.write())
    points = read_points(config).points
    _, measured = measure(config, points, None)
    fit = sketch(config, points, measured, None)
    loads = np.array([100.0, *LOADS, 3300.0])
    radius, u = stated(dict(fit.tyre.values), fit.posterior, loads)
    error = radius - LAWS["a third of the deflection"](loads, stiffness)
    assert np.all(np.abs(error) < [2e-3, 5e-4, 5e-4, 5e-4, 2e-3])
    assert np.all(np.abs(error) < 2.0 * u)
    assert abs(fit.tyre["Q_RE0"] - 1.0) < 2e-3
    Q_RE0 = fit.coefficients["Q_RE0"]
    assert Q_RE0.status == "regularised"
    assert Q_RE0.stderr == pytest.approx(SPREADS["Q_RE0"], rel=0.2)
    assert not any(fit.coefficients[name].at_bound for name in OF_ROLLING_RADIUS)


def test_a_measured_free_radius_is_not_drawn_to_the_declared_one():
    """Loaded radii at several loads: 1 % above the declared radius, as a tyre that grew."""
    loads, stiffness = np.linspace(600.0, 2400.0, 7), 120e3
    points = make_points(
        0.0, 0.0, loads, p=250e3, V=SPEED, phi_t=0.0, sweep=np.arange(7), sweep_names=list("abcdefg"), Fy=0.0,
        RL=1.01 * R0 - loads / stiffness + 1e-5 * np.random.default_rng(2).standard_normal(7),
    )  # fmt: skip
    found = vertical_coefficients({**known(100e3), "Q_V2": 0.0}, points).found["Q_RE0"]
    assert found.value == pytest.approx(1.01, abs=0.001)
