"""Which coefficients a programme of sweeps determines, and what is missing for the others."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.fit.coverage import coverage, design
from mffit.fit.priors import scatter
from mffit.fit.stages import ODD_TERMS, SMALL_ON_A_DISC
from mffit.points import Points, make_points
from tir.parameters import TABLE

ALPHA = np.radians([-6.0, -3.0, -1.0, 0.0, 1.0, 3.0, 6.0])


def programme(*sweeps, moment=True, phi_t=-0.7, backward=True) -> Points:
    """Sideslip sweeps, each at (load [N], pressure [kPa], camber [deg])."""
    rows = [(a, np.radians(g), Fz, 1e3 * p, 1) for Fz, p, g in sweeps for a in ALPHA]
    if backward:
        rows += [(0.0, 0.0, rows[0][2], rows[0][3], -1)]
    alpha, gamma, Fz, p, direction = np.array(rows).T
    points = make_points(alpha, gamma, Fz, p=p, V=6.0, phi_t=phi_t, direction=direction.astype(int))
    return points.replace(
        Fy=-10.0 * Fz * alpha, Mz=0.1 * Fz * alpha if moment else np.full(len(rows), np.nan)
    )


LOADS = [(Fz, 250.0, g) for Fz in (900.0, 1400.0, 2100.0) for g in (0.0, 20.0)]
PRESSURES = [(1400.0, 200.0, 0.0), (1400.0, 300.0, 0.0), (1400.0, 200.0, 20.0)]
FULL = [*LOADS, *PRESSURES, (2100.0, 200.0, 0.0)]


def held(points, side="unknown") -> dict[str, str]:
    """Held coefficient -> the sentences of its stage."""
    return {name: "; ".join(row.missing) for row in coverage(points, side) for name in row.held}


def test_a_full_programme_frees_everything_that_a_stage_names():
    assert not held(programme(*FULL))


def test_braking_alone_shows_nothing_of_the_side():
    """Sideslip and camber that only scatter around zero: cornering stiffness, friction and trail cannot follow from them."""
    rng = np.random.default_rng(2)
    kappa = np.tile(np.linspace(-0.12, 0.0, 13), 3)
    alpha, gamma = rng.normal(0.0, 2e-4, (2, 39))
    points = make_points(
        alpha, gamma, np.repeat([900.0, 1400.0, 2100.0], 13), kappa=kappa, p=250e3, V=6.0, phi_t=0.0
    )
    points = points.replace(
        Fx=20.0 * points.Fz * kappa, Fy=rng.normal(0.0, 5.0, 39), Mz=rng.normal(0.0, 0.3, 39)
    )
    found = held(points)
    assert {row.name for row in TABLE if row.stage in ("Fy", "trail")} <= found.keys()
    assert found.keys().isdisjoint({"PKX1", "PDX1", "PCX1", "PEX1"})


@pytest.mark.parametrize(
    ("sideslips", "known"), [((6.0,), False), ((-6.0, 6.0), False), ((0.0, 6.0), True), ((0.0,), False)]
)
def test_how_sideslip_weakens_the_longitudinal_force_needs_two_sizes_of_it(sideslips, known):
    """At one size every weight of combined slip is a factor of the pure force."""
    kappa = np.tile(np.linspace(-0.12, 0.0, 13), len(sideslips))
    alpha = np.radians(np.repeat(sideslips, 13))
    points = make_points(alpha, 0.0, 1400.0, kappa=kappa, p=250e3, V=6.0, phi_t=0.0)
    points = points.replace(Fx=20.0 * points.Fz * kappa, Fy=-10.0 * points.Fz * alpha)
    assert ("RBX1" not in held(points)) == known
    assert "PKX1" not in held(points)


def test_pressures_at_one_load_hold_the_pressure_effect_on_the_load_of_peak_stiffness():
    found = held(programme(*LOADS, *PRESSURES))
    assert set(found) == {"PPY2"}
    assert found["PPY2"].startswith("pressures were run at one load only")
    assert design(programme(*LOADS, *PRESSURES), "").run["pressure_loads"] == 1


def test_a_wheel_that_only_rolls_shows_nothing_of_the_cornering_stiffness():
    """Radii were measured at every load and pressure, sideslip at other pressures at one load only."""
    swept = programme(*LOADS, *PRESSURES, phi_t=0.0, backward=False)
    Fz, p = (np.repeat(x, 3) for x in np.meshgrid((900.0, 1400.0, 2100.0), (200e3, 250e3, 300e3)))
    rows = len(swept) + len(Fz)
    both = make_points(
        np.append(swept.alpha, 0.0 * Fz), np.append(swept.gamma, 0.0 * Fz), np.append(swept.Fz, Fz),
        p=np.append(swept.p, p), V=6.0, phi_t=0.0, Fy=np.zeros(rows), Mz=np.zeros(rows),
    )  # fmt: skip
    assert design(both, "").run["pressure_loads"] == 1
    assert held(both)["PPY2"]


def test_one_pressure_per_load_holds_the_pressure_effect_on_the_load_of_peak_stiffness():
    found = held(programme(*LOADS[:4], (2100.0, 200.0, 0.0), (2100.0, 200.0, 20.0)))
    assert found["PPY2"].startswith("pressures were run at different loads only")


@pytest.mark.parametrize(
    ("sweeps", "changes", "names", "sentence"),
    [
        (FULL, {"moment": False}, {"QBZ1", "PPZ1", "QDTP1"}, "Mz was not measured"),
        (FULL, {"phi_t": 0.0}, {"PKYP1", "QCRP1"}, "the path is straight"),
        (FULL, {"backward": False}, {"PHY1", "PVY1", "QHZ1"}, "backward runs"),
        ([s for s in FULL if s[2] == 0.0], {}, {"PKY6", "QDZ8", "PPY5", "PPZ2"}, "no camber was run"),
        ([s for s in FULL if s[2] == 0.0], {}, {"PKY3", "QBZ5", "QEZ5"}, "combines sideslip and camber"),
        (LOADS[2:], {}, {"PKY4", "QBZ3", "QEZ3"}, "3 loads are needed, 2 run"),
        (LOADS[:2], {}, {"PKY2", "PDY2", "QDZ2", "PKY7", "PDYP2"}, "2 loads are needed, 1 run"),
        (LOADS, {}, {"PPY1", "PPY3", "PPZ1", "PPY2"}, "2 pressures are needed, 1 run"),
        ([*LOADS, PRESSURES[0], (2100.0, 200.0, 0.0)], {}, {"PPY4"}, "3 pressures are needed, 2 run"),
    ],
)
def test_what_is_missing_holds_its_coefficients(sweeps, changes, names, sentence):
    found = held(programme(*sweeps, **changes))
    assert names <= set(found)
    assert any(sentence in found[name] for name in names)


ASYMMETRIES = {"PVY1", "PVY2", "PEY3", "QHZ1", "QHZ2", "QEZ4", "QBZ4", "QDZ3"}


def test_sideslip_to_one_side_shows_no_asymmetry():
    """One curve is a symmetric tyre's with a larger friction as well as a conical tyre's with a smaller one."""
    both = programme(*FULL, phi_t=0.0, backward=False)
    one = both.select(np.flatnonzero(both.alpha > -0.01))
    found = held(one)
    assert set(found) >= ASYMMETRIES
    assert not ASYMMETRIES & set(held(both))
    assert all("run sideslip of the other sign" in found[name] for name in ASYMMETRIES)
    assert "PHY1" not in found, "the force at zero sideslip shows it"


def test_a_tyre_turned_on_its_rim_shows_its_conicity_from_one_side():
    one = programme(*FULL, phi_t=0.0, backward=False)
    one = one.select(np.flatnonzero(one.alpha > -0.01))
    turned = one.replace(mount=np.where(one.p < 240e3, -1, 1))
    assert {"QHZ1", "QEZ4"} <= set(held(turned)), "ply-steer stays as it is when a tyre is turned on its rim"
    assert not {"PVY1", "PVY2", "PEY3"} & set(held(turned))


def test_unseen_conicity_is_as_large_as_among_tyres_whatever_the_base_file_says():
    """Conicity is one of the single tyre; on a disc it is known to be small."""
    common = {"expected": 0.012, "from_base": True}
    assert scatter("PVY1", **common, curved=False, unseen_side=True) == pytest.approx(0.045)
    assert scatter("PVY1", **common, curved=False) == pytest.approx(0.015)
    assert scatter("PVY1", **common, curved=True, unseen_side=True) == pytest.approx(0.003)


def test_a_disc_keeps_its_small_prior_of_conicity():
    one = programme(*FULL)
    one = one.select(np.flatnonzero(one.alpha > -0.01))
    assert "PVY1" not in held(one)
    assert "QEZ4" in held(one)


def test_a_symmetric_tyre_has_no_odd_terms():
    found = held(programme(*FULL), side="symmetric")
    listed = {row.stage for row in coverage(programme(*FULL), "symmetric")}
    assert set(found) == {row.name for row in TABLE if row.odd and row.stage in listed}


def test_the_coverage_has_a_rule_for_every_need_in_the_table():
    """A need without a rule would raise a KeyError in the first campaign that meets the other needs."""
    assert len(coverage(programme((1500.0, 250.0, 0.0)), "")) == len(coverage(programme(*FULL), ""))


def test_the_sets_of_the_stages_are_the_tables():
    assert {row.name for row in TABLE if row.shift} < ODD_TERMS
    assert SMALL_ON_A_DISC == {"PHY1": 0.002, "PVY1": 0.003, "PVY2": 0.003}
    rolling = {row.name for row in TABLE if row.odd and row.stage in ("shift", "trail", "residual")}
    assert rolling == {row.name for row in TABLE if row.symmetric_spread is not None} | SMALL_ON_A_DISC.keys()


def braked(*combined) -> Points:
    """Sideslip at three loads, two pressures and two cambers, and braking at every combination of sideslip and camber [deg]."""
    rows = [(a, np.radians(g), 0.0, Fz, 1e3 * p) for Fz, p, g in FULL for a in ALPHA]
    slips, loads = np.linspace(-0.12, 0.03, 11), (900.0, 1400.0, 2100.0)
    rows += [(*np.radians((a, g)), k, Fz, 250e3) for a, g in combined for Fz in loads for k in slips]
    alpha, gamma, kappa, Fz, p = np.array(rows).T
    points = make_points(alpha, gamma, Fz, kappa=kappa, p=p, V=6.0, phi_t=0.0)
    return points.replace(Fx=20.0 * Fz * kappa, Fy=-10.0 * Fz * alpha, Mz=0.1 * Fz * alpha)


@pytest.mark.parametrize(
    ("combined", "free"),
    [
        ([(0, 0), (3, 0), (6, 0)], set()),
        ([(0, 0), (3, 0), (-3, 0)], {"RHX1", "RBY3"}),
        ([(0, 0), (3, 0), (3, 4)], {"RBX3", "RBY4", "PDX3", "RVY3"}),
    ],
)
def test_a_coefficient_of_combined_slip_needs_its_conditions_together(combined, free):
    """Camber without slip, and slip without camber, do not show how camber changes the force under slip."""
    needing = {"RHX1", "RBY3", "RBX3", "RBY4", "PDX3", "RVY3", "PPX1", "PPX3"}
    found = held(braked(*combined))
    assert needing - found.keys() == free


OF_PRESSURE = {"PPX1", "PPX3"}
OF_CAMBER = {"PDX3", "RBX3", "RBY4", "RVY3", "SSZ3", "SSZ4"}


def slip_beside_sideslip(*slipping) -> Points:
    """Sideslip at three loads, with camber and at two pressures, and slip at (sideslip [deg], camber [deg], pressure [kPa])."""
    rolling = [(a, g, 0.0, Fz, p) for Fz, p, g in FULL for a in ALPHA]
    slip = np.linspace(-0.2, 0.2, 9)
    driven = [
        (np.radians(a), g, k, Fz, p) for a, g, p in slipping for Fz in (900.0, 1400.0, 2100.0) for k in slip
    ]
    alpha, gamma, kappa, Fz, p = np.array([*rolling, *driven]).T
    points = make_points(alpha, np.radians(gamma), Fz, kappa=kappa, p=1e3 * p, V=6.0, phi_t=0.0)
    Fy = -10.0 * Fz * alpha
    return points.replace(Fx=20.0 * Fz * kappa - 0.01 * Fz, Fy=Fy, Mz=-0.03 * Fy)


def test_a_wheel_that_rolls_freely_shows_nothing_of_longitudinal_slip():
    """Rolling resistance and its moment change with camber and pressure, too; slip at both alone tells its own effects."""
    apart = slip_beside_sideslip((0.0, 0.0, 250.0), (4.0, 0.0, 250.0), (-4.0, 0.0, 250.0))
    found = held(apart)
    assert set(found) >= OF_PRESSURE | OF_CAMBER
    assert found.keys().isdisjoint({"PDX2", "PKX3", "RBX1", "REX2", "SSZ2", "PPY1", "PKY6", "PPY5"})
    assert "2 pressures are needed with longitudinal slip, 1 run" in found["PPX1"]
    assert "no camber was run with longitudinal slip under sideslip" in found["RBX3"]
    leaning = slip_beside_sideslip((0.0, 0.0, 250.0), (0.0, 4.0, 250.0), (4.0, 0.0, 250.0))
    assert (OF_CAMBER | OF_PRESSURE) & held(leaning).keys() == {"RBX3", "RBY4", *OF_PRESSURE}
    everything = slip_beside_sideslip((0.0, 0.0, 250.0), (4.0, 4.0, 250.0), (4.0, 0.0, 200.0))
    assert not (OF_CAMBER | OF_PRESSURE) & held(everything).keys()


def test_a_camber_that_was_run_at_one_load_shows_nothing_of_its_change_with_load():
    found = held(programme(*[s for s in FULL if s[2] == 0.0], (1400.0, 250.0, 20.0), (1400.0, 200.0, 20.0)))
    assert found.keys() == {"PKY7", "PVY4", "QDZ9", "QDZ11", "QHZ4"}
    assert "2 loads are needed with camber, 1 run" in found["PKY7"]
