"""Numbers of judgement of the readers; the plausible range of each channel is in ``channels.csv``."""

from tir.constant import Count, Real

SMALLEST_LOAD_IN_NEWTONS = Real(20.0, "N", "If all loads of a file are below this, they are in kilonewtons.")
SMALLEST_U_OF_READINGS = Real(
    1e-7,
    "-",
    "Standard uncertainty over the largest reading that no rig reaches: national standards of force realise 2e-5.",
)
SMALLEST_U_OF_OTHERS = Real(
    1e-3,
    "-",
    "Standard uncertainty over the median of its column below which a point outweighs a million others.",
)
RARE_SAMPLES = Real(0.01, "-", "Share of samples that spikes spoil; more have a cause, such as a wrong unit.")
STANDSTILL = Real(
    0.02,
    "-",
    "Share of the usual speed below which the wheel stands: spring rates are run at a twentieth of it.",
)
LIKENESS_OF_UNUSED_HEADING = Real(
    0.8, "-", "Similarity to a channel's name from which an unused column is pointed out."
)
LARGEST_UNPACKED = Count(
    600_000_000,
    "bytes",
    "Largest table that is read, unpacked, and recording that a window takes: twice the largest recording that was tried, "
    "of five million rows and eight channels; a packed file of 1 MB may hold 1 GB.",
)
LARGEST_RATIO = Count(
    50,
    "-",
    "Largest size of a table over that of its packed file: readings have noise, which leaves a fifth of a text; a packed row "
    "that repeats is a thousand times smaller.",
)
LARGEST_FALL_OF_GRIP = Real(
    1.6,
    "-",
    "Peak side force over load at the smallest load of a test over that at the largest: numbers in the names of columns that "
    "are loads keep within it, and numbers of wheels, which double from 1 to 2, do not.",
)
CAMBER_THAT_TURNS_LOAD = Real(
    5.0, "deg", "Below this camber both definitions of the load agree within the rig's control."
)
