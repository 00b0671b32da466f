"""The table behind a figure holds what is drawn."""

from __future__ import annotations

import base64
import csv
import io
import zipfile
from dataclasses import replace
from urllib.parse import unquote

import numpy as np
import pytest

from mffit.report import constants, left_undrawn, page
from mffit.report.build_view import view_of
from mffit.report.drawing.records import Axis, ErrorBars, Look, Map, Panel, Sheet, Trace, with_shorter_series
from mffit.report.figures import decomposition, fit, residuals, spin
from mffit.report.numbers import table
from mffit.report.page import PagePicture


@pytest.fixture(scope="module")
def view(result):
    return view_of(result)


def rows(sheet):
    return list(csv.DictReader(io.StringIO(table(sheet))))


def test_every_reading_is_in_the_table_of_the_fit(view):
    found = rows(fit.model_against_points(view, view.channels[0]))
    read = [row for row in found if not row["series"].startswith("model")]
    key = next(name for name in found[0] if name.startswith("y"))
    assert sorted(float(row[key]) for row in read) == pytest.approx(sorted(view.points.Fy), rel=1e-5)
    assert {row["x axis"] for row in found} == {"sideslip α [deg]", "camber γ [deg]"}


def test_parts_are_named_as_in_the_legend(view):
    found = rows(decomposition.decomposition(view, view.channels[0]))
    assert {row["series"].split(":")[0] for row in found} == {"raw reading", "odd part", "even part"}


def test_bars_and_error_bars_are_named_by_the_words_at_the_axis(view):
    found = rows(spin.camber_reduction(view))
    budget = {row["y"]: float(row["x"]) for row in found if row["panel"].startswith("What")}
    largest = sorted(view.measured.budget, key=lambda line: -line.contribution)[: constants.MOST_BUDGET_BARS]
    assert budget == pytest.approx({line.source: line.contribution for line in largest}, rel=1e-5)
    own = next(row for row in found if row["y"] == "front-1")
    epsilon = view.measured.epsilon_gamma
    assert float(own["upper"]) - float(own["lower"]) == pytest.approx(2.0 * epsilon.u, rel=1e-4)


def test_a_map_gives_the_value_of_every_colour(view):
    values = np.linspace(-3.0, 3.0, len(view.points))
    found = rows(residuals.residual_maps(view.points, [("Fy", values)], view.conditions, "u"))
    coloured = sorted(float(row["value"]) for row in found if row["value"])
    assert coloured == pytest.approx(sorted(values), abs=1e-5)


def test_a_long_series_is_drawn_at_evenly_spaced_points_and_the_picture_knows(monkeypatch, tmp_path):
    monkeypatch.setattr(constants, "POINTS_PER_SERIES_DRAWN", 10)
    x = np.arange(95.0)
    bars = ErrorBars(name="points", x=x, y=x**2, u=np.full(95, 3.0), look=Look(marker="o"))
    few = Map(name="", x=x[:9], y=x[:9], values=x[:9], limit=9.0, size=4.0)
    sheet = Sheet(rows=[[Panel(x=Axis(), y=Axis(), series=[bars, few])]], height=1.0)
    drawn, untouched = with_shorter_series(sheet, 10).panels[0].series
    assert list(drawn.x) == list(x[::10])
    assert list(drawn.ends()[1]) == list(x[::10] ** 2 + 3.0)
    assert untouched is few
    assert page.draw(tmp_path, {"long": lambda: sheet})["long"].left_out == left_undrawn.long_series(10)
    short = replace(sheet, rows=[[Panel(x=Axis(), y=Axis(), series=[few])]])
    assert page.draw(tmp_path, {"short": lambda: short})["short"].left_out == ""


def test_a_long_series_is_thinned_and_its_name_says_so(monkeypatch):
    monkeypatch.setattr(constants, "POINTS_PER_SERIES_IN_PAGE", 10)
    x, few = np.arange(95.0), np.arange(9.0)
    series = [
        Trace(name="line", x=x, y=x**2, look=Look(line="-")),
        Map(name="", x=few, y=few, values=few, limit=9.0, size=4.0),
    ]
    found = rows(Sheet(rows=[[Panel(x=Axis(), y=Axis(), series=series)]], height=1.0))
    line = [row for row in found if row["series"]]
    assert {row["series"] for row in line} == {"line, every 10th"}
    assert [float(row["x"]) for row in line] == list(np.arange(0.0, 95.0, 10.0))
    assert len(found) - len(line) == 9


def test_a_long_table_is_packed_and_the_same_table():
    """Bytes do not depend on when it was packed."""
    numbers = "x,y\n" + "1.25,3.5\n" * 10_000
    short, long = (
        PagePicture(name="fit", drawing="", table=text, left_out=0) for text in (numbers[:400], numbers)
    )
    assert unquote(short.link.partition(",")[2]) == numbers[:400]
    address, _, packed = long.link.partition(",")
    assert address == "data:application/zip;base64"
    assert len(packed) < len(numbers) / 20
    with zipfile.ZipFile(io.BytesIO(base64.b64decode(packed))) as archive:
        assert archive.namelist() == ["fit.csv"]
        assert archive.read("fit.csv").decode() == numbers
        assert archive.infolist()[0].date_time[0] == 1980
