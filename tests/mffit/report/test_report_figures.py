"""The pictures show the numbers they are given."""

from __future__ import annotations

import dataclasses
import re
from html.parser import HTMLParser
from itertools import chain

import numpy as np
import pytest
from matplotlib.text import Text

from mffit.quantities import CHANNELS
from mffit.report import constants, labels, left_undrawn, style
from mffit.report.build_view import view_of
from mffit.report.drawing import panels, pictures
from mffit.report.drawing.records import Axis, Bars, Guide, Look, Panel, Sheet, Trace
from mffit.report.drawing.ticks import numbers_at
from mffit.report.figures import decomposition, fit, residuals, spin
from mffit.report.published import TYRES


@pytest.fixture(scope="module")
def view(result):
    return view_of(result)


def titles(sheet):
    return [panel.title for panel in sheet.panels]


def all_sheets(view):
    """Every figure of a build that needs no written files."""
    yield spin.camber_reduction(view)
    yield spin.alignment(view)
    for channel in view.channels:
        yield decomposition.decomposition(view, channel)
        yield fit.model_against_points(view, channel)
    yield decomposition.even_parts(view)
    yield residuals.residual_maps(view.points, [("Fy", np.zeros(len(view.points)))], view.conditions, "u")


FULL_LINE = Look(line="-")


def panel_of(over, up, look=FULL_LINE, /, **content):
    """A panel with one series."""
    series = [Trace(name="series", x=np.asarray(over, float), y=np.asarray(up, float), look=look)]
    return Panel(**{"x": Axis(), "y": Axis(), "series": series, **content})


def drawn(*members, **content):
    """The picture of a sheet with one row."""
    return pictures.draw(Sheet(rows=[members], height=1.5, **content))


def markup(*members):
    return drawn(*members).markup()


def paths(svg, colour, kind="stroke"):
    """Corners (n, 2) of every line or area of a colour, in the order of drawing."""
    found = re.findall(rf'<path d="([^"]*)" style="[^"]*\b{kind}: {colour}[;"]', svg)
    return [corners(f"M{piece}") for path in found for piece in path.split("M")[1:]]


def corners(piece):
    """Corners (n, 2) of an outline, whose steps after the first place are relative."""
    out = []
    for command, text in re.findall(r"([MlhvcqzL])([^MlhvcqzL]*)", piece):
        numbers = [float(number) for number in re.findall(r"-?(?:\d+\.?\d*|\.\d+)", text)]
        match command:
            case "M" | "L":
                steps = [np.array(numbers)]
            case "h":
                steps = [out[-1] + [numbers[0], 0.0]]
            case "v":
                steps = [out[-1] + [0.0, numbers[0]]]
            case "z":
                steps = []
            case _:
                steps = list(out[-1] + np.reshape(numbers, (-1, 2)))
        out += steps
    return np.array(out)


def corner(svg):
    """Left, right, bottom and top of the data area, from its axes."""
    upright, level = paths(svg, style.FAINT)[:2]
    return upright[0, 0], level[-1, 0], upright[0, 1], upright[-1, 1]


def test_decomposition_has_a_panel_for_every_forward_curve_and_one_of_each_camber_pair(view):
    sheet = decomposition.decomposition(view, view.channels[0])
    assert titles(sheet) == [
        "900 N, 200 kPa",
        "900 N, 250 kPa",
        "1500 N, 250 kPa",
        "1500 N, 250 kPa, γ = 20°",
        "900 N, 250 kPa",
        "1500 N, 250 kPa",
    ]


def test_raw_curve_is_the_sum_of_its_parts(view):
    for panel in decomposition.decomposition(view, view.channels[0]).panels:
        raw, odd, even = (series.y for series in panel.series)
        assert raw == pytest.approx(np.asarray(odd) + np.asarray(even))


def test_even_parts_have_a_row_per_channel_and_angle_and_a_column_per_load(view):
    sheet = decomposition.even_parts(view)
    assert titles(sheet) == [
        f"{CHANNELS[c].mathtext}, {load} N" for c in ("Fy", "Fy", "Mz", "Mz") for load in (900, 1500)
    ]
    assert [len(row) for row in sheet.rows] == [2, 2, 2, 2]
    for row in sheet.rows:
        assert len({(panel.y.low, panel.y.high, panel.y.label) for panel in row}) == 1


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


def test_residual_maps_share_one_scale_that_is_symmetric(view):
    values = np.linspace(-9.0, 9.0, len(view.points))
    sheet = residuals.residual_maps(view.points, [("Fy", values)], view.conditions, "u")
    assert sheet.scale.limit == constants.RESIDUAL_SCALE == 4.0
    for panel in sheet.panels:
        assert panel.series[0].limit == 4.0
        assert np.abs(panel.series[0].values).max() <= 4.0
    assert len({(p.x.low, p.x.high, p.y.low, p.y.high) for p in sheet.panels}) == 1


def test_a_map_is_blue_below_white_at_and_red_above_the_model(view):
    def colour(value):
        values = np.full(len(view.points), value)
        sheet = residuals.residual_maps(view.points, [("Fy", values)], view.conditions[:1], "u")
        svg = pictures.draw(sheet).rows[0][0].svg
        (fill,) = set(re.findall(rf'style="fill: (#\w+); stroke: {style.FAINT}', svg))
        return style.rgb(fill)

    red, _, blue = colour(-4.0)
    assert blue > 2 * red
    red, _, blue = colour(4.0)
    assert red > 2 * blue
    assert min(colour(0.0)) > 240


def test_points_with_equal_angles_are_drawn_apart():
    alpha, gamma = np.array([0.0, 1.0, 0.0, 0.0]), np.zeros(4)
    shift = residuals.beside(alpha, gamma)
    assert sorted(shift[[0, 2, 3]]) == [-1.0, 0.0, 1.0]
    assert shift[1] == 0.0


def test_too_many_conditions_leave_those_with_most_points(view, monkeypatch):
    monkeypatch.setattr(constants, "MOST_MAPS_PER_CHANNEL", 2)
    kept = residuals.most_populated(view.conditions)
    assert [c.title for c in kept] == ["900 N, 250 kPa", "1500 N, 250 kPa"]


def test_this_tyre_is_listed_after_the_published_ones(view):
    panel = spin.camber_reduction(view).panels[0]
    assert [*panel.y.words.values()] == [*(tyre.name for tyre in TYRES), "front-1"]
    assert panel.y.bold == "front-1"


def test_budget_bars_are_ordered_and_below_the_total(view):
    panel = spin.camber_reduction(view).panels[1]
    bars = list(panel.series[0].lengths)
    assert bars == sorted(bars, reverse=True)
    assert max(bars) <= view.measured.epsilon_gamma.u
    assert panel.guides[0].at == view.measured.epsilon_gamma.u


def test_line_over_load_is_the_one_the_file_carries(view):
    series = spin.camber_reduction(view).panels[2].series
    line = next(one for one in series if one.name.startswith("PECP1"))
    assert line.y == pytest.approx(view.measured.pecp1)


def test_alignment_has_a_panel_per_load_run_both_ways(view):
    sheet = spin.alignment(view)
    assert titles(sheet) == ["900 N", "1500 N"]
    for panel in sheet.panels:
        assert {series.name for series in panel.series} == {"rolling forwards", "rolling backwards"}


def test_a_series_is_drawn_at_its_numbers():
    """The corner of the data area belongs to the ends of both axes, the middle to their middle."""
    panel = panel_of(
        [0.0, 5.0, 10.0], [-1.0, 0.0, 1.0], x=Axis(low=0.0, high=10.0), y=Axis(low=-1.0, high=1.0)
    )
    svg = markup(panel)
    (line,) = paths(svg, FULL_LINE.colour)
    left, right, bottom, top = corner(svg)
    assert right > left
    assert bottom > top
    middle = [0.5 * (left + right), 0.5 * (top + bottom)]
    assert line == pytest.approx(np.array([[left, bottom], middle, [right, top]]), abs=0.02)


def test_axes_used_again_keep_nothing_of_the_panel_before():
    plain = panel_of([0.0, 5.0], [0.0, 1.0], title="plain")
    words = panel_of(
        [1.0, 50.0],
        [0.0, 1.0],
        x=Axis(low=1.0, high=100.0, logarithmic=True),
        y=Axis(words={0.0: "one", 1.0: "two"}, bold="two"),
        title="words",
        guides=[Guide(axis="x", at=2.0)],
    )
    alone = [drawn(panel).rows[0][0] for panel in (plain, words, plain)]
    together = pictures.draw(Sheet(rows=[[plain], [words], [plain]], height=1.5)).rows
    for one, (other,) in zip(alone, together, strict=True):
        assert one.svg == other.svg
        assert np.array_equal(one.pixels, other.pixels)


def test_unknown_values_break_a_line():
    panel = panel_of([0.0, 1.0, 2.0, 3.0, 4.0], [0.0, 1.0, np.nan, 1.0, 0.0])
    assert [len(piece) for piece in paths(markup(panel), FULL_LINE.colour)] == [2, 2]


@pytest.mark.parametrize(
    ("axis", "low", "high", "texts"),
    [
        (Axis(), -8.8, 8.8, ["−5", "0", "5"]),
        (Axis(), 0.0, 1.0, ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]),
        (Axis(), -0.3, 0.95, ["−0.25", "0.00", "0.25", "0.50", "0.75"]),
        (Axis(), 1200.0, 3400.0, ["1500", "2000", "2500", "3000"]),
        (Axis(), -9.0, 9.5, ["−5", "0", "5"]),
        (Axis(), 0.9, 1.9, ["1.0", "1.2", "1.4", "1.6", "1.8"]),
        (Axis(), 3.0, -1.0, ["−1", "0", "1", "2", "3"]),
        (Axis(logarithmic=True), 1.0, 2e5, ["1", "10", "10²", "10³", "10⁴", "10⁵"]),
        (Axis(words={0.0: "now"}), 0.0, 1.0, ["now"]),
    ],
)
def test_numbers_at_an_axis_are_round(axis, low, high, texts):
    found = numbers_at(axis, low, high, 5)
    assert [*found.values()] == texts
    assert all(min(low, high) - 1e-9 <= place <= max(low, high) + 1e-9 for place in found)


def test_an_axis_has_at_least_two_numbers():
    assert len(numbers_at(Axis(), -9.0, 9.0, 1)) >= 2
    assert len(numbers_at(Axis(), 82.0, 97.0, 2)) >= 2


def test_a_cloud_of_points_is_one_element_of_the_page():
    rng = np.random.default_rng(2)
    ends = {"x": Axis(low=-5.0, high=5.0), "y": Axis(low=-5.0, high=5.0)}
    one, many = (markup(panel_of(*rng.standard_normal((2, n)), Look(marker="."), **ends)) for n in (1, 5000))
    assert many.count("<") == one.count("<")
    assert "<image" not in many
    assert len(many) < 200_000


def test_every_panel_has_its_own_labels():
    """A page on a telephone shows one panel per row, so each carries its labels."""
    labelled = panel_of([0, 1], [0, 1], x=Axis(label="angle"), y=Axis(label="force"))
    drawing = markup(labelled, labelled, labelled)
    assert drawing.count(">force<") == drawing.count(">angle<") == drawing.count("<svg") == 3


def test_names_of_sweeps_cannot_break_the_page():
    drawing = markup(panel_of([0, 1], [0, 1], title="<script>1</script> & more"))
    assert "&lt;script&gt;1&lt;/script&gt; &amp; more" in drawing


def test_subscripts_are_set_below_the_line():
    class Text(HTMLParser):
        text = ""

        def handle_data(self, data):
            self.text += data

    drawing = markup(panel_of([0, 1], [0, 1], title=f"{CHANNELS['Fy'].mathtext} over time"))
    reader = Text()
    reader.feed(drawing)
    assert "Fy over time" in reader.text
    assert re.search(r'F<tspan dy="[\d.]+em" font-size="[\d.]+%">y</tspan><tspan dy="-', drawing)


def test_every_kind_of_mark_and_line_is_in_page_and_picture(tmp_path):
    from PIL import Image

    looks = [Look(line=line) for line in ("-", "--", ":")]
    looks += [Look(marker=mark, hollow=hollow) for mark in "o.vsDx" for hollow in (False, True)]
    for look in looks:
        with_it, without = ([panel_of([0, 1], [0, 1], one)] for one in (look, Look()))
        assert len(markup(*with_it)) > len(markup(*without))
        for name, members in (("with", with_it), ("without", without)):
            drawn(*members).save(tmp_path / f"{name}.png")
        inks = [
            np.asarray(Image.open(tmp_path / f"{n}.png").convert("L"), float) for n in ("with", "without")
        ]
        assert inks[0].shape == inks[1].shape
        assert inks[0].sum() < inks[1].sum() - 500.0, look


def test_page_and_picture_are_made_of_the_same_drawings(tmp_path):
    """A dark square in the upper right quarter of the data area is there in both."""
    from PIL import Image

    axis = Axis(low=0.0, high=4.0)
    picture = drawn(panel_of([3.0], [3.0], Look(marker="s", size=12.0, colour="#010101"), x=axis, y=axis))
    svg = picture.markup()
    picture.save(tmp_path / "square.png")
    grey = np.asarray(Image.open(tmp_path / "square.png").convert("L"))
    rows, columns = np.nonzero(grey < 5)
    pixels = constants.PICTURE_DPI / 72.0
    margin = round(pictures.MARGIN * pixels)
    panel, height = picture.rows[0][0].pixels, float(re.search(r'viewBox="0 0 [\d.]+ ([\d.]+)"', svg)[1])
    up = (margin + len(panel) - rows.mean() - 0.5) / pixels  # pixels are whole from the lower left corner
    found = [(columns.mean() + 0.5 - margin) / pixels, height - up]
    (square,) = paths(svg, "#010101", "fill")
    left, right, bottom, top = corner(svg)
    middle = [left + 0.75 * (right - left), bottom + 0.75 * (top - bottom)]
    assert 0.5 * (square.min(axis=0) + square.max(axis=0)) == pytest.approx(middle, abs=0.02)
    assert np.ptp(square, axis=0) == pytest.approx([12.0, 12.0], abs=0.03)
    assert found == pytest.approx(middle, abs=0.4)
    assert np.ptp(columns) + 1 == pytest.approx(12.0 * pixels, abs=1.5)


@pytest.mark.parametrize("name", ["front-1", "a very long name of a tyre that somebody gave it"])
def test_no_text_lies_over_another_or_leaves_its_panel(view, name):
    tyre = view.config.tyre.model_copy(update={"name": name})
    renamed = dataclasses.replace(view, config=view.config.model_copy(update={"tyre": tyre}))
    with panels.settings():
        for sheet in all_sheets(renamed):
            for figure in chain(panels.panels(sheet), panels.key(sheet)):
                found = boxes(figure)
                assert crossing(found) == []
                assert outside(found, figure) == []


def boxes(figure):
    """Every text of a figure with the box around its letters [pixels]."""
    texts = [text for text in figure.findobj(Text) if text.get_text().strip() and text.get_visible()]
    for text in texts:
        text.set_parse_math("$_{" in text.get_text())
    figure.draw_without_rendering()
    return [(text.get_text(), text.get_window_extent()) for text in texts]


def crossing(found):
    """Pairs of texts that lie over each other."""
    return [
        (said, other)
        for i, (said, a) in enumerate(found)
        for other, b in found[:i]
        if min(a.x1, b.x1) - max(a.x0, b.x0) > 0.5 and min(a.y1, b.y1) - max(a.y0, b.y0) > 0.5
    ]


def outside(found, figure):
    """Texts that are not wholly in the figure."""
    whole = figure.bbox
    return [
        said
        for said, box in found
        if box.x0 < -0.5 or box.y0 < -0.5 or box.x1 > whole.x1 + 0.5 or box.y1 > whole.y1 + 0.5
    ]


def test_a_long_title_is_cut():
    (title,) = re.findall(
        ">(a very[^<]*)<", markup(panel_of([0, 1], [0, 1], title="a very long title " * 30))
    )
    assert title.endswith("…")


@pytest.mark.parametrize("title", ["100 $ per $\\frac", "$x$", "轮胎", "two\nlines"])
def test_names_are_no_formulae(title, recwarn):
    picture = drawn(panel_of([0, 1], [0, 1], title=title))
    assert title.splitlines()[0] in picture.markup()
    assert not recwarn.list


@pytest.mark.parametrize("columns", [1, 2])
def test_no_panel_is_too_wide_for_a_telephone(columns):
    drawing = markup(*[panel_of([0, 1], [0, 1], y=Axis(label="force"))] * columns)
    assert float(re.search(r"--widest:([\d.]+)", drawing)[1]) < 440.0


def test_a_logarithmic_bar_begins_at_the_left_end():
    bars = Bars(name="gain", lengths=np.array([100.0]), places=np.array([0.0]), colours=[style.ACCENT])
    axis = Axis(low=1.0, high=1e4, logarithmic=True)
    svg = markup(panel_of([1], [0], Look(), x=axis, series=[bars]))
    (bar,) = paths(svg, style.ACCENT, "fill")
    left, right, _, _ = corner(svg)
    assert bar[:, 0].min() == pytest.approx(left, abs=0.02)
    assert bar[:, 0].max() == pytest.approx(0.5 * (left + right), abs=0.02)


def test_a_guide_is_within_the_axes():
    guide = Guide(axis="y", at=50.0, look=Look(colour="#123456", line="-"))
    svg = markup(panel_of([0, 1], [0, 1], guides=[guide]))
    (line,) = paths(svg, "#123456")
    left, right, bottom, top = corner(svg)
    assert top < line[0, 1] < bottom
    assert line[:, 0] == pytest.approx([left, right], abs=0.02)


def test_levels_have_colours_from_dark_to_light():
    ramp = style.ramp([10.0, -10.0, 0.0])
    assert list(ramp) == [-10.0, 0.0, 10.0]
    brightness = [sum(style.rgb(colour)) for colour in ramp.values()]
    assert brightness == sorted(brightness)


def test_a_sentence_gets_the_subscripts_of_channels():
    assert labels.typeset("offset of Fy") == f"offset of {CHANNELS['Fy'].mathtext}"


def test_a_campaign_of_many_conditions_is_drawn_completely(view):
    """Forty loads: a panel for each, also for the largest and for those over camber."""
    many = [
        dataclasses.replace(curve, load=100.0 * k, sweep=f"{curve.sweep}-{k}")
        for k in range(1, 41)
        for curve in view.curves[:2]
    ]
    drawn = fit.drawn_conditions(many)
    assert {key[1] for key in drawn} == {100.0 * k for k in range(1, 41)}
    assert fit.model_against_points(view, view.channels[0]).left_out == ""


def test_captions_say_what_is_left_out(view, monkeypatch):
    flat = [("Fy", np.zeros(len(view.points)))]
    assert residuals.residual_maps(view.points, flat, view.conditions, "u").left_out == ""
    monkeypatch.setattr(constants, "MOST_PANELS_OF_FIT", 1)
    monkeypatch.setattr(constants, "MOST_MAPS_OF_BUILD", 1)
    monkeypatch.setattr(constants, "MOST_PANELS_OF_PARTS", 1)
    (shown,) = fit.drawn_conditions(view.curves).values()
    rows = {int(i) for curve in view.curves for i in curve.index} - {
        int(i) for curve in shown for i in curve.index
    }
    said = fit.model_against_points(view, view.channels[0]).left_out
    assert said.startswith(f"{len(rows)} points are left out for lack of room, at ")
    maps = residuals.residual_maps(view.points, flat, view.conditions, "u")
    lost = len(view.conditions) - 1
    assert lost > 0
    assert maps.left_out == left_undrawn.panels(lost)
    assert decomposition.decomposition(view, view.channels[0]).left_out.startswith("1 of ")


def test_points_outside_every_series_are_counted(view):
    alone = left_undrawn.points(len(view.points), view.curves[1:], view.curves[1:])
    lost = len(view.points) - len({int(i) for curve in view.curves[1:] for i in curve.index})
    assert lost > 0
    assert alone.startswith(f"{lost} of {len(view.points)} points are not drawn here")


@pytest.mark.parametrize("marker", ["", "o", "s"])
def test_a_shortened_outline_draws_what_was_given(marker):
    """Lines to a hundredth, marks to a tenth of a point, also at the end of a long outline."""
    x = np.linspace(0.0, 1.0, 60)
    y = np.sin(40.0 * x)
    look = Look(colour="#123456", line="" if marker else "-", marker=marker, hollow=marker == "o")
    axes = {"x": Axis(low=0.0, high=1.0), "y": Axis(low=-1.1, high=1.1)}
    (panel,) = drawn(panel_of(x, y, look, **axes)).rows[0]
    left, right, bottom, top = corner(panel.svg)
    found = paths(panel.svg, "#123456", "fill" if marker == "s" else "stroke")
    places = (
        found[0] if not marker else np.array([0.5 * (one.min(axis=0) + one.max(axis=0)) for one in found])
    )
    given = np.column_stack([left + (right - left) * x, np.interp(y, (-1.1, 1.1), (bottom, top))])
    assert np.abs(places - given).max() < (0.11 if marker else 0.011)
