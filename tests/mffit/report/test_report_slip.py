"""Pictures of driving, braking and combined slip show the readings and the physics of a known tyre."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from report_toys import made_result

from mffit import parts
from mffit.fit.agreement import with_points
from mffit.fit.coverage import coverage
from mffit.numbers import Numbers
from mffit.quantities import CHANNELS
from mffit.report import build, constants, page
from mffit.report.build_view import view_of
from mffit.report.figures import fit, residuals, slip
from mffit.report.text import filling
from mffit.rig import Simulation
from mffit.rig_errors import NO_FAULTS
from tests.mffit.fit import combined_programme as belt

U = {"PDX1": 0.02, "RBX1": 0.4, "RBY1": 0.4, "QDZ1": 0.002}


@pytest.fixture(scope="module")
def view():
    """A build of the programme whose model is the true tyre on its rig."""
    disc = made_result(phi_t=0.0, rig={"type": "flat-track"})
    points, tyre = belt.programme(), belt.truth()
    rig = Simulation.of(tyre, NO_FAULTS.replace(Mx0_Nm=30.0), turn_slip=False)
    readings = rig.readings(points, belt.NOISE)
    fit = dataclasses.replace(
        disc.fit,
        tyre=tyre,
        simulation=rig,
        model=readings,
        channels=with_points(readings, points),
        coverage=coverage(points, "left"),
        posterior=Numbers.of(tuple(U), np.zeros(len(U)), np.diag(np.square([*U.values()]))),
    )
    return view_of(dataclasses.replace(disc, points=points, parts=parts.split(points), fit=fit))


def named(panel, begin):
    return [s for s in panel.series if s.name.startswith(begin)]


def test_every_reading_is_on_one_curve_over_an_angle_or_over_slip(view):
    rows = np.concatenate([curve.index for curve in view.curves])
    assert sorted(rows) == list(range(len(view.points)))
    assert view.beside_curves == 0
    over = {o: sum(c.over == o for c in view.curves) for o in ("alpha", "gamma", "kappa")}
    assert over == {"alpha": 3 * 2 + 2 * 2, "gamma": 0, "kappa": 3 * 2 * 5 + 2 * 2}
    held = {(c.load, c.camber): [] for c in view.curves if c.over == "kappa" and c.pressure == 250.0}
    for curve in view.curves:
        if curve.over == "kappa" and curve.pressure == 250.0:
            held[curve.load, curve.camber].append(curve.held)
    assert all(sideslips == pytest.approx([-5.0, -2.0, 0.0, 2.0, 5.0]) for sideslips in held.values())
    assert set(held) == {(load, camber) for load in belt.LOADS for camber in (0.0, 6.0)}


def test_panels_over_slip_hold_every_driven_reading_of_each_channel(view):
    driven = sum(len(c.index) for c in view.curves if c.over == "kappa")
    for channel in view.channels:
        sheet = fit.model_against_points(view, channel)
        over_slip = [p for p in sheet.panels if "slip κ" in p.x.label]
        assert len(over_slip) == 3 * 2 + 2 * 2
        assert sheet.remark == ""
        assert sum(len(s.x) for p in over_slip for s in named(p, "sweep")) == driven


def test_lines_over_slip_drive_forwards_and_go_through_the_readings(view):
    (Fx,) = (channel for channel in view.channels if channel.name == "Fx")
    for curve in [c for c in view.curves if c.over == "kappa"]:
        line = view.lines[curve]
        assert np.all(line.raw["Fx"][line.x > 0.02] > 0.0)
        apart = Fx.measured[curve.index] - np.interp(curve.varied(view.points), line.x, line.raw["Fx"])
        assert np.std(apart) < 2.0 * belt.NOISE["Fx"] + 0.01 * np.ptp(line.raw["Fx"])  # chords of a bent line


def test_the_friction_limit_is_closed_convex_and_holds_the_readings(view):
    sheet = slip.friction_ellipse(view)
    assert [panel.title for panel in sheet.panels] == ["900 N", "1400 N", "2100 N"]
    for panel in sheet.panels:
        (limit,) = named(panel, slip.EDGE_NAME)
        corners = np.column_stack([limit.x, limit.y])
        assert corners[0] == pytest.approx(corners[-1])
        sides = np.diff(corners, axis=0)
        sides = sides[np.hypot(*sides.T) > 0.0]
        following = np.roll(sides, -1, axis=0)
        turn = sides[:, 0] * following[:, 1] - sides[:, 1] * following[:, 0]
        size = float(np.max(np.abs(corners)))
        assert np.all(turn < 1e-9 * size**2) or np.all(turn > -1e-9 * size**2)
        load = float(panel.title.split()[0])
        assert 0.9 * load < float(limit.y.max()) < 1.6 * load
        sense = np.sign(turn.sum())
        outwards = np.column_stack([sides[:, 1], -sides[:, 0]]) * sense / np.hypot(*sides.T)[:, None]
        start = corners[:-1][np.hypot(*np.diff(corners, axis=0).T) > 0.0]
        for read in named(panel, "measured"):
            places = np.column_stack([read.x, read.y])
            beyond = np.max(np.einsum("ij,kij->ki", outwards, places[:, None] - start), axis=1)
            assert np.max(beyond) < 4.0 * belt.NOISE["Fx"]


def test_maps_hold_every_reading_inside_their_axes(view):
    shown = 0
    for panel in residuals.residual_maps(view).panels:
        (found,) = (s for s in panel.series if s.shade is not None)
        shown += len(found.x)
        assert panel.x.low < found.x.min() <= found.x.max() < panel.x.high
        assert panel.y.low < found.y.min() <= found.y.max() < panel.y.high
    assert shown == sum(int(np.isfinite(values).sum()) for _, values in view.scaled)


def test_what_is_not_drawn_is_said(view, monkeypatch, tmp_path):
    monkeypatch.setattr(constants, "MOST_PANELS", 5)
    sheet = build.BUILD["fit_Fx"](view)
    picture = page.picture(tmp_path, "fit_Fx", sheet)
    assert picture.drawing.count("<img") == 1 + 5  # with the key
    said = f"{len(sheet.panels) - 5} more panels are not drawn, for lack of room; the numbers have them."
    assert said in picture.remark
    assert picture.table.count("sweep") == sum(len(c.index) for c in view.curves)
    macro = filling.templates(escaped=True).get_template("macros.html.j2").module
    assert said in macro.fit_of_every_channel({"fit_Fx": picture}, CHANNELS)


def test_whatever_a_picture_shows_can_be_seen(view, result):
    """A line has a width, a mark a size, an area some colour."""
    sheets = [draw(built) for built in (view, view_of(result)) for draw in build.BUILD.values()]
    looks = [s.look for sheet in sheets for panel in sheet.panels for s in panel.series if hasattr(s, "look")]
    assert all(look.line or look.marker or look.opacity > 0.0 for look in looks)
    assert min(look.width for look in looks if look.line) > 0.3  # pt
    assert min(look.size for look in looks if look.marker) > 0.9


def test_the_friction_ellipse_is_drawn_only_where_slip_was_run(view, result):
    assert slip.friction_ellipse(view).panels
    assert not slip.friction_ellipse(view_of(result)).panels
