"""The conditions of a straight road at which the two files are compared, their weights, and the stated misfits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_rigs import SAMPLE, disc, truth

from mffit import config, points, virtual_rig
from mffit.config.models import NormalTable, given_values
from mffit.fit import ranges
from mffit.fit.comments import file_comments
from mffit.fit.known import Known, known_before_fit
from mffit.fit.wording import file_sentences, ranges_sentence
from mffit.fit.written.files import file_names, make_files
from mffit.fit.written.misfit import figures
from mffit.fit.written.road import Road, inside, road_grid, weights
from mffit.pipeline.measuring import measure
from mffit.points import make_points
from tir.parameters import TABLE

TESTED = {
    "PRESMIN": 200e3, "PRESMAX": 300e3, "FZMIN": 900.0, "FZMAX": 2100.0, "ALPMIN": -0.14, "ALPMAX": 0.14,
    "CAMMIN": -0.5, "CAMMAX": 0.5,
}  # fmt: skip
WRITTEN = TESTED | {
    "PRESMIN": 160e3, "PRESMAX": 360e3, "FZMIN": 90.0, "FZMAX": 3150.0, "ALPMIN": -0.35, "ALPMAX": 0.35,
    "CAMMIN": -0.75, "CAMMAX": 0.75,
}  # fmt: skip


def road(alpha_deg, gamma_deg, Fz=1500.0, p=250e3):
    alpha, gamma = np.radians(np.atleast_1d(alpha_deg)), np.radians(np.atleast_1d(gamma_deg))
    shape = np.broadcast(alpha, gamma).shape
    return Road(*(np.broadcast_to(x, shape) for x in (Fz, alpha, gamma, p)))


def test_sideslip_or_camber_alone_has_full_weight_and_both_at_once_half():
    """1/2 + 1/2 / (1 + (a/4 deg g/25 deg)^2)."""
    assert weights(road([0.0, 8.0, 0.0], [0.0, 0.0, 28.0]), TESTED) == pytest.approx([1.0, 1.0, 1.0])
    assert weights(road(4.0, 25.0), TESTED)[0] == pytest.approx(0.75)
    assert weights(road(-8.0, 25.0), TESTED)[0] == pytest.approx(0.6)


def test_untested_conditions_have_a_fiftieth_of_the_weight():
    for beyond in (road(10.0, 0.0), road(0.0, -35.0), road(0.0, 0.0, 800.0), road(0.0, 0.0, 2200.0), road(0.0, 0.0, p=310e3),
                   road(0.0, 0.0, p=190e3)):  # fmt: skip
        assert not inside(beyond, TESTED)[0]
        assert weights(beyond, TESTED)[0] == pytest.approx(0.02)
    for edge in (
        road(np.degrees(0.14), 0.0),
        road(0.0, np.degrees(-0.5)),
        road(0.0, 0.0, 900.0),
        road(0.0, 0.0, 2100.0, 300e3),
    ):
        assert inside(edge, TESTED)[0]


def test_the_grid_spans_the_written_ranges_and_is_symmetric():
    grid = road_grid(TESTED, WRITTEN, 1400.0)
    assert (grid.Fz.min(), grid.Fz.max()) == (90.0, 3150.0)
    assert (grid.pressure.min(), grid.pressure.max()) == (160e3, 360e3)
    assert (grid.alpha.min(), grid.alpha.max()) == (-0.35, 0.35)
    assert (grid.gamma.min(), grid.gamma.max()) == (-0.75, 0.75)
    conditions = {tuple(np.round(row, 9)) for row in np.column_stack(grid)}
    assert {(F, -a + 0.0, -g + 0.0, p) for F, a, g, p in conditions} == conditions
    assert {900.0, 2100.0} <= set(grid.Fz)
    within = inside(grid, TESTED)
    assert 0.15 < within.mean() < 0.9
    # Other pressures at one load, the nominal one.
    assert set(grid.Fz[grid.pressure != 250e3]) == {1400.0}
    assert within.sum() > 300


def test_a_default_of_tyre_toml_is_not_called_given():
    found = make_points(np.radians([-2.0, 2.0]), 0.0, 1400.0, p=250e3, V=10.0, phi_t=0.0, Fy=[900.0, -900.0])
    origins = []
    for stated in ({}, {"nominal_speed": 10.0, "side": "left"}):
        tyre = {"name": "t", "unloaded_radius": 0.3, "nominal_load": 1400, "nominal_pressure": 250, **stated}
        settings = config.load({"tyre": tyre, "rig": {"type": "flat-track"}, "sweep": [{"file": "any.csv"}]})
        known = known_before_fit(settings, found, measure(settings, found, None)[1], None, {})
        assert known.values["LONGVL"] == 10.0
        origins.append([known.origin[name] for name in ("LONGVL", "TYRESIDE", "FNOMIN")])
    assert origins == [["default", "default", "given"], ["given", "given", "given"]]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("files")
    virtual_rig.simulate(virtual_rig.load_plan(disc(), folder=SAMPLE), folder, seed=3)
    settings = config.load(folder / "tyre.toml")
    loaded = points.read(settings).points
    known = Known(truth().values, {row.name: "base" for row in TABLE})
    known = known.having(ranges.covered_ranges(loaded), "range").having(given_values(settings.tyre), "given")
    asked = settings.model_copy(update={"normal": NormalTable(camber_max_deg=65.0)})  # beyond the range
    made = make_files(asked, known, loaded, truth())
    return made.annotated(file_comments(made, known.origin, {})), known.origin


def test_a_limit_of_camber_beyond_the_range_has_no_effect_and_says_so(files):
    made, _ = files
    assert made.camber_limit is None
    assert {file.tyre["CAMMAX"] for file in made.by_use.values()} == {made.written["CAMMAX"]}
    said = " ".join(file_sentences(made, {"turn-slip": "a.tir", "normal": "b.tir"}))
    end = np.degrees(made.written["CAMMAX"])
    assert (
        f"camber_max_deg = 65 has no effect, because the camber range of the files ends at {end:.0f} deg"
        in said
    )


def test_the_turn_slip_file_is_the_model_and_states_no_misfit(files):
    made, _ = files
    exact = made.by_use["turn-slip"]
    for misfit in exact.straight.values():
        assert misfit.rms == misfit.largest == misfit.weighted == misfit.beyond == 0.0


def test_the_stated_misfit_is_that_of_the_two_files(files):
    made, _ = files
    normal = made.by_use["normal"]
    grid = road_grid(made.tested, made.written, 1400.0)
    off = normal.tyre(grid.Fz, grid.alpha, grid.gamma, p=grid.pressure).Fy
    off = off - truth()(grid.Fz, grid.alpha, grid.gamma, p=grid.pressure, turn_slip=True).Fy
    within = inside(grid, made.tested)
    stated = normal.straight["Fy"]
    assert stated.rms == pytest.approx(np.sqrt(np.mean(off[within] ** 2)), rel=1e-6)
    assert stated.largest == pytest.approx(np.max(np.abs(off[within])), rel=1e-6)
    assert stated.beyond == pytest.approx(np.sqrt(np.mean(off[~within] ** 2)), rel=1e-6)
    weight = weights(grid, made.tested)[within]
    assert stated.weighted == pytest.approx(
        np.sqrt(np.sum(weight * off[within] ** 2) / weight.sum()), rel=1e-6
    )


def test_camber_stiffness_and_its_loss_are_slopes_at_zero(files):
    made, _ = files
    step = 1e-4
    slopes = {
        use: float(np.diff(f.tyre(1400.0, gamma=np.array([-step, step]), turn_slip=use == "turn-slip").Fy)[0])
        / (2 * step)
        for use, f in made.by_use.items()
    }
    for use, f in made.by_use.items():
        assert f.camber_stiffness == pytest.approx(slopes[use], rel=1e-5)
    assert made.stiffness_loss == pytest.approx(1.0 - slopes["normal"] / slopes["turn-slip"], abs=1e-5)


def test_the_lacking_force_is_that_of_the_curved_road(files):
    made, _ = files
    model = made.by_use["turn-slip"].tyre
    straight = model(1400.0, turn_slip=True).Fy
    assert list(made.lacking) == [100.0, 30.0, 10.0]
    for radius, force in made.lacking.items():
        assert force == pytest.approx(abs(model(1400.0, phi_t=-1 / radius).Fy - straight), rel=1e-9)
        assert force > 1.0


def test_every_value_states_its_origin(files):
    made, status = files
    for use in ("turn-slip", "normal"):
        comments = made.by_use[use].tyre.status
        assert comments["PKY1"] == "from base"
        assert comments["FZMAX"] == "estimate, checked plausible, tested to 2100 N"
        assert comments["FNOMIN"].startswith("given in tyre.toml")
        assert comments["USE_MODE"].startswith("given by this build")
    given = ("FNOMIN", "NOMPRES", "INFLPRES", "LONGVL", "UNLOADED_RADIUS", "WIDTH", "RIM_RADIUS")
    assert {status[name] for name in given} == {"given"}
    assert made.changed
    assert (
        made.by_use["normal"].tyre.status[made.changed["normal"][0]]
        == "fitted to the model without path curvature"
    )
    assert made.by_use["turn-slip"].tyre.status[made.changed["normal"][0]] == "from base"


def test_upright_both_files_are_equal_and_only_camber_terms_differ(files):
    made, _ = files
    on, off = made.by_use["turn-slip"].tyre, made.by_use["normal"].tyre
    differing = {name for name in on.values if on[name] != off[name]}
    assert differing == {*made.changed["normal"], "USE_MODE"}
    Fz, alpha = np.meshgrid([500.0, 1400.0, 2500.0], np.radians([-15.0, -3.0, 0.0, 2.0, 9.0]))
    assert off(Fz, alpha).Fy == pytest.approx(on(Fz, alpha).Fy, rel=1e-12)
    assert off(Fz, alpha).Mz == pytest.approx(on(Fz, alpha).Mz, rel=1e-12)


def test_the_sentences_state_the_figures(files):
    made, _ = files
    said = " ".join(file_sentences(made, file_names("small", "turn-slip", True)))
    normal = made.by_use["normal"].straight
    assert (
        f"to {normal['Fy'].ridden:.0f} N and {normal['Mz'].ridden:.1f} Nm rms where vehicles are ridden"
        in said
    )
    assert f"{made.stiffness_loss:.0%} less camber stiffness" in said
    assert "Give small.tir, the fitted model itself, to a simulator that computes turn slip" in said
    assert "Tested: 900 to 2100 N, sideslip to 8.0 deg, camber to 45.0 deg, 250 kPa only." in said


def test_several_pressures_are_stated_as_a_range(files):
    made, _ = files
    several = replace(made, tested=made.tested | {"PRESMIN": 200e3, "PRESMAX": 300e3})
    assert "camber to 45.0 deg, 200 to 300 kPa." in ranges_sentence(several)


def test_a_file_of_both_uses_states_its_misfit_at_every_place(files):
    made, _ = files
    grid, tyre, model, phi_t = road_grid(made.tested, made.written, 1400.0), truth(), truth(), -0.7
    tyre = tyre.replace(PKY6=1.2 * tyre["PKY6"])
    misfit = figures(tyre, "both", model.values, grid, made.tested, phi_t).misfit
    for place, (turn_slip, path) in {
        "straight": (False, 0.0),
        "straight_with_turn_slip": (True, 0.0),
        "disc": (True, phi_t),
    }.items():
        own, aim = (
            one(grid.Fz, grid.alpha, grid.gamma, phi_t=path, p=grid.pressure, turn_slip=on).Mz
            for one, on in ((tyre, turn_slip), (model, True))
        )
        assert misfit[place]["Mz"].largest == pytest.approx(
            np.max(np.abs((own - aim)[inside(grid, made.tested)])), rel=1e-6
        )
