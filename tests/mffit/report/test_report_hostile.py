"""Names from files appear in pages as plain text and cannot act there."""

from __future__ import annotations

import dataclasses
from html.parser import HTMLParser

import numpy as np
import pytest
from report_toys import TRUE, made_config, made_points, made_result, programme

import tir
from mffit.config.laboratory import InstrumentTable, LabTable
from mffit.diagnosis import Asked, diagnose
from mffit.effects import CATALOG
from mffit.made import made
from mffit.points.left_out import LeftOut
from mffit.report import write_build, write_diagnosis
from mffit.suspicion import Doubt, Outlier, Trust
from mffit.suspicion.others import Error
from mffit.viewer.bundle import script

HOSTILE = "<img src=x onerror=alert(1)>\"'$^&amp;</style></title><script>alert(2)</script>"
"""Breaks out of an element, an attribute, a style sheet, a title and the type setting of a picture."""


class Suspicious(HTMLParser):
    """Everything in a page that could act or fetch."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []
        self.text = ""

    def handle_starttag(self, tag, attrs):
        if tag in ("script", "iframe", "object", "embed", "link", "base", "form"):
            self.found.append(tag)
        for name, value in attrs:
            if name.startswith("on") or (
                name in ("src", "href")
                and not (value or "").startswith(
                    ("data:image/", "data:text/csv", "data:application/zip", "#")
                )
            ):
                self.found.append(f"{tag} {name}={value}")

    def handle_data(self, data):
        self.text += data


def read(path) -> Suspicious:
    page = Suspicious()
    page.feed(path.read_text(encoding="utf-8"))
    page.close()
    return page


def hostile(points):
    """The same points from files and sweeps with hostile names and a hostile column."""
    n = len(points.files)
    return points.replace(
        files=tuple(f"{HOSTILE}{i}.csv" for i in range(n)),
        sweep_names=tuple(f"{HOSTILE}{i}" for i in range(n)),
        table=points.table.assign(**{HOSTILE: 0.0}),
    )


@pytest.fixture(scope="module")
def settings():
    """[tyre] size and the sweep's file are free texts; the name of a tyre is restricted to file names."""
    given = made_config()
    return given.model_copy(
        update={
            "tyre": given.tyre.model_copy(update={"size": HOSTILE}),
            "sweep": (given.sweep[0].model_copy(update={"file": HOSTILE}),),
            "lab": LabTable(
                order=HOSTILE,
                operator=HOSTILE,
                instruments=(InstrumentTable(name=HOSTILE, serial=HOSTILE, certificate=HOSTILE),),
            ),
        }
    )


def test_the_build_report_shows_hostile_names_as_text(settings, tmp_path):
    result = made_result()
    fit = dataclasses.replace(
        result.fit,
        doubts=(
            Doubt(HOSTILE, HOSTILE, np.arange(3), (Error("Fy", 9.0, 3.0, 0.1, 0.0, 0.0),), looks=HOSTILE),
        ),
        outliers=(Outlier(HOSTILE, 3, HOSTILE, 2, "Fy", 1.0, 2.0, 9.0),),
        explanations=(HOSTILE, HOSTILE),
    )
    write_build(
        dataclasses.replace(
            result,
            config=settings,
            points=hostile(result.points),
            fit=fit,
            trust=Trust(reasons=(HOSTILE,), remarks=(HOSTILE,)),
            warnings=(HOSTILE,),
            files={"turn-slip": f"{HOSTILE}.tir"},
            made=made({HOSTILE: 64 * "0"}),
            left_out=tuple(
                LeftOut(
                    file=HOSTILE, lines=HOSTILE, count=1, by=by, rule=HOSTILE, channel=HOSTILE, why=HOSTILE
                )
                for by in ("hand", "rule")
            ),
        ),
        tmp_path,
    )
    page = read(tmp_path / "report.html")
    assert page.found == []
    assert page.text.count(HOSTILE) >= 14


def test_the_diagnosis_shows_hostile_names_as_text(settings, tmp_path):
    points = hostile(made_points(programme()))
    found = diagnose(points, tir.read(TRUE), settings, Asked(effects=CATALOG[:3]))
    found = dataclasses.replace(
        found,
        outliers=(Outlier(HOSTILE, 3, HOSTILE, 0, "Fy", 40.0, 0.0, 9.0),),
        given_file=f"{HOSTILE}.tir",
    )
    write_diagnosis(found, tmp_path)
    page = read(tmp_path / "diagnosis.html")
    assert page.found == ["script"]
    assert script("sort") in page.text
    assert HOSTILE in page.text


def test_the_reader_of_this_test_would_find_them():
    page = Suspicious()
    page.feed(f"<p>{HOSTILE}</p>")
    assert page.found == ["img src=x", "img onerror=alert(1)", "script"]
