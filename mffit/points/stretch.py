"""The record of one stretch of a recording: its kind, and the reason if it is dropped."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd

PLATEAU, SWEEP, MOVE = "plateau", "sweep", "transition"


class Stretch(NamedTuple):
    """Samples ``begin`` to ``end`` (excluded) of a series."""

    begin: int
    end: int
    dropped: str = ""  #: why the samples give no point; empty if they do
    kind: str = PLATEAU  #: ``PLATEAU``: all settings rest; ``SWEEP``: one angle or the slip moves; ``MOVE``: anything else
    swept: str = ""  #: setting that a sweep moves: "alpha", "gamma", "kappa" or "Fz"; empty for other kinds
    transient: int = 0  #: number of samples before ``begin`` in which the settings rest and the forces settle
    recorded: tuple[int, int] = (0, 0)  #: begin and end, counted with the samples that are left out by hand

    @property
    def rests_from(self) -> int:
        """First sample in which the settings rest."""
        return self.begin - self.transient


class StretchNote(NamedTuple):
    """One row of ``stretches.csv``, in a user's words and units."""

    file: str
    sweep: str  #: label of its sweep
    kind: str
    swept: str  #: column of the setting that a sweep moves; empty for other kinds
    begin_s: float
    end_s: float
    first_line: int
    last_line: int
    alpha_from_deg: float
    alpha_to_deg: float
    kappa_from: float  #: longitudinal slip; NaN if it was not measured
    kappa_to: float
    gamma_deg: float
    Fz_N: float
    p_kPa: float
    T_degC: float
    points: int  #: number of points that it gives
    dropped: str  #: why it gives no point; empty if it does


def runs(mask: np.ndarray) -> list[tuple[int, int]]:
    """Begin and end (excluded) of every run of a mask (n,)."""
    edges = np.flatnonzero(np.diff(np.r_[False, mask, False].astype(np.int8)))
    return [(int(begin), int(end)) for begin, end in zip(edges[::2], edges[1::2], strict=True)]


DIGITS = {
    "begin_s": 3, "end_s": 3, "alpha_from_deg": 2, "alpha_to_deg": 2, "kappa_from": 4, "kappa_to": 4, "gamma_deg": 2,
    "Fz_N": 0, "p_kPa": 1, "T_degC": 1,
}  # fmt: skip


def stretch_table(notes: Sequence[StretchNote]) -> pd.DataFrame:
    """One row per stretch in the order of the recordings; angles in ISO signs."""
    table = pd.DataFrame(list(notes), columns=list(StretchNote._fields))
    return table.round(DIGITS)
