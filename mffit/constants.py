"""Numbers of judgement that several folders share; each folder's own are in its ``constants.py``."""

from __future__ import annotations

from tir.constant import Count, Real

USUAL_CORNERING_STIFFNESS = Real(
    10.0,
    "1/rad",
    "Cornering stiffness over load of a usual tyre, where none was measured yet.",
    "Mottola and Massaro 2022, section 3: first step of the alignment",
)
USUAL_U_FORCE = Real(6.0, "N", "Standard uncertainty of Fy of a finished point that states none.")
USUAL_U_MOMENT = Real(0.6, "Nm", "Standard uncertainty of Mz of a finished point that states none.")
EXPLAINED_SHARE = Real(
    1.0 / 3.0,
    "-",
    "A known mistake explains an error if less than this share of the error is left when the mistake is undone.",
)
LIKENESS_OF_MISSPELT = Real(
    0.6,
    "-",
    "A key or heading is taken for a misspelt one if it is at least this like it, as difflib measures likeness.",
)
LONGEST_QUOTE = Count(
    60,
    "characters",
    "Messages quote at most this much of a file: a quotation mark that is never closed takes in half of it.",
)
COVERAGE_FACTOR_95 = Real(1.959964, "-", "Coverage factor of a 95 % interval of a normal distribution.")
AT_BOUND_SHARE = Real(
    1e-4,
    "-",
    "Distance from a bound, over the width between both bounds, at which a number counts as at the bound.",
)
HELD_BY_LIMIT_SHARE = Real(
    0.1, "-", "A number counts as held by physical limits if they supply this share of its stiffness."
)
LEAST_SQUARES_FIRST_DAMPING = Real(1e-3, "-", "Damping at which the Levenberg-Marquardt search starts.")
LEAST_SQUARES_LARGEST_DAMPING = Real(1e12, "-", "Damping at which the Levenberg-Marquardt search gives up.")
ZERO_SIDESLIP = Real(
    0.3, "deg", "Points within this sideslip as read count as straight: zeros and camber sweeps."
)
ZERO_CAMBER = Real(
    0.5, "deg", "Points within this camber as read count as upright: zeros and sideslip sweeps."
)
LARGEST_PLAIN_NUMBER = Real(1e7, "-", "Larger numbers are written with a power of ten.")
SMALLEST_PLAIN_U = Real(1e-6, "-", "A number with a smaller uncertainty is written with a power of ten.")
TERMINAL_WIDTH = Count(
    100, "-", "Characters per line of what is printed to a terminal; two windows fit side by side."
)
NEARLY_CERTAIN = Real(0.99, "-", "Larger confidences are written as more than this, as no model is certain.")
KINDS_LISTED_IN_RECORD = Count(
    6, "-", "Different words of a column that a record lists; of more it gives the number."
)
LINES_PER_RECORD = Count(
    28, "-", "Lines of a record's repr at most, so that a terminal window shows it whole."
)
