"""The record of one stretch of a recording: what became of it, and why it gives no point if it gives none."""

from __future__ import annotations

from typing import NamedTuple

PLATEAU, SWEEP, MOVE = "plateau", "sweep", "transition"


class Stretch(NamedTuple):
    """Samples ``begin`` to ``end`` (excluded) of a series."""

    begin: int
    end: int
    dropped: str = ""  #: why they give no point; empty if they do
    kind: str = PLATEAU  #: the settings rest, one angle is swept, or something else


class StretchNote(NamedTuple):
    """A stretch in a user's words: one row of ``stretches.csv``."""

    file: str
    sweep: str  #: label of the sweep it belongs to
    kind: str
    begin_s: float
    end_s: float
    first_line: int
    last_line: int
    alpha_from_deg: float
    alpha_to_deg: float
    gamma_deg: float
    Fz_N: float
    p_kPa: float
    T_degC: float
    points: int  #: that it gives
    lag_m: float  #: rolled distance by which the side force lags behind the sideslip angle
    u_lag_m: float
    hysteresis_N: float  #: half the difference between the ways up and down, rms
    dropped: str  #: why it gives no point; empty if it does
