"""Vertical stiffness and rolling radius from readings that this file computes with its own formulae."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import tir
from mffit.fit.wheel.vertical import vertical_coefficients, vertical_sentence
from mffit.points import Points, make_points
from mffit.virtual_rig.machine import loaded_radius
from tir.equations import vertical

R0, FNOMIN, NOMPRES = 0.3, 4000.0, 200e3
STIFFNESS, Q_FZ2, PFZ1, Q_RE0, GROWTH = 200e3, 40.0, 0.6, 1.01, 0.02
DREFF, BREFF, FREFF = 0.3, 6.0, 0.1
Q_V1, Q_V2 = 0.0006, 0.04
VALUES = dict(tir.Tyre.from_values({}).values) | {
    "UNLOADED_RADIUS": R0, "FNOMIN": FNOMIN, "NOMPRES": NOMPRES, "VERTICAL_STIFFNESS": 90e3, "BREFF": 8.0, "DREFF": 0.25,
    "FREFF": 0.05,
}  # fmt: skip


def rolling(
    loads=(1000.0, 2500.0, 4000.0, 6000.0, 8000.0),
    pressures=(150e3, 200e3, 250e3),
    noise=2e-5,
    noise_of_RL=2e-5,
    seed=5,
) -> Points:
    """Readings of the upright wheel: the root of a quadratic for the deflection, and the rolling radius over it."""
    Fz, p = (x.ravel() for x in np.meshgrid(loads, pressures))
    dpi = p / NOMPRES - 1.0
    q1 = np.sqrt((STIFFNESS * R0 / FNOMIN) ** 2 - 4.0 * Q_FZ2)
    share = Fz / FNOMIN / (1.0 + PFZ1 * dpi)
    x = np.array([np.roots([Q_FZ2, q1, -s]).max() for s in share])
    free = R0 * (Q_RE0 + GROWTH * dpi)
    draw = np.random.default_rng(seed)
    scale = FNOMIN / STIFFNESS / (1.0 + PFZ1 * dpi)
    Re = free - scale * (DREFF * np.arctan(BREFF * Fz / FNOMIN) + FREFF * Fz / FNOMIN)
    Re = Re + noise * draw.standard_normal(len(Fz))
    return make_points(
        0.0, 0.0, Fz, p=p, V=16.0, phi_t=0.0, sweep=np.arange(len(Fz)), sweep_names=[f"run {k}" for k in range(len(Fz))],
        Fy=0.0, RL=free - R0 * x + noise_of_RL * draw.standard_normal(len(Fz)), omega=1.01 * 16.0 / Re, kappa=0.01,
    )  # fmt: skip


def at_speeds(speeds, noise=2e-5) -> Points:
    """One sweep of a wheel that grows and stiffens with speed, at the nominal pressure."""
    Fz, V = (x.ravel() for x in np.meshgrid((1000.0, 2500.0, 4000.0, 6000.0, 8000.0), speeds))
    Re = 0.29
    rim = V / Re * R0 / VALUES["LONGVL"]
    q1 = np.sqrt((STIFFNESS * R0 / FNOMIN) ** 2 - 4.0 * Q_FZ2)
    x = np.array([np.roots([Q_FZ2, q1, -s]).max() for s in Fz / FNOMIN / (1.0 + Q_V2 * rim)])
    RL = R0 * (Q_RE0 + Q_V1 * rim**2) - R0 * x + noise * np.random.default_rng(6).standard_normal(len(Fz))
    return make_points(
        0.0, 0.0, Fz, p=NOMPRES, V=V, phi_t=0.0, sweep=np.zeros(len(Fz), int), sweep_names=["rolling"],
        Fy=0.0, RL=RL, omega=V / Re,
    )  # fmt: skip


TRUTH = {
    "VERTICAL_STIFFNESS": STIFFNESS, "Q_FZ2": Q_FZ2, "PFZ1": PFZ1, "Q_RE0": Q_RE0, "DREFF": DREFF, "BREFF": BREFF,
    "FREFF": FREFF,
}  # fmt: skip


def test_stiffness_and_radii_are_recovered_with_their_errors():
    found = vertical_coefficients(VALUES, rolling())
    assert set(found.found) == set(TRUTH)
    for name, true in TRUTH.items():
        value, u, *_ = found.found[name]
        assert abs(value - true) < 4.0 * u, name
        assert u < 0.1 * abs(true), name
    assert found.growth == pytest.approx(GROWTH, rel=0.05)
    assert max(found.rms.values()) < 3e-5
    assert "changes by +2.0" in vertical_sentence(found)
    # The file lacks the growth: 0.02 of 0.3 m over one nominal pressure, at -0.25, 0 and 0.25 of it.
    file = {**VALUES, **{name: q.value for name, q in found.found.items()}}
    for agreement in found.agreement(file).values():
        assert agreement.n == 15
        assert agreement.rmse == pytest.approx(R0 * GROWTH * 0.25 * np.sqrt(2.0 / 3.0), rel=0.05)


def test_errors_of_the_loaded_radius_are_carried_into_the_rolling_radius():
    """The free radius comes from the loaded one, so DREFF takes up its error."""
    pulls = []
    for seed in range(8):
        found = vertical_coefficients(VALUES, rolling(noise=1e-5, noise_of_RL=2e-4, seed=seed))
        q = found.found["DREFF"]
        pulls.append((q.value - DREFF) / q.u)
        names = list(found.beside.values)
        i, j = names.index("Q_RE0"), names.index("DREFF")
        covariance = found.beside.covariance
        assert covariance[i, j] > 0.3 * np.sqrt(covariance[i, i] * covariance[j, j])
    assert 0.3 < np.sqrt(np.mean(np.square(pulls))) < 1.8


def test_what_few_loads_and_pressures_do_not_show_stays():
    two = vertical_coefficients(VALUES, rolling(loads=(2000.0, 6000.0), pressures=(200e3,)))
    assert set(two.found) == {"VERTICAL_STIFFNESS", "Q_RE0", "DREFF", "FREFF", "BREFF"}
    assert "BREFF" in two.regularised
    assert two.growth == 0.0
    assert not vertical_coefficients(VALUES, rolling(loads=(4000.0,))).found
    assert "Q_RE0" not in vertical_coefficients(VALUES, rolling(), held=("Q_RE0",)).found
    assert not vertical_coefficients(VALUES, rolling().replace(RL=np.nan, omega=np.nan)).found


def test_a_fit_through_every_mean_is_not_exact():
    """Three loads and three coefficients: the stiffness is as uncertain as radii that scatter by tenths of a millimetre."""
    three = vertical_coefficients(
        VALUES, rolling(loads=(2000.0, 4000.0, 6000.0), pressures=(200e3,), noise_of_RL=3e-4)
    )
    assert three.rms["RL"] < 1e-4
    q = three.found["VERTICAL_STIFFNESS"]
    assert abs(q.value - STIFFNESS) < 3.0 * q.u
    assert 0.005 * STIFFNESS < q.u < 0.3 * STIFFNESS


def test_wheel_speed_alone_gives_the_rolling_radius():
    known = {**VALUES, "VERTICAL_STIFFNESS": STIFFNESS, "PFZ1": PFZ1}
    found = vertical_coefficients(known, rolling().replace(RL=np.nan)).found
    assert found["Q_RE0"].value == pytest.approx(Q_RE0, abs=4.0 * found["Q_RE0"].u)
    assert found["DREFF"].value == pytest.approx(DREFF, abs=4.0 * found["DREFF"].u)


def test_vertical_stiffness_is_the_slope_at_the_nominal_load():
    p = tir.Tyre.from_values({}).replace(**TRUTH, UNLOADED_RADIUS=R0, FNOMIN=FNOMIN).p
    upright = vertical.Rolling(0.0, 0.0, 0.0, 1.0, 0.0)
    RL = float(vertical.loaded_radius(p, FNOMIN, upright))
    carried, slope = vertical.load(p, RL, upright)
    assert float(carried) == pytest.approx(FNOMIN, rel=1e-12)
    assert -float(slope) == pytest.approx(STIFFNESS, rel=1e-9)
    two = [float(vertical.load(p, RL + step, upright)[0]) for step in (-1e-6, 1e-6)]
    assert (two[0] - two[1]) / 2e-6 == pytest.approx(STIFFNESS, rel=1e-6)


LEANED = {
    "VERTICAL_STIFFNESS": STIFFNESS, "Q_FZ2": Q_FZ2, "PFZ1": PFZ1, "Q_RE0": Q_RE0, "Q_V1": Q_V1, "Q_V2": Q_V2, "Q_FCX": 0.12,
    "Q_FCY": 0.8, "Q_FCY2": 0.3, "Q_CAM1": 0.8, "Q_CAM2": 0.4, "Q_CAM3": 0.5, "Q_FYS1": -900.0, "Q_FYS2": 400.0, "Q_FYS3": 150.0,
    "WIDTH": 0.225, "ASPECT_RATIO": 0.45, "UNLOADED_RADIUS": R0, "FNOMIN": FNOMIN, "NOMPRES": NOMPRES,
}  # fmt: skip


def test_the_load_follows_the_published_formula_under_every_force():
    """MF-Tyre/MF-Swift 6.2, equation manual of July 2013, here as it is printed there."""
    p = tir.Tyre.from_values({}).replace(**LEANED).p
    RL, Fx, Fy, gamma, rim, dpi = 0.281, 2500.0, -3100.0, -0.07, 1.4, 0.15
    R_omega = R0 * (Q_RE0 + Q_V1 * rim**2)
    S_fyg = (-900.0 + 400.0 * RL / R_omega + 150.0 * (RL / R_omega) ** 2) * gamma
    rho_zfr = R_omega - RL
    rtw = (1.075 - 0.5 * 0.45) * 0.225
    rho_zg = ((0.8 * RL + 0.4 * RL**2) * gamma) ** 2 * (rtw / 8.0) * abs(np.tan(gamma)) / (
        (0.8 * R_omega + 0.4 * R_omega**2) * gamma
    ) ** 2 - 0.5 * rho_zfr * abs(gamma)
    rho = rho_zfr + rho_zg
    f_corr = (
        1.0 + Q_V2 * rim - (0.12 * Fx / FNOMIN) ** 2 - ((rho / R0) ** 0.3 * 0.8 * (Fy - S_fyg) / FNOMIN) ** 2
    )
    Q_FZ1 = np.sqrt((STIFFNESS * R0 / FNOMIN) ** 2 - 4.0 * Q_FZ2)
    Fz = f_corr * (1.0 + PFZ1 * dpi) * (Q_FZ1 * rho / R0 + Q_FZ2 * (rho / R0) ** 2) * FNOMIN
    rolling = vertical.Rolling(Fx, Fy, gamma, rim, dpi)
    assert float(vertical.load(p, RL, rolling)[0]) == pytest.approx(Fz, rel=1e-12)
    assert float(vertical.loaded_radius(p, Fz, rolling)) == pytest.approx(RL, rel=1e-12)


def on_the_rig(offset=0.0, seed=3, **differing: float) -> Points:
    """Sweeps of slip at sideslips and cambers, RL by bisection as the virtual rig has it, with an offset of every sweep."""
    draw = np.random.default_rng(seed)
    values = {
        **VALUES,
        **LEANED,
        "Q_FCY": 0.2,
        "Q_FCY2": 0.0,
        "Q_FYS1": 0.0,
        "Q_FYS2": 0.0,
        "Q_FYS3": 0.0,
        **differing,
    }
    runs = [
        (Fz, side, lean)
        for Fz in (1500.0, 4000.0, 7000.0)
        for side in (0.0, 2.0, 5.0)
        for lean in (0.0, 2.0, 4.0)
    ]
    Fz, side, lean = (np.repeat(x, 21) for x in np.array(runs).T)
    Fx = np.tile(np.linspace(-1.0, 1.0, 21), len(runs)) * Fz
    Fy = -side / 5.0 * Fz * np.sqrt(1.0 - 0.7 * (Fx / Fz) ** 2)
    p = np.repeat(np.resize([150e3, 200e3, 250e3], len(runs)), 21)
    omega = 16.7 / 0.29 * (1.0 + 0.1 * Fx / Fz)
    RL = loaded_radius(values, SimpleNamespace(Fx=Fx, Fy=Fy, Fz=Fz), np.radians(lean), omega, p)
    RL = RL + 2e-5 * draw.standard_normal(len(Fz)) + np.repeat(offset * draw.standard_normal(len(runs)), 21)
    sweep = np.repeat(np.arange(len(runs)), 21)
    return make_points(
        np.radians(side), np.radians(lean), Fz, p=p, V=16.7, phi_t=0.0, sweep=sweep,
        sweep_names=[f"run {k}" for k in range(len(runs))], Fx=Fx, Fy=Fy, RL=RL, omega=omega, kappa=0.1 * Fx / Fz,
    )  # fmt: skip


STATED = {**VALUES, "Q_V1": Q_V1, "Q_V2": Q_V2, "WIDTH": 0.225, "ASPECT_RATIO": 0.45}
"""What single speeds do not show is stated."""


def test_forces_and_camber_show_in_the_loaded_radius():
    found = vertical_coefficients({**STATED, "Q_CAM2": 0.5, "Q_CAM1": 1.0}, on_the_rig())
    for name in ("VERTICAL_STIFFNESS", "Q_RE0", "Q_FZ2", "PFZ1", "Q_FCX", "Q_FCY", "Q_CAM3"):
        q, true = found.found[name], {**LEANED, "Q_FCY": 0.2}[name]
        assert abs(q.value - true) < 0.02 * abs(true), name
        assert q.u < 0.3 * abs(true), name
    assert not found.switched
    file = {**STATED, "Q_CAM2": 0.5, "Q_CAM1": 1.0, **{name: q.value for name, q in found.found.items()}}
    assert found.agreement(file)["RL"].n == 27 * 21
    assert found.agreement(file)["RL"].rmse < 3e-5


def test_the_contour_acts_only_if_the_readings_ask_for_it():
    flat = vertical_coefficients(STATED, on_the_rig())
    assert flat.switched == {"Q_CAM1": 1.0}
    assert flat.found["Q_CAM3"].value == pytest.approx(0.5, abs=0.1)
    round_ = vertical_coefficients(STATED, on_the_rig(Q_CAM1=0.0, Q_CAM2=0.0))
    assert not round_.switched
    assert round_.found["Q_CAM3"].value == pytest.approx(0.5, abs=0.02)
    assert not vertical_coefficients(STATED, on_the_rig(), held=("Q_CAM1",)).switched


def test_an_offset_of_every_run_counts_once_however_many_its_readings():
    pulls = {name: [] for name in ("VERTICAL_STIFFNESS", "Q_FCX", "Q_FCY", "Q_CAM3", "PFZ1")}
    for seed in range(12):
        found = vertical_coefficients(
            {**STATED, "Q_CAM1": 0.8, "Q_CAM2": 0.4}, on_the_rig(offset=2e-4, seed=seed)
        )
        for name, own in pulls.items():
            q = found.found[name]
            own.append((q.value - {**LEANED, "Q_FCY": 0.2}[name]) / q.u)
    for name, own in pulls.items():
        assert 0.3 < np.sqrt(np.mean(np.square(own))) < 1.5, name


def test_what_no_force_and_no_camber_shows_stays():
    points = on_the_rig()
    upright = points.select(np.flatnonzero((points.alpha == 0.0) & (points.gamma == 0.0)))
    found = vertical_coefficients(STATED, upright).found
    assert "Q_FCX" in found
    assert not {"Q_FCY", "Q_CAM3"} & set(found)


def test_several_speeds_show_how_the_wheel_grows_and_stiffens():
    found = vertical_coefficients(VALUES, at_speeds((8.0, 16.7, 30.0))).found
    truth = {"VERTICAL_STIFFNESS": STIFFNESS, "Q_RE0": Q_RE0, "Q_V1": Q_V1, "Q_V2": Q_V2}
    for name, true in truth.items():
        value, u, *_ = found[name]
        assert abs(value - true) < 3.0 * u, name
    assert found["VERTICAL_STIFFNESS"].u < 0.01 * STIFFNESS
    assert found["Q_V2"].u < 0.3 * Q_V2


def test_what_one_speed_does_not_show_is_part_of_the_uncertainty_of_the_stiffness():
    """At one speed the wheel is stiffer by Q_V2, here 4 %, and nothing in the readings says so."""
    one = vertical_coefficients(VALUES, at_speeds((16.7,))).found
    several = vertical_coefficients(VALUES, at_speeds((8.0, 16.7, 30.0))).found
    value, u, *_ = one["VERTICAL_STIFFNESS"]
    assert not {"Q_V1", "Q_V2"} & set(one)
    assert value - STIFFNESS > 10.0 * several["VERTICAL_STIFFNESS"].u
    assert abs(value - STIFFNESS) < 2.0 * u
    stated = vertical_coefficients({**VALUES, "Q_V1": Q_V1, "Q_V2": Q_V2}, at_speeds((16.7,))).found
    assert abs(stated["VERTICAL_STIFFNESS"].value - STIFFNESS) < 0.005 * STIFFNESS
    assert stated["VERTICAL_STIFFNESS"].u < u
