"""What the page of a project states of points and coefficients."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import mffit
from mffit.points import make_points
from mffit.quantities import CONDITIONS
from mffit.suspicion import Trust
from mffit.viewer.project import coefficient_rows, project_data
from mffit.viewer.project_points import facets


def points(line, file=0, **fields):
    n = len(line)
    return make_points(
        np.linspace(-0.1, 0.1, n),
        0.0,
        1000.0,
        p=2e5,
        V=10.0,
        phi_t=0.0,
        line=line,
        file=file,
        files=("a", "b"),
        **fields,
    )


def test_points_are_grouped_by_their_set_points():
    groups, of = facets(points([1, 2, 3, 4], direction=[1, 1, -1, 1]))
    found = {f["name"]: f for f in groups}
    assert found["Fz"]["labels"] == ["1000 N"]
    assert [found["direction"]["labels"][k] for k in of["direction"]] == [
        "forward",
        "forward",
        "backward",
        "forward",
    ]
    assert found["path"]["labels"] == ["straight"]


def test_every_condition_with_set_points_is_a_filter():
    """Also longitudinal slip; a condition with many levels is filtered by a range."""
    driven = make_points(
        0.0, 0.0, 1000.0, p=2e5, V=10.0, phi_t=0.0, kappa=np.repeat([-0.1, 0.0, 0.1], 4), line=np.arange(12),
        files=("a",),
    )  # fmt: skip
    found = {f["name"]: f for f in facets(driven)[0]}
    assert found["kappa"]["labels"] == ["-0.1", "0", "0.1"]
    words = {f["word"] for f in found.values()}
    assert {q.word for q in CONDITIONS.values()} - words == {"temperature", "time"}
    swept = make_points(np.linspace(-0.3, 0.3, 200), 0.0, 1000.0, p=2e5, V=10.0, phi_t=0.0)
    assert {f["name"] for f in facets(swept)[0] if f["as_range"]} == {"alpha"}


def test_a_reason_against_trust_is_a_single_warning(result):
    """Like the doubts, the reasons are among the warnings of the result."""
    reason = "a limit of the curves holds QEZ1"
    distrusted = replace(
        result, trust=Trust((reason,)), warnings=(f"the result is not to be trusted: {reason}", "x")
    )
    assert len(project_data(distrusted)["warnings"]) == 2


def test_channels_beside_the_fit_have_the_misfit_of_the_file(result):
    """Rolling resistance is fitted by itself, to the freely rolling wheel: computed again with the written file."""
    rows = {row["name"]: row for row in project_data(result)["channels"]}
    assert [name for name, row in rows.items() if not row["of_fit"]] == ["My"]
    points = result.points
    model = result.fit.tyre(points.Fz, points.alpha, points.gamma, Vx=points.Vx, p=points.p, turn_slip=False)
    # the rig's small misalignment changes the load and angle that the moment sees by a thousandth
    assert rows["My"]["rmse"] == pytest.approx(np.sqrt(np.mean((model.My - points.My) ** 2)), rel=1e-2)
    assert {q for q in project_data(result)["quantities"] if q in rows} == set(rows)


def test_sliders_hold_the_value_and_stay_within_the_bounds(result):
    for row in coefficient_rows(result, result.fit.coefficients):
        low, high = row["slider"]
        assert low <= row["value"] <= high, row["name"]
        for end, bound in zip((low, high), row["bounds"], strict=True):
            if bound is not None and row["bounds"][0] <= row["value"] <= row["bounds"][1]:
                assert row["bounds"][0] <= end <= row["bounds"][1], row["name"]
    names = {row["name"] for row in coefficient_rows(result, result.fit.coefficients)}
    assert "PCY1" in names
    assert not names & {"FNOMIN", "UNLOADED_RADIUS", "ALPMAX"}


def test_show_takes_one_project_and_writes_its_page(result, tmp_path):
    page = mffit.viewer.project_page(result)
    assert page.names == ("small",)
    path = page.write(tmp_path / "page.html")
    assert page.write(path) == path  # replaced, as it is ours
    assert "connect-src" not in page.html
    with pytest.raises(mffit.errors.InputError, match="one project at a time"):
        mffit.show([Path("a/tyre.toml"), Path("b.tir")])
