"""The stretches of recordings as a table: ``stretches.csv``."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd

from mffit.points.stretch import StretchNote

DIGITS = {
    "begin_s": 3, "end_s": 3, "alpha_from_deg": 2, "alpha_to_deg": 2, "kappa_from": 4, "kappa_to": 4, "gamma_deg": 2,
    "Fz_N": 0, "p_kPa": 1, "T_degC": 1, "lag_m": 4, "u_lag_m": 4,
}  # fmt: skip


def stretch_table(notes: Sequence[StretchNote]) -> pd.DataFrame:
    """One row per stretch in the order of the recordings; angles in ISO signs."""
    table = pd.DataFrame(list(notes), columns=list(StretchNote._fields))
    return table.round(DIGITS)
