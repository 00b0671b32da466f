"""Pictures show the readings of the rig, and the readings that it would give if the tyre were the model."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from report_toys import TRUE, R, made_points, made_result, programme

import tir
from mffit.report.build_view import view_of
from mffit.report.curves import curves, model_lines
from mffit.rig import Simulation
from mffit.rig_errors import Faults


def test_line_includes_the_faults_that_are_known():
    points = made_points(programme())
    faults = Faults(alpha_0_deg=0.4, backlash_deg=0.17)
    rig = Simulation.of(tir.read(TRUE), faults)
    found = curves(points)
    read, lines = rig.readings(points), model_lines(rig, points, found)
    for curve in found:
        assert lines[curve].raw["Fy"][[0, -1]] == pytest.approx(read.Fy[curve.index[[0, -1]]])


def test_place_between_the_bounds(result):
    rows = {row.known.name: row for row in view_of(result).rows}
    row = rows["PKY1"]
    for value, place in ((-30.0, 0.0), (-25.0, 0.25), (-10.0, 1.0), (-40.0, 0.0), (0.0, 1.0)):
        found = dataclasses.replace(row.found, value=value, bounds=(-30.0, -10.0))
        assert row._replace(found=found).place == pytest.approx(place)
    assert rows["PKY1"]._replace(known=dataclasses.replace(row.known, lower=None)).place is None
    assert [name for name, row in rows.items() if row.held] == ["QBZ1", "PHY2"]


def test_channels_that_were_not_measured_are_left_out():
    assert [channel.name for channel in view_of(made_result(moment=False)).channels] == ["Fy"]


def test_noise_of_a_channel_is_that_of_its_points(result):
    view = view_of(result)
    assert [channel.noise for channel in view.channels] == pytest.approx([6.0, 0.6])
    assert math.isnan(view_of(made_result(u_Fy=np.nan)).channels[0].noise)


def test_disc_and_flat_track_are_told_apart():
    assert view_of(made_result(rig={"path_radius": R})).on_disc
    assert not view_of(made_result(rig={"type": "flat-track"}, phi_t=0.0)).on_disc


def test_the_line_of_a_moving_sweep_is_the_tyre_at_rest():
    """A lag belongs to the samples, whose times a line has not."""
    points = made_points(programme())
    points = points.replace(V=np.full(len(points), 10.0))
    moving = points.replace(time=np.arange(len(points)) * 0.1)
    tyre, found = tir.read(TRUE), curves(points)
    lagging = Simulation.of(tyre, Faults(relaxation_m=0.4))
    lines, steady = model_lines(lagging, moving, found), model_lines(Simulation.of(tyre), points, found)
    for curve in found:
        assert lines[curve].raw["Fy"] == pytest.approx(steady[curve].raw["Fy"])
