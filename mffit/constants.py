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
