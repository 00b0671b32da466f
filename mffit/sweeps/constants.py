"""Numbers of judgement of the readers; the plausible range of each channel is in ``channels.csv``."""

from __future__ import annotations

from tir.constant import Count, Real

SMALLEST_LOAD_IN_NEWTONS = Real(20.0, "N", "If all loads of a file are below this, they are in kilonewtons.")
LARGEST_SHARE_OF_SPIKES = Real(
    0.01,
    "-",
    "Samples of a recording outside the plausible range are spikes up to this share, beyond it a wrong unit.",
)
LIKENESS_OF_UNUSED_HEADING = Real(
    0.8, "-", "A column that is not used is pointed out if its heading is this like a channel's name."
)
LIKENESS_OF_MAPPED_COLUMN = Real(
    0.5,
    "-",
    "A key of [columns] that is no channel is taken for the channel whose name is at least this like it.",
)
LARGE_TEXT_FILE = Count(
    2_000_000,
    "bytes",
    "Larger text files are read by pandas, which is fifty times as fast but cannot name a bad cell.",
)
BYTES_THAT_SHOW_DIALECT = Count(
    65_536,
    "bytes",
    "Separator, decimal comma and encoding are found from the start of a file of this length.",
)
BYTES_THAT_SHOW_BINARY = Count(
    4096, "bytes", "A file with a zero byte within this length is binary, not text."
)
UNPACKED_OVER_PACKED = Real(
    4.0, "-", "Estimate of the size of a .gz file of text after unpacking, over its size on disk."
)
LINES_THAT_SHOW_DIALECT = Count(200, "lines", "Lines from which separator and decimal comma are found.")
SHARE_OF_REGULAR_LINES = Real(
    0.5,
    "-",
    "A separator is right if at least this share of the lines has the same number of cells, two or more.",
)
SHARE_OF_CELLS_IN_HEADINGS = Real(
    0.5,
    "-",
    "The first row with more than this share of the usual number of cells holds the headings; rows above are title.",
)
LARGEST_TABLE_KEPT = Count(
    5_000_000, "cells", "Smaller tables stay in memory while a command looks at the same file repeatedly."
)
CAMBER_THAT_TURNS_LOAD = Real(
    5.0,
    "deg",
    "Below this camber, vertical load and load along the wheel plane agree within the control of the load.",
)
STEADIER_LOAD_RATIO = Real(
    0.5,
    "-",
    "A load column is the vertical load if it varies less than this times as much as when it is turned from the wheel plane.",
)
MATLAB_TIMEOUT = Real(600.0, "s", "Many times what reading the largest recording takes.")
LONGEST_UNIT = Count(24, "characters", "A longer text is not a unit; pint is not asked to parse it.")
