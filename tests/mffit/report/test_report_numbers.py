"""The table behind a figure holds what is drawn."""

from __future__ import annotations

import base64
import csv
import io
import zipfile

import numpy as np
import pytest

from mffit.constants import MOST_ROWS
from mffit.report import constants, page
from mffit.report.build_view import view_of
from mffit.report.drawing.records import Look, Panel, Sheet, Trace
from mffit.report.figures import decomposition, fit, residuals, spin
from mffit.report.numbers import table


@pytest.fixture(scope="module")
def view(result):
    return view_of(result)


def rows(sheet):
    return list(csv.DictReader(io.StringIO(table(sheet))))


def test_every_reading_is_in_the_table_of_the_fit(view):
    found = rows(fit.model_against_points(view, view.channels[0]))
    read = [row for row in found if not row["series"].startswith("model")]
    assert sorted(float(row["y"]) for row in read) == pytest.approx(sorted(view.points.Fy), rel=1e-5)
    assert {row["x axis"] for row in found} == {"sideslip α [deg]", "camber γ [deg]"}


def test_parts_are_named_as_in_the_legend(view):
    found = rows(decomposition.parts(view))
    assert {row["series"].split(":")[0] for row in found} == {
        "raw reading",
        "odd part",
        "even part",
        "even part of the model",
    }


def test_bars_and_error_bars_are_named_by_the_words_at_the_axis(view):
    found = rows(spin.camber_reduction(view))
    budget = {row["y"]: float(row["x"]) for row in found if "budget" in row["panel"]}
    largest = sorted(view.build.measured.budget, key=lambda line: -line.contribution)[:MOST_ROWS]
    assert budget == pytest.approx({line.source: line.contribution for line in largest}, rel=1e-5)
    own = next(row for row in found if row["y"] == "front-1")
    epsilon = view.build.measured.epsilon_gamma
    assert float(own["upper"]) - float(own["lower"]) == pytest.approx(2.0 * epsilon.u, rel=1e-4)


def test_a_map_gives_the_value_of_every_colour(view):
    found = rows(residuals.residual_maps(view))
    coloured = sorted(float(row["value"]) for row in found if row["value"])
    assert coloured == pytest.approx(sorted(np.concatenate([x for _, x in view.scaled])), rel=1e-4, abs=1e-5)


def test_of_a_long_series_every_so_many_points_are_listed(monkeypatch):
    monkeypatch.setattr(constants, "POINTS_PER_SERIES", 10)
    x = np.arange(95.0)
    bars = Trace(name="points", x=x, y=x**2, half=np.full(95, 3.0), look=Look(marker="o"))
    few = Trace(name="few", x=x[:9], y=x[:9], shade=x[:9], look=Look(marker="s"))
    found = rows(Sheet(rows=[[Panel(series=[bars, few])]], height=1.0))
    assert [float(row["x"]) for row in found if row["series"] == "points"] == list(x[::10])
    assert [float(row["upper"]) for row in found if row["series"] == "points"] == list(x[::10] ** 2 + 3.0)
    assert sum(row["series"] == "few" for row in found) == 9


def test_a_table_is_packed_and_the_same_table():
    """Bytes do not depend on when it was packed."""
    numbers = "x,y\n" + "1.25,3.5\n" * 10_000
    picture = page.PagePicture(name="fit", drawing="", table=numbers, remark="")
    address, _, packed = picture.link.partition(",")
    assert address == "data:application/zip;base64"
    assert len(packed) < len(numbers) / 20
    with zipfile.ZipFile(io.BytesIO(base64.b64decode(packed))) as archive:
        assert archive.namelist() == ["fit.csv"]
        assert archive.read("fit.csv").decode() == numbers
        assert archive.infolist()[0].date_time[0] == 1980
