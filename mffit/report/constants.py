"""Numbers of judgement of the reports: how much a picture, a page and a terminal show, and at which scale."""

from __future__ import annotations

from tir.constant import Count, Real, Series

PICTURE_WIDTH = Real(792.0, "pt", "Width of a picture file: 11 inches, which fill a landscape page.")
PAPER_WIDTH = Real(
    680.0,
    "px",
    "Width of a sheet of A4 between the margins, for panels side by side, in which a point is a pixel: letters of 7.5 pt are "
    "then 7 px or more.",
)
PICTURE_DPI = Count(110, "1/inch", "Resolution of picture files: sharp on a screen and small enough to mail.")
PICTURE_COMPRESSION = Count(3, "-", "Level of PNG: twice as fast as the usual 6, for files a twelfth larger.")
WIDEST_PANEL = Real(
    338.0,
    "pt",
    "Two lie side by side on a sheet of A4; a telephone, which shows one panel per row, shows no wider one.",
)
NARROWEST_PANEL = Real(150.0, "pt", "In narrower panels the axis numbers need more room than the data.")
AXIS_ROOM = Real(0.05, "-", "Share of the data's range left free at both ends of an axis.")
BAND_OPACITY = Real(0.25, "-", "Opacity of bands: three that overlap can still be told apart.")
MOST_TICKS = Count(
    5, "-", "Most intervals between the numbers of an axis; more do not help in a small panel."
)
POINTS_PER_SERIES_IN_PAGE = Count(
    1000, "-", "Most points of a series in a page's table; more would slow the page."
)
LARGEST_PLAIN_TABLE = Count(
    40_000, "bytes", "Longer tables behind a picture are packed; a page then has a third of the size."
)
MOST_MARKS_IN_HUNDREDTHS = Count(
    8,
    "-",
    "Outlines of more pieces are marks, drawn to a tenth of a point, which is less than a pixel; lines are drawn to a hundredth.",
)
POINTS_PER_SERIES_DRAWN = Count(
    4000, "-", "Most points of a series in a picture: more lie on top of each other, and slow the page."
)
DIGITS_IN_TABLE = Count(6, "-", "Significant digits of the table behind a picture; no rig has more.")
MOST_COLOUR_STEPS = Count(33, "-", "Colours of a map; white is one of them, and neighbours look alike.")

FEWEST_SET_POINTS_OF_CURVE = Count(4, "-", "Fewer set-points over an angle show no curve.")
SET_POINT_WIDTH = Real(0.25, "deg", "Angles closer than this count as one set-point.")
SLIP_SET_POINT_WIDTH = Real(0.01, "-", "Longitudinal slips closer than this count as one set-point.")
LOAD_ROUNDING = Real(10.0, "N", "Load levels are named by multiples of this, the accuracy of a held load.")
PRESSURE_ROUNDING = Real(
    1000.0, "Pa", "Pressure levels are named by multiples of this, the resolution of gauges."
)
UPRIGHT_ENOUGH_TO_DRAW = Real(0.5, "deg", "A held angle below this is called zero in pictures.")
STEPS_OF_MODEL_LINE = Count(41, "-", "Points of the model's line along a measured curve; it looks smooth.")
STEPS_OF_FILE_CURVE = Count(
    81, "-", "Points of a file's curve over the written range, which is wider than a sweep."
)
DENSE_CURVE = Count(60, "-", "Curves with more points are drawn as dots, as circles would cover each other.")
WHOLE_DEGREES = Real(0.15, "deg", "Cambers this close to whole degrees are written without decimals.")
MOST_PANELS_OF_FIT = Count(
    90, "-", "Most panels of points and model: a picture of three pages. The caption says what is left out."
)
PANELS_OF_FULL_SIZE = Count(
    15, "-", "Above this number, panels are small, so that the conditions are seen side by side."
)
MOST_PANELS_OF_PARTS = Count(18, "-", "Most panels of odd and even parts that a reader looks through.")
MOST_LOADS_SIDE_BY_SIDE = Count(4, "-", "Columns of a picture with a column per load at most.")
FEWEST_POINTS_OF_PARTS = Count(
    7, "-", "Curves with fewer points are left out of the picture of parts if longer ones exist."
)
NEAR_ZERO_SIDESLIP = Real(1.6, "deg", "End of the sideslip axis in the picture of the alignment.")
MOST_BUDGET_BARS = Count(8, "-", "Sources of uncertainty drawn at most; smaller ones are in the table.")
LONGEST_NAME_AT_AXIS = Count(18, "-", "Characters of a tyre's name beside a panel; longer names are cut.")
HELD_SLIP_SHARES = Series(
    (0.0, 0.15, 0.5),
    "-",
    "Longitudinal slips of the curves of trail, as shares of the tested slip: none, small, large.",
)
LEAST_PURE_FORCE = Real(
    0.25, "-", "Least force of pure slip over its peak for which readings show a weight of combined slip."
)
HELD_CAMBER_SHARES = Series(
    (0.0, 0.4, 0.8), "-", "Cambers of the curves over sideslip, as shares of the tested camber."
)
HELD_SIDESLIP_SHARES = Series(
    (0.0, 0.4), "-", "Sideslip of the curves over camber, as shares of the tested sideslip."
)

MOST_MAPS_PER_CHANNEL = Count(
    30,
    "-",
    "Most conditions with a residual map: more than most campaigns have; those with the most points are shown.",
)
MOST_MAPS_OF_BUILD = Count(
    60,
    "-",
    "Most residual maps per channel in the report of a build, in rows of six. The caption says what is left out.",
)
MAPS_PER_ROW = Count(
    6, "-", "Residual maps beside each other; more would be narrower than their axis labels."
)
SLIP_SHOWN_APART = Real(0.1, "-", "Slips that differ by a tenth of this lie beside each other in a map.")
SHARE_OF_ROOM = Real(
    0.9, "-", "Share of the room to the end of a map's axis that points at one place fill at most."
)
RESIDUAL_SCALE = Real(4.0, "-", "End of the colour scale of residual maps, in units of noise.")
SMALLEST_GAP_SCALE = Real(
    4.0, "-", "Shortest colour scale of a diagnosis in units of noise, so that noise looks plain."
)
LARGEST_GAP_SCALE = Real(
    20.0, "-", "Longest colour scale of a diagnosis in units of noise, so that structure stays visible."
)
GAP_SCALE_PERCENTILE = Real(98.0, "%", "Percentile of the residuals at which this colour scale ends.")
NEIGHBOUR_SHIFT = Real(0.026, "-", "Distance of points with equal angles in a map, over the range of camber.")
CROWDED_MAP = Count(300, "-", "Maps with this many points or more have smaller squares.")
LOAD_TOLERANCE_OF_FRAME = Real(
    0.05, "-", "A region is framed at loads that differ from its own by less, relatively."
)
MOST_FRAMES_PER_MAP = Count(3, "-", "Most regions framed in a map; more frames would hide it.")
MOST_CANDIDATES_DRAWN = Count(12, "-", "Candidate effects drawn per step of a diagnosis.")
MOST_STEPS_DRAWN = Count(3, "-", "Steps of a diagnosis drawn at most: one row of panels.")
SMALLEST_GAIN_DRAWN = Real(1.0, "-", "Left end of the scale of log evidence; smaller gains have no bar.")
MOST_DIFFERENCES_DRAWN = Count(18, "-", "Differences of a comparison drawn at most: one picture's height.")
MOST_TYRE_NUMBERS_AT_AXIS = Count(16, "-", "Numbers of tyres at the axis of a fleet's picture at most.")
CHARACTERS_BELOW_A_SHEET = Count(
    100, "characters", "Names of tyres up to this length fit below the axis of one panel of full width."
)
MOST_SAMPLES_DRAWN = Count(
    6000, "-", "Most samples of a recording that are drawn; more only thicken the lines."
)
GAP_IN_TIME_DRAWN = Real(0.004, "-", "Width of a closed gap in time, as a share of the recorded time.")

MOST_ROWS_COMPARED = Count(30, "-", "Most rows of a table in the page of a comparison; compare.json has all.")
MOST_CANDIDATE_RUNS_IN_PAGE = Count(15, "-", "Candidate runs listed in the page of a plan.")
MOST_CANDIDATE_RUNS_IN_TERMINAL = Count(6, "-", "Candidate runs listed in a terminal, which scrolls.")
MOST_LEFT_OUT_ONE_BY_ONE = Count(
    5, "-", "Readings of one file that one rule leaves out, listed one by one; more share a line of the page."
)
MOST_ROWS_IN_TERMINAL = Count(12, "-", "Most rows of a table in a terminal if a file or page has all.")

LARGEST_SLIP_TO_DRAW = Real(0.2, "-", "Longitudinal slip to which the force of a sister tyre is drawn.")
SIDESLIPS_OF_BORROWED_FORCE = Series((0.0, 4.0), "deg", "Sideslip angles at which it is drawn.")
PANELS_PER_ROW_OF_MEANS = Count(3, "-", "Panels beside each other in the picture of mean residuals.")
