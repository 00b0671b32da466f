"""Regions of misfit and structure without a name are found with their place and size."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from small_programme import TYRE, U_FY, U_MZ, problem, programme, read

from mffit import config
from mffit.diagnosis import Asked, diagnose
from mffit.diagnosis.bumps import _bells, bump_scan
from mffit.diagnosis.inexact import columns_of, declared
from mffit.diagnosis.needs import MET, missing, possible
from mffit.diagnosis.noise import Noise, Origin
from mffit.diagnosis.notes import NotVisible
from mffit.diagnosis.priors import declared_priors
from mffit.diagnosis.rest import RestKind
from mffit.diagnosis.stated import stated_noise, with_uncertainties
from mffit.diagnosis.strangers import refuse_strangers
from mffit.diagnosis.where import where
from mffit.effects import CATALOG, OF_CHANNEL
from mffit.errors import InputError
from mffit.fit.plan import channels_of
from mffit.points import make_points
from mffit.quantities import SIDEWAYS
from mffit.rig import Simulation
from mffit.rig_errors import RIG_ERRORS, Faults

BY_ID = {effect.id: effect for effect in CATALOG}


@pytest.mark.parametrize(
    ("name", "mask", "limits"),
    [
        ("Fz_N", lambda p: p.Fz > 1500.0, (1800.0, 1800.0)),
        ("direction", lambda p: p.direction < 0, (-1.0, -1.0)),
        ("alpha_deg", lambda p: p.alpha > 0.09, None),
        ("gamma_deg", lambda p: p.gamma < -0.3, None),
        ("p_kPa", lambda p: p.p > 240e3, (250.0, 250.0)),
        ("V_mps", lambda p: p.V > 8.0, (12.0, 12.0)),
        ("T_degC", lambda p: p.T > 50.0, (60.0, 60.0)),
    ],
)
def test_a_shift_in_one_part_is_found_there(name, mask, limits):
    n = len(programme())
    rng = np.random.default_rng(1)
    points = read(
        programme(
            p=rng.choice([200e3, 250e3], n), V=rng.choice([6.0, 12.0], n), T=rng.choice([30.0, 60.0], n)
        ),
        noise=4,
    )
    chosen, shifted = problem(points), mask(points)
    residual = chosen.measured - chosen.start.predict(points)
    residual[: len(points)] += 40.0 * shifted
    first = where(points, residual, chosen.noise)[0]
    assert first.channel == "Fy"
    assert name in first.region
    if limits:  # else the bins need not end where the shift does
        assert first.region[name] == limits
        assert first.bias == pytest.approx(40.0, abs=8.0)
    assert 8.0 < first.bias < 48.0


def test_significance_is_the_mean_over_its_standard_error():
    """z = 30 / (6 / sqrt(m)) for m points of 6 N that are 30 N off."""
    points = read(programme())
    chosen = problem(points)
    residual = np.zeros(2 * len(points))
    heavy = points.Fz > 1500.0
    residual[: len(points)][heavy] = 30.0
    first = where(points, residual, chosen.noise)[0]
    assert first.bias == pytest.approx(30.0)
    assert first.z == pytest.approx(30.0 / (U_FY / math.sqrt(heavy.sum())))
    assert first.region == {"Fz_N": (1800.0, 1800.0)}


def test_a_region_is_listed_once():
    points = read(programme(), noise=6)
    chosen = problem(points)
    residual = chosen.measured - chosen.start.predict(points)
    residual[: len(points)] += 40.0 * (points.Fz > 1500.0)
    found = where(points, residual, chosen.noise)
    assert 1 <= len(found) <= 12
    assert [abs(r.z) for r in found] == sorted((abs(r.z) for r in found), reverse=True)
    assert sum(r.region.get("Fz_N") == (1800.0, 1800.0) and len(r.region) == 1 for r in found) == 1


def bell(degrees, centre, width):
    return np.exp(-0.5 * ((degrees - centre) / width) ** 2)


@pytest.mark.parametrize(
    ("channel", "column", "centre", "only"),
    [
        *(("Fy", "alpha_deg", 3.0, only) for only in (None, "load", "backwards")),
        *(("Mz", "alpha_deg", -4.0, only) for only in (None, "load", "backwards")),
        ("Fy", "gamma_deg", 20.0, None),
    ],
)
def test_a_bump_is_found_with_its_place_and_size(channel, column, centre, only):
    points = read(programme())
    over = {"alpha_deg": (points.alpha, 1.4), "gamma_deg": (points.gamma, 8.0)}
    angle, width = over[column]
    mask = {None: 1.0, "load": points.Fz > 1500.0, "backwards": points.direction < 0}[only]
    size = {"Fy": 80.0, "Mz": 6.0}[channel]
    bump = size * bell(np.degrees(angle), centre, width) * mask
    channels = {"Fy": points.Fy, "Mz": points.Mz}
    bumpy = problem(points.replace(**{channel: channels[channel] + bump}))
    found = bump_scan(points, bumpy.noise).best(bumpy.null)
    assert found.found
    assert found.channel == channel
    low, high = found.region[column]
    assert low < centre < high
    assert high - low < 20.0
    assert found.amplitude == pytest.approx(size, rel=0.15)
    if only == "load":
        assert found.region["Fz_N"] == (1800.0, 1800.0)
    elif only == "backwards":
        assert found.region["direction"] == (-1.0, -1.0)
    # Evidence of a linear number with a prior: half the chi2 it takes away, less its price.
    assert found.gain < 0.5 * bumpy.null.chi2
    assert found.gain > 0.4 * bumpy.null.chi2 - 20.0


def test_a_bump_is_a_bell_of_its_width():
    """exp(-1/2) of its height one width beside its centre, on both sides."""
    points = make_points(np.radians(np.arange(-8.0, 8.01, 0.25)), 0.0, 1500.0, p=250e3, V=6.0, phi_t=0.0)
    for region, height in _bells("alpha_deg", points, (1.0, 2.0)):
        low, high = region["alpha_deg"]
        away = np.abs(np.degrees(points.alpha) - 0.5 * (low + high)) / (0.5 * (high - low))
        np.testing.assert_allclose(height[away <= 1.0], np.exp(-0.5 * away[away <= 1.0] ** 2), rtol=1e-9)
        assert np.all(height[away > 1.0] < np.exp(-0.5))


def test_a_declared_side_force_is_an_angle_by_the_cornering_stiffness_at_zero():
    """25 N at the median load, 1000 N, to 5 %: turn slip and shifts move the slope a little."""
    content = {
        "tyre": {"name": "a", "unloaded_radius": 0.2992, "nominal_load": 1400, "nominal_pressure": 250},
        "rig": {"path_radius": 1.323, "u_slip_alignment_N": 25.0},
        "sweep": [{"file": "a.csv"}],
    }
    value, u = declared_priors(config.load(content), programme(), Simulation.of(TYRE))["alpha_0_deg"]
    assert value == 0.0
    assert u == pytest.approx(math.degrees(25.0 / abs(float(TYRE.state(1000.0, Vx=6.0).K_ya))), rel=0.05)


def test_noise_has_no_bump():
    for seed in range(3):
        chosen = problem(read(programme(), noise=seed))
        assert not bump_scan(chosen.points, chosen.noise).best(chosen.null).found


def test_a_misfit_that_a_hypothesis_explains_is_not_a_bump():
    """A camber stiffness off by a tenth looks like structure over camber until it is freed."""
    chosen = problem(read(programme(), TYRE.replace(PKY6=1.1 * float(TYRE["PKY6"])), noise=1))
    scan = bump_scan(chosen.points, chosen.noise)
    assert scan.best(chosen.null).found
    assert not scan.best(chosen.fit((BY_ID["camber-stiffness"],))).found


TWO_SWEEPS = {"sweep": [0, 0, 1, 1], "sweep_names": ("up", "again")}
CONDITIONS = {
    "curved": ({"phi_t": [0.0, -0.7]}, {"phi_t": 0.0}),
    "spin": ({"gamma": [0.0, 0.25]}, {"gamma": [0.0, 0.15]}),
    "camber": ({"gamma": [0.0, 0.04]}, {"gamma": [0.0, 0.01]}),
    "coupled": ({"gamma": [0.0, 0.3], "alpha": [0.0, 0.05]}, {"gamma": [0.0, 0.3], "alpha": [0.05, 0.0]}),
    "directions": ({"direction": [1, -1]}, {"direction": -1}),
    "slip": ({"alpha": [-0.03, 0.03]}, {"alpha": [-0.003, 0.003]}),
    "loads": ({"Fz": [1000.0, 1200.0]}, {"Fz": [1000.0, 1050.0]}),
    "pressures": ({"p": [250e3, 265e3]}, {"p": [250e3, 255e3]}),
    "moment": ({"Mz": [np.nan, 1.0]}, {"Mz": np.nan}),
    "temperatures": ({"T": [25.0, 29.0]}, {"T": [25.0, 27.0]}),
    "speeds": ({"V": [6.0, 7.0]}, {"V": [6.0, 6.3]}),
    "times": ({"t": [0.0, 90.0]}, {"t": [0.0, 30.0]}),
    # Slow, then four times as fast; or both in turn, so that every step takes the same distance.
    "distances": (
        {"t": [0.0, 100.0, 200.0, 300.0], "V": [5.0, 5.0, 5.0, 20.0]},
        {"t": [0.0, 100.0, 200.0, 300.0], "V": [5.0, 20.0, 5.0, 20.0]},
    ),
    # Up and down again; or up twice, where the way back is between the sweeps.
    "senses": (
        {"alpha": [0.0, 0.1, 0.1, 0.0], **TWO_SWEEPS},
        {"alpha": [0.0, 0.1, 0.0, 0.1], **TWO_SWEEPS},
    ),
    "runs": (
        {"file": [0, 1, 2, 3], "files": ("a", "b", "c", "d")},
        {"file": [0, 1, 2, 2], "files": ("a", "b", "c", "d")},
    ),
    "continuous": ({"continuous": [False, True]}, {"continuous": False}),
    "drive": ({"kappa": [0.0, 0.05], "Fx": [0.0, 900.0]}, {"kappa": 0.0, "Fx": [0.0, 5.0]}),
    "combined": (
        {"kappa": [0.0, 0.05], "alpha": [0.0, 0.05]},
        {"kappa": [0.0, 0.05], "alpha": [0.05, 0.0]},
    ),
    "combined_camber": (
        {"kappa": [0.0, 0.05], "alpha": [0.0, 0.05], "gamma": [0.0, 0.05]},
        {"kappa": [0.0, 0.05], "alpha": [0.0, 0.05], "gamma": [0.05, 0.0]},
    ),
    "overturning": ({"Mx": [np.nan, 1.0]}, {"Mx": np.nan}),
}


@pytest.mark.parametrize("need", MET)
def test_a_need_is_met_above_its_threshold_only(need):
    plain = {"alpha": 0.0, "gamma": 0.0, "Fz": 1400.0, "p": 250e3, "V": 6.0, "phi_t": 0.0}
    plain["mount"] = [1] * (4 if need in ("distances", "senses", "runs") else 2)
    enough, too_little = (make_points(**plain | changes) for changes in CONDITIONS[need])
    assert MET[need](enough)
    assert not MET[need](too_little)


def test_only_what_is_missing_is_said():
    """The speeds differ and every point has its time, but both speeds in turn make the distance grow with the time."""
    t, V = np.arange(40.0) * 10.0, np.tile([16.0, 30.0], 20)
    points = make_points(np.tile([-0.1, 0.1], 20), 0.0, 1400.0, p=250e3, V=V, phi_t=0.0, t=t)
    assert missing(BY_ID["wear"], points) == ("distances",)
    assert missing(BY_ID["wear"], points.replace(t=np.full(40, np.nan))) == ("times", "distances")


def test_invisible_effects_are_not_tried():
    points = read(programme(phi_t=0.0, T=np.nan))
    tried, notes = possible(CATALOG, points, Simulation.of(TYRE))
    assert {e.id for e in tried}.isdisjoint(
        {"camber-reduction", "temperature", "turn-slip", "pressure", "relaxation"}
    )
    assert {e.id for e in tried} >= {"ply-steer", "camber-stiffness", "loadcell-gain"}
    lacking = {e.id for note in notes if isinstance(note, NotVisible) for e in note.effects}
    unmeasured = {e.id for e in CATALOG if OF_CHANNEL & set(e.needs)}
    assert {e.id for e in CATALOG} - {e.id for e in tried} - {"turn-slip"} <= lacking | {
        "turn-slip"
    } | unmeasured
    assert all(missing(e, points) == () for e in tried)


def test_effects_of_fx_and_mx_are_tried_only_where_these_channels_are_fitted():
    """A project of Fy and Mz has as many candidates as before, and no note on effects of other channels."""
    plain = read(programme())
    tried, notes = possible(CATALOG, plain, Simulation.of(TYRE))
    before, listed = possible(
        [e for e in CATALOG if not OF_CHANNEL & set(e.needs)], plain, Simulation.of(TYRE)
    )
    assert (tried, notes) == (before, listed)
    n = len(plain)
    slips, moment = np.tile([-0.05, 0.05], n)[:n], np.zeros(n)
    for channels, needs in (
        ({"kappa": slips, "Fx": 1e4 * slips}, {"drive"}),
        ({"Mx": moment}, {"overturning"}),
        ({"Fx": moment}, set()),
    ):
        points = plain.replace(**channels)
        assert {need for need in OF_CHANNEL if MET[need](points)} == needs
        fitted = {
            {"Fx": "drive", "Mx": "overturning"}[name] for name in channels_of(points) if name not in SIDEWAYS
        }
        assert fitted == needs
        more = {e.id for e in possible(CATALOG, points, Simulation.of(TYRE))[0]} - {e.id for e in tried}
        assert bool(more) is bool(needs)
        assert all(needs & set(e.needs) for e in CATALOG if e.id in more)


@pytest.mark.parametrize("simulated", [True, False])
def test_turn_slip_is_a_candidate_only_if_it_is_not_simulated(simulated):
    tried, _ = possible(CATALOG, read(programme()), Simulation.of(TYRE, turn_slip=simulated))
    assert ("turn-slip" in {e.id for e in tried}) is not simulated


@pytest.mark.parametrize(("factor", "refused"), [(0.12, False), (0.08, True), (8.0, False), (12.0, True)])
def test_a_model_of_another_size_is_refused(factor, refused):
    points = read(programme())
    tyre = TYRE.replace(FNOMIN=float(np.median(points.Fz)) / factor)
    if refused:
        with pytest.raises(InputError, match="differ by an order of magnitude"):
            refuse_strangers(points, tyre, Simulation.of(TYRE))
    else:
        refuse_strangers(points, tyre, Simulation.of(TYRE))


def test_eight_points_are_the_fewest():
    points = read(programme())
    refuse_strangers(points.select(np.arange(8)), TYRE, Simulation.of(TYRE))
    with pytest.raises(InputError, match="7 points are too few for a diagnosis; measure at least 8"):
        refuse_strangers(points.select(np.arange(7)), TYRE, Simulation.of(TYRE))


def test_moments_in_other_axes_are_refused_by_name():
    points = read(programme())
    with pytest.raises(InputError, match="simulated and measured Mz have opposite signs"):
        refuse_strangers(points.replace(Mz=-points.Mz), TYRE, Simulation.of(TYRE))


def test_the_scatter_of_neighbours_is_the_noise():
    """Smooth curves with 6 N of noise, no uncertainty stated. Third differences of white noise have 20 times its variance."""
    alpha = np.tile(np.radians(np.linspace(-8.0, 8.0, 161)), 4)
    points = make_points(
        alpha,
        0.0,
        1400.0,
        p=250e3,
        V=6.0,
        phi_t=-0.75,
        sweep=np.repeat(range(4), 161),
        sweep_names=tuple("abcd"),
    )
    points = read(points, noise=8)
    off = Simulation.of(TYRE.replace(PDY1=0.9 * float(TYRE["PDY1"])))  # a model that is wrong, but smoothly
    found, source = with_uncertainties(points.replace(u_Fy=np.nan, u_Mz=np.nan), off)
    assert found.u_Fy == pytest.approx(6.0, rel=0.2)
    assert found.u_Mz == pytest.approx(0.6, rel=0.2)
    assert source is Origin.SCATTER


def test_sweeps_too_short_for_a_scatter_get_a_hundredth_of_the_span():
    points = read(programme())
    few = points.select(np.flatnonzero(points.sweep == 1)[:5]).replace(u_Fy=np.nan, u_Mz=np.nan)
    found, _ = with_uncertainties(few, Simulation.of(TYRE.replace(PKY6=0.5 * float(TYRE["PKY6"]))))
    wrong = Simulation.of(TYRE.replace(PKY6=0.5 * float(TYRE["PKY6"]))).readings(few)
    assert found.u_Fy == pytest.approx(0.01 * np.ptp(few.Fy - wrong.Fy))


def inexact_noise(points, u_coefficients) -> Noise:
    """The stated noise with inexact coefficients."""
    return stated_noise(points).sharing(
        columns_of(declared(TYRE, u_coefficients), Simulation.of(TYRE), points)
    )


def covariance(noise):
    """Covariance of the used readings, from their whitening."""
    white = noise.whiten(np.eye(len(noise.u)))[:, noise.used]
    return np.linalg.inv(white.T @ white)


def test_inexact_coefficients_correlate_the_readings():
    """cov = u^2 + sum over coefficients of (u_c c dF/dc)^2, with products between readings."""
    points = read(programme()).select(np.arange(0, 60, 4))
    exact, inexact = stated_noise(points), inexact_noise(points, 0.02)
    up, down = (
        Simulation.of(TYRE.replace(PDY1=float(TYRE["PDY1"]) * f)).predict(points) for f in (1.001, 0.999)
    )
    whole, without = covariance(inexact), covariance(exact)
    n = len(points)
    assert without == pytest.approx(np.diag(np.repeat([U_FY**2, U_MZ**2], n)), abs=1e-9)
    by_grip = 0.02 * (up - down) / 0.002
    # What one coefficient does to the variance is contained in the whole, in every direction.
    rest = np.linalg.eigvalsh(whole - without - np.outer(by_grip, by_grip))
    assert rest.min() > -1e-6 * rest.max()
    assert np.all(np.diag(whole) >= np.diag(without) + by_grip**2 - 1e-6)
    assert np.linalg.norm(inexact.whiten(by_grip)) < 1.0 < np.linalg.norm(exact.whiten(by_grip))
    assert inexact.error_of_sum(np.array([0, 1])) == pytest.approx(math.sqrt(whole[:2, :2].sum()))


def test_a_larger_scatter_does_not_change_the_inexactness_of_the_model():
    points = read(programme())
    noise = inexact_noise(points, 0.02)
    thrice = replace(noise, u=3.0 * noise.u)
    larger = covariance(thrice) - covariance(noise)
    assert larger == pytest.approx(np.diag(8.0 * noise.stated**2), abs=1e-5)
    assert thrice.alone().whiten(noise.u) == pytest.approx(noise.alone().whiten(noise.u) / 3.0)


THREE = ("load-grip", "camber-stiffness", "loadcell-offset-mz")
HIDDEN = TYRE.replace(PDY2=float(TYRE["PDY2"]) + 0.25, PKY6=1.3 * float(TYRE["PKY6"]))


EXACT_RIG = dict.fromkeys((error.declared.key for error in RIG_ERRORS if error.declared), 0.0)
SETTINGS = config.load(
    {
        "tyre": {
            "name": "small",
            "unloaded_radius": 0.2998,
            "nominal_load": 1500.0,
            "nominal_pressure": 250.0,
        },
        "rig": {"path_radius": 1.323, **EXACT_RIG},
        "model": {"u_coefficients": 0.0},
        "sweep": [{"file": "points.csv"}],
    }
)


def three_effects(understated: float, strange: float = 0.0, alike: int = 1, strange_moment: float = 0.0):
    """Three hidden effects, and beside the noise a ``strange`` error [N, Nm] that ``alike`` neighbours share."""
    points = read(programme(), HIDDEN, Faults(M0_Nm=6.0), noise=9)
    n, rng = len(points), np.random.default_rng(3)
    Fy, Mz = (
        reading + size * np.repeat(rng.standard_normal(n), alike)[:n]
        for reading, size in ((points.Fy, strange), (points.Mz, strange_moment))
    )
    stated = points.replace(Fy=Fy, Mz=Mz, u_Fy=U_FY / understated, u_Mz=U_MZ / understated)
    return diagnose(stated, TYRE, SETTINGS, Asked(effects=[BY_ID[name] for name in THREE]))


def answers(found):
    """Value and standard error of every number of the effects that were named."""
    return {name: answer for f in found.effects for name, answer in f.parameters.items()}


def assert_true(found):
    """All three are named, with their sizes."""
    assert {f.effect.id for f in found.effects} == set(THREE)
    for name, true in (("PKY6", HIDDEN["PKY6"]), ("PDY2", HIDDEN["PDY2"]), ("M0_Nm", 6.0)):
        value, error = answers(found)[name]
        assert abs(value - true) < 4.0 * error, name


def test_noise_larger_than_stated_is_found_and_does_not_hide_the_effects():
    found = three_effects(2.5)
    assert found.noise.scatter["Fy"].scale == pytest.approx(2.5, rel=0.25)
    assert found.noise.typically_stated("Fy") == pytest.approx(U_FY / 2.5)
    assert_true(found)
    # The uncertainty of an answer is that of the noise that is really there.
    stated = three_effects(1.0)
    assert stated.noise.scatter["Fy"].scale == pytest.approx(1.0, abs=0.25)
    assert answers(found)["M0_Nm"][1] == pytest.approx(answers(stated)["M0_Nm"][1], rel=0.25)


def test_errors_that_neighbours_share_count_as_fewer_readings():
    """Errors of the same size, common to three neighbours, make the answers less certain."""
    independent, shared = (three_effects(1.0, strange=20.0, alike=alike) for alike in (1, 3))
    assert independent.noise.scatter["Fy"].memory.correlation == 0.0
    # Two of three neighbours share 20 N of hypot(20, 6) N.
    assert shared.noise.scatter["Fy"].memory.correlation == pytest.approx(2.0 / 3.0 * 400.0 / 436.0, abs=0.2)
    assert_true(independent)
    assert_true(shared)
    for name in ("PKY6", "PDY2"):
        per_noise = [answers(found)[name][1] / found.noise.typical("Fy") for found in (independent, shared)]
        # Up to sqrt((1 + 0.61) / (1 - 0.61)) = 2 for what changes slowly along a sweep.
        assert 1.25 < per_noise[1] / per_noise[0] < 2.2, name


def test_a_noisy_channel_does_not_spoil_the_answers_of_the_other():
    """Forces scatter by 100 N instead of the stated 2.4 N; moments keep their weight."""
    found, quiet = three_effects(2.5, strange=100.0), three_effects(2.5)
    assert found.noise.typical("Fy") == pytest.approx(math.hypot(100.0, U_FY), rel=0.2)
    assert found.noise.typical("Mz") == pytest.approx(U_MZ, rel=0.2)
    assert_true(found)
    assert answers(found)["M0_Nm"][1] == pytest.approx(answers(quiet)["M0_Nm"][1], rel=0.2)
    assert answers(found)["PDY2"][1] > 5.0 * answers(quiet)["PDY2"][1]


def test_a_model_that_no_effect_improves_hardly_belongs_to_this_tyre():
    """With any effects, both channels miss by 42 times their stated noise: naming a cause would be a guess."""
    found = three_effects(2.5, strange=100.0, strange_moment=10.0)
    first = found.rest[0]
    assert first.kind is RestKind.ALL
    assert first.ratio == pytest.approx(math.hypot(100.0, U_FY) / (U_FY / 2.5), rel=0.15)
    assert not found.effects
    assert found.unexplained
    assert "Something is missing that no effect of the library describes" in found.headline
    assert "hardly is one of this tyre" in found.headline
    assert found.tyre.values == TYRE.values
