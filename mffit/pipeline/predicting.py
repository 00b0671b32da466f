"""``mffit predict``: forces at conditions, from the folder of a build."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from mffit import prediction


def predict(folder: str | Path, conditions: str | Path | pd.DataFrame) -> pd.DataFrame:
    """Forces at conditions, with standard uncertainties (k = 1).

    Parameters
    ----------
    folder : of a build
    conditions : table, or the path of one, with the columns ``alpha_deg``, ``gamma_deg`` and ``Fz_N``, in ISO-W; ``kappa``,
        ``p_kPa``, ``V_mps``, ``T_degC`` and, of a disc, ``phi_t_per_m`` are optional

    Returns
    -------
    DataFrame
        The conditions in the units of their names, and for each fitted channel, here Fy: ``Fy_N`` of the plain file;
        ``u_Fy_N``, with which a reading of a new run lies around it; ``Fy_best_N`` with what the formula misses;
        ``u_Fy_best_N`` of that as the tyre's mean force; ``u_Fy_run_N`` of a reading of a new run around it. Columns of these
        names in the conditions are replaced.

    Raises
    ------
    InputError
        The folder is not that of a build, or the table lacks a column or has a value that is no number or impossible.
    """
    known, tyre, fitted = prediction.load(Path(folder))
    if isinstance(conditions, pd.DataFrame):
        return known.predict(tyre, fitted, prediction.checked(conditions))
    return known.predict(tyre, fitted, prediction.read_conditions(Path(conditions)))
