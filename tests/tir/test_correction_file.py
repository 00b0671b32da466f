"""`tyre.with_correction`: a table of what the formula misses, added to the forces of its file."""

from __future__ import annotations

import itertools
import pickle
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import tir
from tir.correction import digest

VALUES = {"FNOMIN": 2000.0, "UNLOADED_RADIUS": 0.3, "NOMPRES": 2e5, "INFLPRES": 2e5, "PCY1": 1.4, "PDY1": 1.1}
TYRE = tir.Tyre.from_values({**VALUES, "PKY1": -20.0, "PKY2": 1.5, "PKY4": 2.0, "FZMAX": 3000.0})
ALPHA, LOAD, PRESSURE = (-8.0, -2.0, 0.0, 4.0, 8.0), (1000.0, 3000.0), (180.0, 200.0, 240.0)


def force(alpha_deg: float, Fz: float, p_kPa: float) -> float:
    """A miss that is linear in every input, the others held: lines between nodes follow it exactly."""
    return (3.0 + 2.0 * alpha_deg) * (Fz / 1000.0) * (1.0 - 0.002 * (p_kPa - 200.0))


def table(path: Path, *, tyre: tir.Tyre = TYRE, curvature: float = 0.0, slips: str = "") -> Path:
    """With ``slips`` it has a column ``kappa``, over which nothing changes."""
    rows = [
        f"{a},{f},{p},{force(a, f, p)},1,{0.01 * force(a, f, p)},1" + slip
        for slip in ([f",{k}" for k in slips.split()] or [""])
        for p, f, a in itertools.product(PRESSURE, LOAD, ALPHA)  # in another order than a build writes
    ]
    head = [
        "# file: front.tir",
        f"# coefficients: {digest(tyre.values)}",
        f"# phi_t_per_m: {curvature}",
        "# fading of Fy: alpha_deg 3, Fz_N 500, p_kPa inf" + (slips and ", kappa inf"),
        "# fading of Mz: alpha_deg 6, Fz_N 500, p_kPa inf" + (slips and ", kappa 0.2"),
        "alpha_deg,Fz_N,p_kPa,Fy_missed_N,u_Fy_missed_N,Mz_missed_Nm,u_Mz_missed_Nm" + (slips and ",kappa"),
    ]
    path.write_text("\n".join([*head, *rows, ""]))
    return path


@pytest.fixture
def corrected(tmp_path: Path) -> tir.Tyre:
    return TYRE.with_correction(table(tmp_path / "front-correction.csv"))


def test_a_call_adds_the_interpolated_table(corrected: tir.Tyre):
    alpha, Fz, p = 1.7, 1400.0, 215.0
    plain, found = (t(Fz, alpha=np.radians(alpha), p=1e3 * p) for t in (TYRE, corrected))
    assert found.Fy - plain.Fy == pytest.approx(force(alpha, Fz, p))
    assert found.Mz - plain.Mz == pytest.approx(0.01 * force(alpha, Fz, p))
    assert np.allclose(*([t.Fx, t.Fz, t.Mx, t.My] for t in (found, plain)), rtol=1e-12)
    assert type(found.Fy) is float


def test_arrays_are_as_single_calls(corrected: tir.Tyre):
    """Inside and outside of the grid, at the nodes and its ends."""
    alpha = np.radians([-30.0, -8.0, -3.3, 0.0, 4.0, 7.0, 8.0, 11.0])
    Fz = np.array([[500.0], [1000.0], [2100.0], [3000.0], [5000.0]])
    for more in ({}, {"limits": True}, {"Vx": -5.0}, {"phi_t": 0.1, "turn_slip": False}, {"kappa": 1}):
        many = corrected(Fz, alpha, p=190e3, **more)
        single = [[corrected(float(f[0]), float(a), p=190e3, **more) for a in alpha] for f in Fz]
        for k, name in enumerate(many._fields):
            assert many[k] == pytest.approx(np.array(single)[:, :, k], rel=1e-9, abs=1e-9), name


def test_the_miss_fades_outside_of_the_grid(corrected: tir.Tyre):
    """As a Gaussian over the length of its channel; held to the ranges of the file it does not, as the forces do not change."""

    def added(channel: str, Fz: float, alpha: float, **more: bool) -> float:
        at = {"alpha": np.radians(alpha), "p": 300e3, **more}
        return getattr(corrected(Fz, **at), channel) - getattr(TYRE(Fz, **at), channel)

    end = force(8.0, 3000.0, 240.0)
    assert added("Fy", 3000.0, 11.0) == pytest.approx(np.exp(-0.5) * end)
    assert added("Mz", 3000.0, 14.0) == pytest.approx(np.exp(-0.5) * 0.01 * end)
    assert added("Fy", 4000.0, 11.0) == pytest.approx(np.exp(-0.5 - 2.0) * end)
    assert added("Fy", 4000.0, 11.0, limits=True) == pytest.approx(end)


@pytest.mark.parametrize("limits", [False, True])
@pytest.mark.parametrize("alpha", [0.0, 0.05, 0.14])
def test_a_wheel_in_the_air_has_none_and_a_hardly_loaded_one_little(
    corrected: tir.Tyre, alpha: float, limits: bool
):
    """Over load it grows no more as the load falls below the tested ones, as forces do not."""
    loads = np.array([-300.0, 0.0, 10.0, 200.0, 500.0, 999.0])
    plain, found = (t(loads, alpha=alpha, limits=limits) for t in (TYRE, corrected))
    for name in ("Fy", "Mz"):
        added = getattr(found, name) - getattr(plain, name)
        assert np.all(added[:2] == 0.0)
        full = [getattr(t(1000.0, alpha=alpha, limits=limits), name) for t in (TYRE, corrected)]
        tested = full[1] - full[0]
        assert np.all(np.abs(added[2:] / loads[2:]) <= np.abs(tested) / 1000.0 * (1.0 + 1e-9))
        assert added[-1] == pytest.approx(tested, rel=0.01)
    assert corrected(0.0, alpha=alpha, limits=limits) == TYRE(0.0, alpha=alpha, limits=limits)


@pytest.mark.parametrize("limits", [False, True])
@pytest.mark.parametrize(("slips", "end"), [("", 0.0), ("-0.1 0.1", 0.1)], ids=["free rolling", "some slips"])
def test_over_untested_longitudinal_slip_it_goes_with_the_combined_slip(
    tmp_path: Path, slips: str, end: float, limits: bool
):
    """The share of slip that is sideslip bounds it: a locked wheel that hardly slips sideways has none."""
    tyre = TYRE.with_correction(table(tmp_path / "t.csv", slips=slips))

    def added(kappa: float, alpha: float) -> float:
        return (
            tyre(2000.0, alpha=alpha, kappa=kappa, limits=limits).Fy
            - TYRE(2000.0, alpha=alpha, kappa=kappa, limits=limits).Fy
        )

    for alpha in (0.02, 0.1):
        whole = force(np.degrees(alpha), 2000.0, 200.0)
        assert added(end, alpha) == pytest.approx(whole)
        assert added(end + 1e-3, alpha) == pytest.approx(whole, rel=1e-3)  # no step
        for side in (-1.0, 1.0):
            assert abs(added(side * (end + 0.4), alpha)) < 0.01 * abs(whole)
    assert added(end + 0.05, 0.1) / force(np.degrees(0.1), 2000.0, 200.0) > 0.85
    assert abs(added(end + 0.05, 0.0) / force(0.0, 2000.0, 200.0)) < 0.7


def test_a_length_over_longitudinal_slip_is_that_of_the_table(tmp_path: Path):
    """The moment's model error changes over longitudinal slip, so that the build knows how far it reaches."""
    tyre = TYRE.with_correction(table(tmp_path / "t.csv", slips="-0.1 0.1"))
    added = tyre(2000.0, alpha=0.02, kappa=0.3).Mz - TYRE(2000.0, alpha=0.02, kappa=0.3).Mz
    assert added == pytest.approx(np.exp(-0.5) * 0.01 * force(np.degrees(0.02), 2000.0, 200.0))


def test_nothing_is_added_backwards_and_less_on_another_path(tmp_path: Path, corrected: tir.Tyre):
    assert corrected(2000.0, 0.02, Vx=-5.0) == TYRE(2000.0, 0.02, Vx=-5.0)
    disc = TYRE.with_correction(table(tmp_path / "disc.csv", curvature=-0.5))
    for phi_t, share in ((-0.5, 1.0), (0.0, np.exp(-0.5)), (-1.0, np.exp(-0.5))):
        at = {"alpha": 0.02, "phi_t": phi_t, "turn_slip": False}
        whole = force(np.degrees(0.02), 2000.0, 200.0)
        assert disc(2000.0, **at).Fy - TYRE(2000.0, **at).Fy == pytest.approx(share * whole)


def test_it_is_pickled_and_kept_by_a_changed_copy(corrected: tir.Tyre):
    again = pickle.loads(pickle.dumps(corrected))
    assert again == corrected != TYRE
    assert again(2000.0, 0.02) == corrected(2000.0, 0.02)
    low = corrected.replace(LMUY=0.5)
    added = low(2000.0, 0.02).Fy - TYRE.replace(LMUY=0.5)(2000.0, 0.02).Fy
    assert added == pytest.approx(corrected(2000.0, 0.02).Fy - TYRE(2000.0, 0.02).Fy)


@pytest.mark.parametrize(
    "made",
    [
        lambda tyre: tyre.text(),
        lambda tyre: tir.export_c(tyre),
        lambda tyre: tir.transient.step(tyre, tir.transient.Contact(), 0.01, 2000.0, 10.0, 0.0),
    ],
    ids=["text", "C", "lag"],
)
def test_what_leaves_it_behind_says_so(corrected: tir.Tyre, made: Callable[[tir.Tyre], object]):
    with pytest.warns(tir.TirWarning, match="what it misses does not travel with it"):
        made(corrected)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        made(TYRE)


def test_another_file_is_refused(tmp_path: Path):
    """A scaling factor, a mode or a range of a simulation is no other file."""
    path = table(tmp_path / "front-correction.csv")
    TYRE.replace(LMUY=0.8, USE_MODE=14.0, FZMAX=2500.0, INFLPRES=2.2e5).with_correction(path)
    with pytest.raises(tir.TirError, match=r"front-correction.csv: belongs to front.tir as it was built"):
        TYRE.replace(PKY1=-21.0).with_correction(path)
    with pytest.raises(tir.TirError, match="cannot be read"):
        TYRE.with_correction(tmp_path / "none.csv")


def test_a_written_file_has_the_same_digest(tmp_path: Path):
    TYRE.write(tmp_path / "front.tir")
    assert digest(tir.read(tmp_path / "front.tir").values) == digest(TYRE.values)


@pytest.mark.parametrize(
    "damage",
    [
        lambda text: text[: len(text) // 2],
        lambda text: text.replace("Fy_missed_N", "Fy"),
        lambda text: text.replace("# coefficients", "# c"),
        lambda text: text.replace("\n4.0,1000", "\n5.0,1000"),
        lambda text: text.replace(",1,", ",nan,", 1),
        lambda text: "",
    ],
)
def test_a_damaged_table_is_refused(tmp_path: Path, damage: Callable[[str], str]):
    path = table(tmp_path / "front-correction.csv")
    path.write_text(damage(path.read_text()))
    with pytest.raises(tir.TirError, match=r"front-correction.csv: is not the whole table"):
        TYRE.with_correction(path)


def test_other_numbers_than_real_ones_are_refused(corrected: tir.Tyre):
    with pytest.raises(tir.TirError, match="real numbers only"):
        corrected(2000.0 + 1j, 0.02)
