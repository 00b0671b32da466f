"""The pictures show the numbers they are given."""

from __future__ import annotations

import base64
import dataclasses
import io
import re

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.text import Text
from PIL import Image
from small_rigs import flat, sound

from mffit.pipeline.on_road import on_road
from mffit.quantities import CHANNELS
from mffit.report import build, labels, style
from mffit.report.build_view import view_of
from mffit.report.drawing import pictures
from mffit.report.drawing.records import Axis, Bars, Guide, Look, Panel, Sheet, Trace, listed, with_fewer_rows
from mffit.report.figures import bands, decomposition, fit, residuals, road, spin
from mffit.report.figures.spin import TYRES


@pytest.fixture(scope="module")
def view(result):
    return view_of(result)


def titles(sheet):
    return [panel.title for panel in sheet.panels]


FULL_LINE = Look(line="-")


def panel_of(over, up, look=FULL_LINE, /, **content):
    """A panel with one series."""
    series = [Trace(name="series", x=np.asarray(over, float), y=np.asarray(up, float), look=look)]
    return Panel(**{"x": Axis(), "y": Axis(), "series": series, **content})


def sheet_of(*members, **content):
    return Sheet(rows=[members], height=1.5, **content)


def drawn(*members, **content):
    """The picture of a sheet with one row."""
    return pictures.draw(sheet_of(*members, **content))


def axes_of(*members, **content):
    """The axes of a sheet's panels, drawn."""
    figure = pictures.figure_of(sheet_of(*members, **content))
    figure.draw_without_rendering()
    return figure.axes


def test_parts_have_a_row_per_channel_and_angle_and_a_panel_per_load(view):
    sheet = decomposition.parts(view)
    assert titles(sheet) == [
        f"{CHANNELS[c].mathtext}{what}"
        for c in ("Fy", "Fy", "Mz", "Mz")
        for what in (", 1500 N", ", even, 900 N", ", even, 1500 N")
    ]
    for _, *even in sheet.rows:
        assert len({(panel.y.low, panel.y.high, panel.y.label) for panel in even}) == 1


def test_all_bands_of_a_report_are_those_of_the_road():
    """One width at one condition, around the best estimate, also where the tyre is not as the formula."""
    result = sound(flat)
    channels = {
        name: dataclasses.replace(one, missed=one.missed + 0.1 * np.max(np.abs(result.points.channel(name))))
        for name, one in result.prediction.channels.items()
    }
    result = with_channels(result, channels)
    view = view_of(dataclasses.replace(result, road=on_road(result)))
    assert np.ptp(result.prediction.missed("Fy", result.points)) > 50.0

    def found(sheet, channel, name, over):
        """Middle and half width at one angle [deg]."""
        (trace,) = [
            s
            for panel in sheet.panels
            for s in panel.series
            if panel.title.startswith(CHANNELS[channel].short_axis)
            and panel.x == labels.angle_axis(over)
            and s.name == name
        ]
        return np.interp([-4.0, 0.0, 4.0], trace.x, trace.y), np.interp([-4.0, 0.0, 4.0], trace.x, trace.half)

    for channel in ("Fy", "Mz"):
        middle, half = found(road.road(view), channel, "upright", "alpha")
        other, its_half = found(bands.bands(view), channel, labels.LOAD.of(1400.0), "alpha")
        assert other == pytest.approx(middle, rel=1e-4)  # places of both curves
        assert its_half == pytest.approx(half, rel=1e-4)


def test_raw_curve_is_the_sum_of_its_parts(view):
    for whole, *_ in decomposition.parts(view).rows:
        raw, odd, even = (series.y for series in whole.series)
        assert raw == pytest.approx(np.asarray(odd) + np.asarray(even))


def test_fit_draws_every_point(view):
    sheet = fit.model_against_points(view, view.channels[1])
    read = [
        series.y for panel in sheet.panels for series in panel.series if not series.name.startswith("model")
    ]
    assert sorted(np.concatenate(read)) == pytest.approx(sorted(view.points.Mz))


def test_fit_marks_readings_without_weight_and_doubtful_sweeps(view):
    class Marked:
        points, curves, lines = view.points, view.curves, view.lines

        def marked(self, channel):
            return np.array([3]), np.array([7, 8])

    sheet = fit.model_against_points(Marked(), view.channels[0])
    found = {"no weight": [], "doubtful sweep": []}
    for series in (series for panel in sheet.panels for series in panel.series):
        if series.name in found:
            found[series.name] += list(series.y)
    assert found["no weight"] == pytest.approx(view.points.Fy[[3]])
    assert found["doubtful sweep"] == pytest.approx(view.points.Fy[[7, 8]])
    assert set(found) <= set(sheet.key)


def missing_by(view, values):
    """The view of a build whose model misses the side force by so much [standard uncertainties]."""
    fy = view.channels[0]
    fitted = dataclasses.replace(view.build.fit, model={"Fy": fy.measured - values * fy.u})
    return dataclasses.replace(view, channels=(fy,), build=dataclasses.replace(view.build, fit=fitted))


def test_residual_maps_share_one_scale_that_is_symmetric(view):
    sheet = residuals.residual_maps(missing_by(view, np.linspace(-9.0, 9.0, len(view.points))))
    assert sheet.scale.limit == 4.0
    assert all(np.ptp(panel.series[0].shade) > 0.0 for panel in sheet.panels)
    assert len({(p.x.low, p.x.high, p.y.low, p.y.high) for p in sheet.panels}) == 1


def test_a_map_is_blue_below_white_at_and_red_above_the_model(view):
    def colour(value):
        sheet = residuals.residual_maps(missing_by(view, value))
        _, axes, *_ = axes_of(*sheet.panels, scale=sheet.scale)
        (marks,) = axes.collections
        (fill,) = {tuple(rgba) for rgba in marks.get_facecolor()}
        return to_rgb(fill)

    red, _, blue = colour(-4.0)
    assert blue > 2 * red
    red, _, blue = colour(4.0)
    assert red > 2 * blue
    assert min(colour(0.0)) > 0.94


def test_the_worst_of_the_readings_at_one_place_is_on_top(view):
    values = np.linspace(-2.0, 3.0, len(view.points))
    for panel in residuals.residual_maps(missing_by(view, values)).panels:
        shade = np.abs(panel.series[0].shade)
        assert list(shade) == sorted(shade)


def test_a_picture_with_too_many_panels_keeps_whole_rows_and_says_so():
    rows = [[panel_of([0, 1], [0, k], title=f"{k}-{i}") for i in range(2)] for k in range(9)]
    sheet = with_fewer_rows(Sheet(rows=rows, height=1.0), 6)
    assert titles(sheet) == ["0-0", "0-1", "4-0", "4-1", "8-0", "8-1"]
    assert sheet.remark.startswith("12 more panels are not drawn")
    assert with_fewer_rows(sheet, 6) is sheet


def test_this_tyre_is_listed_after_the_published_ones(view):
    panel = spin.camber_reduction(view).panels[0]
    assert [*panel.y.words.values()] == [*(tyre.name for tyre in TYRES), "front-1"]


def test_budget_bars_are_ordered_and_below_the_total(view):
    panel = spin.camber_reduction(view).panels[1]
    bars = list(panel.series[0].lengths)
    assert bars == sorted(bars, reverse=True)
    assert max(bars) <= view.build.measured.epsilon_gamma.u
    assert panel.guides[0].at == view.build.measured.epsilon_gamma.u


def test_line_over_load_is_the_one_the_file_carries(view):
    series = spin.camber_reduction(view).panels[2].series
    line = next(one for one in series if one.name.startswith("PECP1"))
    assert line.y == pytest.approx(view.build.measured.pecp1)


def test_alignment_has_a_panel_per_load_run_both_ways(view):
    sheet = spin.alignment(view)
    assert titles(sheet) == ["900 N", "1500 N"]
    for panel in sheet.panels:
        assert {series.name for series in panel.series} == {"rolling forwards", "rolling backwards"}


def grey(png):
    """Grey levels (height, width) of a PNG, 0 black to 255 white."""
    return np.asarray(Image.open(io.BytesIO(png)).convert("L"), float)


def images(markup):
    """The images of a page's markup, key first."""
    return [
        grey(base64.b64decode(data)) for data in re.findall(r'src="data:image/png;base64,([^"]*)"', markup)
    ]


def test_a_page_shows_each_panel_of_the_picture():
    """A page on a telephone shows one panel per row, so each carries its labels."""
    labelled = panel_of([0, 1], [0, 1], x=Axis(label="angle"), y=Axis(label="force"))
    picture = drawn(labelled, labelled, labelled)
    whole, cut = grey(picture.png), images(picture.markup)
    assert len(cut) == 3
    assert sum(one.shape[1] for one in cut) == whole.shape[1]
    for one in cut[1:]:
        assert one == pytest.approx(cut[0], abs=12.0)
    assert np.hstack(cut) == pytest.approx(whole[-len(cut[0]) :], abs=12.0)


def test_names_of_sweeps_cannot_break_the_page():
    assert "script" not in drawn(panel_of([0, 1], [0, 1], title="<script>1</script> & more")).markup


def test_every_kind_of_mark_and_line_is_drawn():
    looks = [Look(line=line) for line in ("-", "--", ":")]
    looks += [Look(marker=mark, hollow=hollow) for mark in "o.vsDx" for hollow in (False, True)]
    for look in looks:
        found, empty = (grey(drawn(panel_of([0, 1], [0, 1], one)).png) for one in (look, Look()))
        assert found.shape == empty.shape
        assert found.sum() < empty.sum() - 500.0, look


def test_a_series_is_drawn_at_its_numbers():
    """A dark square in the upper right quarter of the data area."""
    axis = Axis(low=0.0, high=4.0)
    panel = panel_of([3.0], [3.0], Look(marker="s", size=12.0, colour="#010101"), x=axis, y=axis)
    (axes,) = axes_of(panel)
    box, high = axes.get_window_extent(), axes.figure.bbox.height
    rows, columns = np.nonzero(grey(drawn(panel).png) < 8)
    scale = style.SETTINGS["figure.dpi"] / axes.figure.dpi
    assert (columns.mean() + 0.5) / scale == pytest.approx(box.x0 + 0.75 * box.width, abs=1.5)
    assert (rows.mean() + 0.5) / scale == pytest.approx(high - box.y0 - 0.75 * box.height, abs=1.5)
    assert np.ptp(columns) + 1 == pytest.approx(12.0 * style.SETTINGS["figure.dpi"] / 72.0, abs=2.0)


def test_a_long_title_has_lines_and_a_longer_one_is_cut():
    title = "the peak of the side force over the load of the side where it is lesser, at nominal load and pressure"
    (axes,) = axes_of(panel_of([0, 1], [0, 1], title=title))
    assert axes.get_title().replace("\n", " ") == title
    (axes,) = axes_of(panel_of([0, 1], [0, 1], title="a very long title " * 30))
    assert axes.get_title().endswith("…")


def test_names_of_several_lines_do_not_overlap():
    names = [f"a number with a name that is far too long for one line of the picture {k}" for k in range(5)]
    with pictures._settings():
        (axes,) = axes_of(panel_of([1, 2], [0, 4], title=" and ".join(names[:2]), y=listed(names)))
        assert len(boxes(axes)) > len(names)
        assert crossing(boxes(axes)) == []


def test_a_number_at_the_end_of_a_name_keeps_its_unit():
    axis = listed([f"{'x' * k} of the file, 840 N" for k in range(1, 60)])
    lines = [line for name in pictures._words_of(axis, 250.0) for line in name.split("\n")]
    assert len(lines) > 59
    assert "N" not in lines


@pytest.mark.parametrize("title", ["100 $ per $\\frac", "$x$", "轮胎", "<b> & more"])
def test_names_are_no_formulae(title, recwarn):
    (axes,) = axes_of(panel_of([0, 1], [0, 1], title=title))
    assert axes.get_title().replace("\\$", "$") == title
    recwarn.clear()
    drawn(panel_of([0, 1], [0, 1], title=title))
    assert not recwarn.list


@pytest.mark.parametrize("columns", [1, 2])
def test_no_panel_is_too_wide_for_a_telephone(columns):
    found = drawn(*[panel_of([0, 1], [0, 1], y=Axis(label="force"))] * columns).markup
    assert float(re.search(r"--widest:([\d.]+)", found)[1]) < 440.0


def test_a_guide_does_not_widen_the_axes_beyond_it():
    (axes,) = axes_of(panel_of([0, 1], [0, 1], guides=[Guide(axis="y", at=50.0)]))
    assert axes.get_ylim()[0] < 0.0 < 50.0 < axes.get_ylim()[1]


@pytest.mark.parametrize("width", [2, 5])
@pytest.mark.parametrize(
    "ends", [(-8.8, 8.8), (0.0, 1.0), (-0.3, 0.95), (1200.0, 3400.0), (3.0, -1.0), (82.0, 97.0)]
)
def test_an_axis_has_at_least_two_round_numbers_within_its_ends(ends, width):
    axis = Axis(low=ends[0], high=ends[1])
    axes, *_ = axes_of(*[panel_of([0], [0], x=axis, y=axis)] * width)
    for one in (axes.xaxis, axes.yaxis):
        low, high = sorted(ends)
        places = [place for place in one.get_majorticklocs() if low <= place <= high]
        step = np.diff(places)
        assert len(places) >= 2
        assert step == pytest.approx(step[0])
        assert float(f"{step[0] / 10.0 ** np.floor(np.log10(step[0])):.3g}") in (1.0, 2.0, 2.5, 5.0)


@pytest.mark.parametrize("name", ["front-1", "a very long name of a tyre that somebody gave it"])
def test_no_text_lies_over_another_or_leaves_its_panel(view, name):
    tyre = view.build.config.tyre.model_copy(update={"name": name})
    config = view.build.config.model_copy(update={"tyre": tyre})
    renamed = dataclasses.replace(view, build=dataclasses.replace(view.build, config=config))
    with pictures._settings():
        for one, draw in build.BUILD.items():
            sheet = draw(renamed)
            figure = pictures.figure_of(sheet)
            figure.draw_without_rendering()
            width = figure.bbox.width / sheet.columns
            everything = [boxes(axes, sheet.columns) for axes in figure.axes]
            assert crossing([box for found in everything for box in found]) == [], one
            for axes, found in zip(figure.axes, everything, strict=True):
                box = axes.get_window_extent()
                left = width * np.floor(0.5 * (box.x0 + box.x1) / width)
                right = figure.bbox.width if sheet.scale and axes is figure.axes[0] else left + width
                assert outside(found, left, right) == [], one


def boxes(axes, columns=1):
    """Every text of axes, and those of the figure that are nearest to them in its columns, with its box [pixels]."""
    beside = [
        text for text in axes.figure.texts if nearest(text.get_window_extent(), axes.figure, columns) is axes
    ]
    texts = [
        text for text in (*axes.findobj(Text), *beside) if text.get_text().strip() and text.get_visible()
    ]
    return [(text.get_text(), text.get_window_extent()) for text in texts]


def nearest(box, figure, columns):
    """The axes in the column of a box, or across columns, whose frame is nearest to the middle of the box."""
    middle, width = 0.5 * (box.min + box.max), figure.bbox.width / columns
    left = width * np.floor(middle[0] / width)

    def distance(axes):
        frame = axes.get_window_extent()
        return np.hypot(*(middle - np.clip(middle, frame.min, frame.max)))

    there = [
        axes
        for axes in figure.axes
        if (frame := axes.get_window_extent()).x0 < left + width and frame.x1 > left
    ]
    return min(there, key=distance)


def with_channels(result, channels):
    """The build with other models of its residuals, by channel."""
    prediction = dataclasses.replace(result.prediction, channels=channels)
    return dataclasses.replace(result, fit=dataclasses.replace(result.fit, prediction=prediction))


def crossing(found):
    """Pairs of texts that lie over each other."""
    return [
        (said, other)
        for i, (said, a) in enumerate(found)
        for other, b in found[:i]
        if min(a.x1, b.x1) - max(a.x0, b.x0) > 0.5 and min(a.y1, b.y1) - max(a.y0, b.y0) > 0.5
    ]


def outside(found, left, right):
    """Texts that are not wholly between two places [pixels]."""
    return [said for said, box in found if box.x0 < left - 1.0 or box.x1 > right + 1.0]


def test_a_logarithmic_bar_begins_at_the_left_end():
    bars = Bars(name="gain", lengths=np.array([100.0]), colours=[style.ACCENT])
    axis = Axis(low=1.0, high=1e4, logarithmic=True)
    (axes,) = axes_of(panel_of([1], [0], Look(), x=axis, series=[bars]))
    (bar,) = axes.patches
    assert (bar.get_x(), bar.get_x() + bar.get_width()) == pytest.approx((1.0, 100.0))
    assert axes.get_xlim() == (1.0, 1e4)


def test_no_colour_is_that_of_two_held_angles():
    """A legend names a colour once: cambers and sideslips share none, however many there are."""
    for n in range(1, 12):
        assert not set(style.ramp(range(n)).values()) & set(style.ramp(range(12), style.WARM).values())


def test_levels_have_colours_from_dark_to_light():
    ramp = style.ramp([10.0, -10.0, 0.0])
    assert list(ramp) == [-10.0, 0.0, 10.0]
    brightness = [sum(to_rgb(colour)) for colour in ramp.values()]
    assert brightness == sorted(brightness)


def test_a_sentence_gets_the_subscripts_of_channels():
    assert labels.typeset("offset of Fy") == f"offset of {CHANNELS['Fy'].mathtext}"


def test_a_campaign_of_many_conditions_has_a_panel_for_each(view):
    """Forty loads, each as seen over both angles."""
    many = [
        dataclasses.replace(curve, load=100.0 * k, sweep=f"{curve.sweep}-{k}")
        for k in range(1, 41)
        for curve in (next(c for c in view.curves if c.over == over) for over in labels.ANGLES)
    ]
    lines = {curve: next(iter(view.lines.values())) for curve in many}
    sheet = fit.model_against_points(
        dataclasses.replace(view, curves=tuple(many), lines=lines), view.channels[0]
    )
    assert len(sheet.panels) == 80


def test_the_overview_has_the_curves_nearest_to_the_nominal_conditions(view):
    """Every channel over sideslip, and one over camber; each curve is at the nominal load, upright or without sideslip."""
    sheet, tyre = fit.overview(view), view.build.config.tyre
    assert len(sheet.panels) >= len(view.channels)
    at_nominal = np.abs(view.points.Fz - tyre.nominal_load) < 0.1 * tyre.nominal_load
    for panel in sheet.panels:
        read = [series.y for series in panel.series if not series.name.startswith("model")]
        assert read
        shown = set(np.round(np.concatenate(read), 6))
        assert any(shown <= set(np.round(view.points.channel(c.name)[at_nominal], 6)) for c in view.channels)


def test_the_overview_says_which_angle_each_of_its_colours_is(view):
    sheet = fit.overview(view)
    told = {look.colour for name, look in sheet.key.items() if "°" in name}
    lines = {
        one.look.colour
        for panel in sheet.panels
        for one in panel.series
        if len({other.look.colour for other in panel.series}) > 1
    }
    assert len(lines) > 1
    assert lines <= told
