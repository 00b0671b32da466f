"""Numbers of judgement of the readers; the plausible range of each channel is in ``channels.csv``."""

from __future__ import annotations

from tir.constant import Count, Real

SMALLEST_LOAD_IN_NEWTONS = Real(20.0, "N", "If all loads of a file are below this, they are in kilonewtons.")
LARGEST_SHARE_OF_SPIKES = Real(
    0.01, "-", "Share of implausible samples up to which they are spikes, beyond it a wrong unit."
)
LIKENESS_OF_UNUSED_HEADING = Real(
    0.8, "-", "Similarity to a channel's name from which an unused column is pointed out."
)
LIKENESS_OF_MAPPED_COLUMN = Real(
    0.5, "-", "Similarity to a channel's name from which an unknown key of [columns] means it."
)
LARGE_TEXT_FILE = Count(
    500_000, "bytes", "Larger files are read by pandas, which is fifty times as fast but names no bad cell."
)
LARGEST_UNPACKED = Count(
    600_000_000,
    "bytes",
    "Largest table that is read, unpacked: twice the largest recording that was tried, of five million rows and eight channels; "
    "a packed file of 1 MB may hold 1 GB.",
)
SHARE_OF_REGULAR_LINES = Real(
    0.5, "-", "Share of lines with equal numbers of cells (two or more) that a separator needs."
)
SHARE_OF_CELLS_IN_HEADINGS = Real(
    0.5, "-", "Share of the usual number of cells that the row of headings exceeds; a title does not."
)
CAMBER_THAT_TURNS_LOAD = Real(
    5.0, "deg", "Below this camber both definitions of the load agree within the rig's control."
)
STEADIER_LOAD_RATIO = Real(
    0.5,
    "-",
    "A load column is vertical if it varies less than this times the load turned from the wheel plane.",
)
MOST_WARNINGS_OF_A_KIND = Count(
    2,
    "-",
    "Most warnings that differ in file and numbers only; of more the first is given, and their number.",
)
