"""The pictures show the numbers they are given."""

from __future__ import annotations

import dataclasses
import re

import numpy as np
import pytest
from matplotlib.text import Text

from mffit.quantities import CHANNELS
from mffit.report import drawing, style
from mffit.report.build_view import view_of
from mffit.report.figures import decomposition, fit, residuals, spin
from mffit.report.published import TYRES


@pytest.fixture(scope="module")
def view(result):
    return view_of(result)


@pytest.fixture(autouse=True)
def _settings():
    with style.applied():
        yield


def titles(figure):
    return [ax.get_title(loc="left") for ax in figure.axes]


def test_decomposition_has_a_panel_for_every_forward_curve_and_one_of_each_camber_pair(view):
    figure = decomposition.decomposition(view, view.channels[0])
    assert titles(figure) == [
        "900 N, 200 kPa",
        "900 N, 250 kPa",
        "1500 N, 250 kPa",
        "1500 N, 250 kPa, γ = 20°",
        "900 N, 250 kPa",
        "1500 N, 250 kPa",
    ]


def test_raw_curve_is_the_sum_of_its_parts(view):
    for ax in decomposition.decomposition(view, view.channels[0]).axes:
        _, raw, odd, even = (line.get_ydata() for line in ax.lines)
        assert raw == pytest.approx(np.asarray(odd) + np.asarray(even))


def test_even_parts_have_a_row_per_channel_and_angle_and_a_column_per_load(view):
    figure = decomposition.even_parts(view)
    assert titles(figure) == [
        f"{CHANNELS[c].mathtext}, {load} N" for c in ("Fy", "Fy", "Mz", "Mz") for load in (900, 1500)
    ]


def test_fit_draws_every_point(view):
    figure = fit.model_against_points(view, view.channels[1])
    drawn = [line for ax in figure.axes for line in ax.lines if line.get_linestyle() == "None"]
    assert sum(len(line.get_xdata()) for line in drawn) == len(view.points)


def test_residual_maps_share_one_scale_that_is_symmetric(view):
    values = np.linspace(-9.0, 9.0, len(view.points))
    figure = residuals.residual_maps(view.points, [("Fy", values)], view.conditions, 4.0, "u")
    for ax in figure.axes[:-1]:
        assert ax.collections[0].get_clim() == (-4.0, 4.0)
        assert np.abs(ax.collections[0].get_array()).max() <= 4.0


def test_points_with_equal_angles_are_drawn_apart():
    alpha, gamma = np.array([0.0, 1.0, 0.0, 0.0]), np.zeros(4)
    shift = residuals.beside(alpha, gamma)
    assert sorted(shift[[0, 2, 3]]) == [-1.0, 0.0, 1.0]
    assert shift[1] == 0.0


def test_too_many_conditions_leave_those_with_most_points(view):
    kept = residuals.most_populated(view.conditions, 2)
    assert [c.title for c in kept] == ["900 N, 250 kPa", "1500 N, 250 kPa"]


def test_this_tyre_stands_beside_the_published_ones(view):
    figure = spin.camber_reduction(view)
    labels = [label.get_text() for label in figure.axes[0].get_yticklabels()]
    assert labels == ["front-1", *(tyre.name for tyre in reversed(TYRES))]


def test_budget_bars_are_ordered_and_below_the_total(view):
    bars = [bar.get_width() for bar in spin.camber_reduction(view).axes[1].patches]
    assert bars == sorted(bars)
    assert max(bars) <= view.measured.epsilon_gamma.u


def test_line_over_load_is_the_one_the_file_carries(view):
    ax = spin.camber_reduction(view).axes[2]
    line = next(line for line in ax.lines if line.get_label().startswith("PECP1"))
    assert line.get_ydata() == pytest.approx(view.measured.pecp1)


def test_alignment_has_a_panel_per_load_run_both_ways(view):
    assert titles(spin.alignment(view)) == ["900 N", "1500 N"]


def test_settings_are_left_as_they_were():
    import matplotlib

    before = dict(matplotlib.rcParams)
    with style.applied():
        matplotlib.rcParams["font.size"] = 3.0
    assert dict(matplotlib.rcParams) == before


def test_a_cloud_of_points_is_one_image_in_the_page_and_a_few_points_are_not():
    rng = np.random.default_rng(2)
    for count, images in ((40, 0), (5000, 1)):
        figure, ((ax,),) = style.panel_grid([1], 1)
        ax.plot(*rng.standard_normal((2, count)), ls="none", marker=".")
        drawn = drawing.markup(figure, "cloud")
        assert drawn.count("<image") == images
        assert len(drawn) < 200_000


def test_panels_carry_the_labels_that_they_shared():
    figure, rows = style.panel_grid([3], 3, share_x=True, share_y=True)
    style.label_left(rows, "force")
    style.label_below(rows, "angle")
    drawn = drawing.markup(figure, "shared")
    assert drawn.count(">force<") == drawn.count(">angle<") == drawn.count("<svg") == 3


def test_names_of_sweeps_cannot_break_the_page():
    figure, ((ax,),) = style.panel_grid([1], 1)
    ax.set_title("<script>alert(1)</script> & more")
    assert "&lt;script&gt;alert(1)&lt;/script&gt; &amp; more" in drawing.markup(figure, "x")


@pytest.mark.parametrize("name", ["front-1", "a very long name of a tyre that somebody gave it"])
def test_no_label_lies_over_another_in_the_picture(view, name):
    tyre = view.config.tyre.model_copy(update={"name": name})
    figure = spin.camber_reduction(
        dataclasses.replace(view, config=view.config.model_copy(update={"tyre": tyre}))
    )
    assert crossing(figure) == []


def crossing(figure):
    """Pairs of texts that lie over each other."""
    figure.draw_without_rendering()
    hidden = set()  # numbers of ticks beyond the ends of an axis
    for axis in (axis for ax in figure.axes for axis in (ax.xaxis, ax.yaxis)):
        low, high = sorted(axis.get_view_interval())
        for tick in axis.get_major_ticks():
            hidden |= set() if low <= tick.get_loc() <= high else {tick.label1, tick.label2}
    texts = [t for t in figure.findobj(Text) if t.get_visible() and t.get_text().strip() and t not in hidden]
    boxes = [(t.get_text(), t.get_window_extent()) for t in texts]
    return [
        (said, other)
        for i, (said, a) in enumerate(boxes)
        for other, b in boxes[:i]
        if min(a.x1, b.x1) - max(a.x0, b.x0) > 1.0 and min(a.y1, b.y1) - max(a.y0, b.y0) > 1.0
    ]


@pytest.mark.parametrize("columns", [1, 2])
def test_no_panel_is_too_wide_for_a_telephone(columns):
    figure, rows = style.panel_grid([columns], columns)
    style.label_left(rows, "force")
    drawn = drawing.markup(figure, "wide")
    assert float(re.search(r"--widest:([\d.]+)", drawn)[1]) < 440.0
