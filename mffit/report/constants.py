"""Numbers of judgement of the reports: how much a picture, a page and a terminal show, and at which scale."""

from __future__ import annotations

from tir.constant import Count, Real, Series

PICTURE_WIDTH = Real(792.0, "pt", "Width of a picture file: 11 inches, which fill a landscape page.")
PICTURE_DPI = Count(
    110, "1/inch", "Resolution of picture files: sharp on a screen, and small enough to mail."
)
WIDEST_PANEL = Real(
    396.0, "pt", "Wider panels could not be read on a telephone, which shows one panel per row."
)
NARROWEST_PANEL = Real(
    150.0, "pt", "In narrower panels the numbers at the axes take more room than the data."
)
AXIS_ROOM = Real(0.05, "-", "Share of the data's extent left free at both ends of an axis.")
MOST_TICKS = Count(
    5,
    "-",
    "Intervals between the numbers of an axis at most; more numbers do not help to read a small panel.",
)
POINTS_PER_SERIES_IN_PAGE = Count(
    1000, "-", "Points of one series in a page's table at most; more would make the page slow to open."
)
DIGITS_IN_TABLE = Count(6, "-", "Significant digits of the table behind a picture; no rig reads more.")
MOST_COLOUR_STEPS = Count(
    33, "-", "Colours of a map; neighbours cannot be told apart, and white is one of them."
)

FEWEST_SET_POINTS_OF_CURVE = Count(4, "-", "Fewer set-points over an angle show no curve.")
SET_POINT_WIDTH = Real(0.25, "deg", "Angles closer than this count as one set-point.")
LOAD_ROUNDING = Real(10.0, "N", "Load levels are named by multiples of this; rigs hold the load no better.")
PRESSURE_ROUNDING = Real(
    1000.0, "Pa", "Pressure levels are named by multiples of this; gauges read no finer."
)
UPRIGHT_ENOUGH_TO_DRAW = Real(0.5, "deg", "A held angle below this is called zero in pictures.")
STEPS_OF_MODEL_LINE = Count(
    41, "-", "Points of the model's line along a measured curve; it looks smooth at a panel's width."
)
STEPS_OF_FILE_CURVE = Count(
    81, "-", "Points of a file's curve over the whole written range, which is wider than a sweep."
)
DENSE_CURVE = Count(
    60, "-", "Curves with more points are drawn as dots instead of circles, which would cover each other."
)
WHOLE_DEGREES = Real(0.15, "deg", "Cambers this close to whole degrees are written without decimals.")
MOST_PANELS_OF_FIT = Count(
    15, "-", "Panels of points and model at most; a page with more is not looked through."
)
MOST_PANELS_OF_PARTS = Count(
    18, "-", "Panels of odd and even parts at most; a page with more is not looked through."
)
MOST_LOADS_SIDE_BY_SIDE = Count(4, "-", "Columns of a picture with a column per load at most.")
FEWEST_POINTS_OF_PARTS = Count(
    7, "-", "Curves with fewer points are left out of the picture of parts while there are longer ones."
)
NEAR_ZERO_SIDESLIP = Real(1.6, "deg", "End of the sideslip axis in the picture of the alignment.")
MOST_BUDGET_BARS = Count(8, "-", "Sources of uncertainty drawn at most; smaller ones are in the table.")
LONGEST_NAME_AT_AXIS = Count(18, "-", "Characters of a tyre's name beside a panel; longer names are cut.")
HELD_CAMBER_SHARES = Series(
    (0.0, 0.4, 0.8), "-", "Cambers held in the curves over sideslip, as shares of the tested camber."
)
HELD_SIDESLIP_SHARES = Series(
    (0.0, 0.4), "-", "Sideslip held in the curves over camber, as shares of the tested sideslip."
)

MOST_MAPS_PER_CHANNEL = Count(
    6, "-", "Conditions (load and pressure) with a residual map; those with most points."
)
RESIDUAL_SCALE = Real(
    4.0, "-", "End of the residual maps' colour scale in units of noise; larger residuals are as dark."
)
SMALLEST_GAP_SCALE = Real(
    4.0,
    "-",
    "The diagnosis' colour scale ends here at least, in units of noise, so that noise shows no structure.",
)
LARGEST_GAP_SCALE = Real(
    20.0,
    "-",
    "The diagnosis' colour scale ends here at most, in units of noise, so that small structure remains visible.",
)
GAP_SCALE_PERCENTILE = Real(
    98.0, "%", "The diagnosis' colour scale ends at this percentile of the residuals."
)
NEIGHBOUR_SHIFT = Real(
    0.026, "-", "Distance between points with equal angles in a map, as a share of the camber range."
)
CROWDED_MAP = Count(300, "-", "Maps with this many points or more have smaller squares.")
LOAD_TOLERANCE_OF_FRAME = Real(
    0.05, "-", "A region is framed at loads that differ from its own by this share at most."
)
MOST_FRAMES_PER_MAP = Count(3, "-", "Regions framed in a map at most; more frames would hide the map.")
MOST_CANDIDATES_DRAWN = Count(12, "-", "Candidate effects drawn per step of a diagnosis.")
MOST_STEPS_DRAWN = Count(3, "-", "Steps of a diagnosis drawn at most: one row of panels.")
SMALLEST_GAIN_DRAWN = Real(1.0, "-", "Left end of the scale of log evidence; a smaller gain needs no bar.")
MOST_DIFFERENCES_DRAWN = Count(18, "-", "Differences of a comparison drawn at most: one picture's height.")
MOST_TYRE_NUMBERS_AT_AXIS = Count(16, "-", "Numbers of tyres at the axis of a fleet's picture at most.")
MOST_SAMPLES_DRAWN = Count(6000, "-", "Samples of a recording drawn; more would only thicken the lines.")
GAP_IN_TIME_DRAWN = Real(0.004, "-", "Width of a closed gap in time, as a share of the recorded time.")

MOST_ROWS_COMPARED = Count(
    30, "-", "Coefficients and sweeps listed in the page of a comparison; compare.json holds all of them."
)
MOST_CANDIDATE_RUNS_IN_PAGE = Count(15, "-", "Candidate runs listed in the page of a plan.")
MOST_CANDIDATE_RUNS_IN_TERMINAL = Count(6, "-", "Candidate runs listed in a terminal, which scrolls.")
MOST_ROWS_IN_TERMINAL = Count(
    12, "-", "Rows of a table in a terminal, if a file or the page holds all of them."
)
