"""A sweep with a wrong label is named with the label that its neighbours have."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.constants import STRAIGHT
from mffit.points import make_points
from mffit.points.other_label import _Compared as Compared
from mffit.points.other_label import other_labels

LOADS, PRESSURES = (800.0, 1600.0), (200e3, 250e3)
NOISE = 4.0
ANGLES = np.radians(np.arange(-6.0, 7.0))


def force(alpha, gamma, Fz, p, *, by_pressure=0.5):
    """A plain tyre that softens with pressure: at 200 kPa instead of 250 by a tenth."""
    softer = (p / 250e3) ** by_pressure
    return -Fz * softer * (1.2 * np.tanh(14.0 * alpha) + 0.9 * np.sin(gamma))


def campaign(
    *,
    wrong: dict[str, dict[str, float]] | None = None,
    seed: int = 1,
    scatter: float = 0.0,
    angles: np.ndarray = ANGLES,
    off: float = 0.0,
    **of_tyre,
):
    """Sweeps of sideslip at every load, camber and pressure, each twice; ``wrong`` are false labels by sweep.

    The second of each two is run at angles that are ``off`` [rad], as it records.
    """
    random = np.random.default_rng(seed)
    rows, names = [], []
    for Fz in LOADS:
        for p in PRESSURES:
            for gamma in (0.0, 0.1):
                for again in "ab":
                    name = f"{Fz:.0f}-{1e-3 * p:.0f}-{gamma:g}{again}"
                    run = angles + off * (again == "b")
                    Fy = force(run, gamma, Fz, p, **of_tyre) * (1.0 + scatter * random.standard_normal())
                    Fy = Fy + NOISE * random.standard_normal(len(run))
                    label = {"gamma": gamma, "Fz": Fz, "p": p} | (wrong or {}).get(name, {})
                    rows += [(a, *label.values(), y, len(names)) for a, y in zip(run, Fy, strict=True)]
                    names.append(name)
    alpha, gamma, Fz, p, Fy, sweep = np.array(rows).T
    return make_points(
        alpha,
        gamma,
        Fz,
        p=p,
        V=10.0,
        phi_t=0.0,
        Fy=Fy,
        u_Fy=NOISE,
        sweep=sweep.astype(int),
        sweep_names=names,
    )


@pytest.mark.parametrize("seed", range(5))
def test_right_labels_are_not_doubted(seed):
    assert not other_labels(campaign(seed=seed))
    assert not other_labels(campaign(seed=seed, scatter=0.02))


def single_sweeps(seed: int, lag: float = 0.0):
    """A moving sweep at every load, camber and pressure, up and down by turns; 30 kPa move the force by its noise or less."""
    random = np.random.default_rng(seed)
    rows, number = [], 0
    for Fz in (1500.0, 3000.0, 4500.0):
        for gamma in (0.0, 0.1, -0.1):
            for p in (210e3, 240e3, 270e3):
                sense = 1.0 - 2.0 * (number % 2)
                alpha = sense * np.radians(np.arange(-6.0, 6.1, 0.25))
                Fy = force(alpha - sense * lag, gamma, Fz, p, by_pressure=0.06)
                Fy = Fy + 0.004 * Fz * random.standard_normal(len(alpha))
                rows += [(a, gamma, Fz, p, y, number) for a, y in zip(alpha, Fy, strict=True)]
                number += 1
    alpha, gamma, Fz, p, Fy, sweep = np.array(rows).T
    given = {"p": p, "V": 10.0, "phi_t": 0.0, "Fy": Fy, "continuous": True}
    names = [f"{k:02d}" for k in range(number)]
    return make_points(alpha, gamma, Fz, **given, sweep=sweep.astype(int), sweep_names=names)


@pytest.mark.parametrize("lag", [0.0, 0.003])
def test_labels_without_repeated_sweeps_are_not_doubted_by_noise_or_lag(lag):
    assert not [seed for seed in range(15) if other_labels(single_sweeps(seed, lag))]


def test_no_camber_is_written_as_zero():
    (found,) = other_labels(campaign(wrong={"800-250-0.1a": {"gamma": 1e-6}}))
    assert "labelled 0 deg" in found.sentence


def test_a_label_that_moves_nothing_is_not_doubted():
    assert not other_labels(campaign(by_pressure=0.0))


@pytest.mark.parametrize(
    ("sweep", "wrong", "column", "other"),
    [
        ("1600-250-0a", {"p": 200e3}, "p_kPa", 250.0),
        ("800-200-0.1b", {"p": 250e3}, "p_kPa", 200.0),
        ("1600-250-0a", {"Fz": 800.0}, "Fz_N", 1600.0),
        ("800-250-0.1a", {"gamma": 0.0}, "gamma_deg", np.degrees(0.1)),
    ],
)
def test_a_sweep_that_fits_another_label_is_named_with_it(sweep, wrong, column, other):
    """It contradicts the sweeps at its own label, and agrees with those at the other."""
    (found,) = other_labels(campaign(wrong={sweep: wrong}))
    assert (found.sweep, found.column, found.of_own) == (sweep, column, True)
    assert found.other == pytest.approx(other)
    assert found.apart < 2.0 * NOISE
    assert (
        f"is its {'load' if column == 'Fz_N' else 'pressure' if column == 'p_kPa' else 'camber'}"
        in found.sentence
    )


def test_a_label_without_neighbours_is_doubted_if_it_matters_elsewhere():
    """At 1600 N all sweeps ran at 250 kPa, but one is labelled 200; at 800 N both pressures were run."""
    points = campaign(wrong={"1600-250-0a": {"p": 200e3}})
    names = points.sweep_names
    kept = [k for k, name in enumerate(names) if not name.startswith("1600-200")]
    (found,) = other_labels(points.select(np.isin(points.sweep, kept)))
    assert (found.sweep, found.column, found.of_own) == ("1600-250-0a", "p_kPa", False)
    assert "where 200 kPa moves such readings by about" in found.sentence
    deaf = campaign(wrong={"1600-250-0a": {"p": 200e3}}, by_pressure=0.0)
    assert not other_labels(deaf.select(np.isin(deaf.sweep, kept)))


@pytest.mark.parametrize("off", [0.0, 0.002])
def test_angles_that_are_a_little_off_are_brought_together_by_the_slope(off):
    """0.002 rad at 27 kN/rad are 54 N, many times the noise; the sweeps run through steps that are close together."""
    angles = STRAIGHT.rad * np.arange(-8.0, 9.0)
    assert not other_labels(campaign(angles=angles, off=off))
    (found,) = other_labels(campaign(angles=angles, off=off, wrong={"1600-250-0a": {"p": 200e3}}))
    assert (found.sweep, found.column, found.other) == ("1600-250-0a", "p_kPa", pytest.approx(250.0))


def test_the_scatter_over_the_force_is_what_noise_leaves():
    """Differences of a twentieth of the force, and noise of a hundredth of it."""
    force = np.array([200.0, 900.0, 2500.0])
    found = Compared(np.hypot(0.05 * force, 0.01 * force), 0.01 * force, force, 1)
    assert found.scatter == pytest.approx(0.05)
    assert found.variance(found.scatter) == pytest.approx(found.apart**2)
