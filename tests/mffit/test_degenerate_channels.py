"""Recordings without rows, with one row, with constant or missing channels: a result or one sentence, no library warning."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from mffit.cli import main

SAMPLES = Path(__file__).parents[2] / "samples"
TABLE = pd.concat(
    [pd.read_csv(SAMPLES / "flat-track" / f"sideslip_{name}.csv") for name in ("900N_0deg", "1400N_0deg")],
    ignore_index=True,
)
TABLE = TABLE.assign(Mx_Nm=5.0, kappa=0.0, omega_radps=10.0 / 0.291)
TYRE = ["--unloaded-radius", "0.3", "--nominal-load", "1400", "--nominal-pressure", "250"]
KINDS = {
    "empty": TABLE[:0],
    "one row": TABLE[:1],
    "constant": pd.concat([TABLE[3:4]] * 20),
    "one load": TABLE.assign(Fz_N=1400.0),
    "no moment": TABLE.assign(Mx_Nm=0.0),
    "no slip": TABLE.assign(kappa=np.nan),
    "no force": TABLE.assign(Fy_N=0.0),
    "no temperature": TABLE.assign(T_degC=np.nan),
    "one gap": TABLE.assign(Fy_N=TABLE.Fy_N.where(TABLE.index != 5)),
}


def run(*arguments: object) -> int:
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # libraries replace the filters of pytest when they are imported
        try:
            main([str(argument) for argument in arguments])
        except SystemExit as end:
            return int(end.code or 0)
    return 0


@pytest.mark.parametrize("kind", KINDS)
def test_no_command_lets_a_warning_through(tmp_path, kind):
    KINDS[kind].to_csv(tmp_path / "a.csv", index=False)
    toml = tmp_path / "p" / "tyre.toml"
    found = [
        run("sniff", tmp_path / "a.csv"),
        run("init", "--from", tmp_path / "a.csv", toml.parent, *TYRE),
        run("align", tmp_path / "a.csv", "--axes", "iso", "--path-centre", "left"),
    ]
    if toml.exists():
        model = SAMPLES / "front-120-70" / "true.tir"
        found.append(run("diagnose", toml, "--model", model, "--out", tmp_path / "d"))
    assert set(found) <= {0, 2, 3}
