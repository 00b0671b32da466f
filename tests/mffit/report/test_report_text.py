"""Tables for the terminal."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from types import SimpleNamespace

import pytest

from mffit.measured import Contribution, align
from mffit.measured.result import FINITE_SPIN
from mffit.report import text
from mffit.report.constants import MOST_REASONS
from mffit.report.text.layout import columns, table
from mffit.report.verdict import verdict
from mffit.rounding import ascii_only, decimals_of, stated
from mffit.suspicion import Trust
from tir import Quantity

BUDGET = [
    Contribution("load-cell offset", 10.0, "N", 0.03, sensitivity=0.003),
    Contribution("camber stiffness", 20.0, "N/rad", 0.04, type="A", sensitivity=-0.002, dof=9.0),
]


def test_budget_is_ordered_and_adds_up():
    assert text.budget_table(BUDGET, 0.05) == (
        "source                 type         u  sensitivity  dof  in eps_gamma  of variance\n"
        "----------------  ---------  --------  -----------  ---  ------------  -----------\n"
        "camber stiffness  A, normal  20 N/rad       -0.002    9        0.0400         64 %\n"
        "load-cell offset  B, normal      10 N        0.003  inf        0.0300         36 %\n"
        "combined (k = 1)                                               0.0500"
    )


def test_spin_summary_names_what_to_improve_first(result):
    summary = text.spin_summary(result.measured)
    first = max(result.measured.budget, key=lambda line: abs(line.contribution))
    assert f"Improve first: {first.source};" in summary
    for load in ("900", "1500"):
        assert f"\n     {load.rjust(3)}"[-4:] in summary


def test_the_spin_of_the_disc_is_nothing_to_improve(result):
    lines = (Contribution(FINITE_SPIN, 0.03, "m^2", 0.06), Contribution("load-cell offset", 10.0, "N", 0.03))
    row = replace(
        result.measured.nominal, budget=lines, epsilon_gamma=Quantity(-0.1, math.hypot(0.06, 0.03), "-")
    )
    summary = text.spin_summary(replace(result.measured, nominal=row))
    # Half of 0.03 is left, so the variance is 0.06^2 + 0.015^2.
    assert (
        "Improve first: load-cell offset; half of it would bring u(eps_gamma) from 0.067 to 0.062." in summary
    )
    assert "effective degrees of freedom: infinite" in summary


def test_alignment_table_has_a_line_per_load_and_ends_with_the_correction(result):
    alignment = align(result.points)
    table = text.alignment_table(alignment)
    assert len(table.split("\n\n")[0].splitlines()) == 2 + len(alignment.steps)
    assert f"{alignment.correction_deg:+.3f} +- {alignment.u_deg:.3f} deg" in table


def test_build_summary_begins_with_the_verdict_and_fits_a_screen(result):
    summary = text.build_summary(result, "out: report.html")
    assert summary.startswith("front-1.tir is sound: 115 points are fitted to")
    assert f"{result.fit.channels['Fy'].rmse:.2f} N in Fy" in summary
    assert "front-1.tir: for simulators that compute turn slip (USE_MODE" in summary
    assert len(summary.splitlines()) <= 25


def test_the_verdict_states_what_was_fitted_and_what_the_file_leaves(result):
    """With effects of the runs they are two numbers; the window shows the first one, too."""
    Fy, Mz = result.fit.channels["Fy"], result.fit.channels["Mz"]
    alone = {"Fy": replace(Fy, rmse=2.0 * Fy.rmse), "Mz": Mz}
    runs = SimpleNamespace(alone=alone)
    said = verdict(replace(result, fit=replace(result.fit, runs=runs)))
    assert f"fitted to {Fy.rmse:.3g} N in Fy" in said
    assert said.endswith(
        f"; the file, which holds for the mean of the runs, leaves {2.0 * Fy.rmse:.3g} N and {Mz.rmse:.3g} Nm."
    )


def test_the_zeros_of_all_channels_stand_in_the_list(result):
    rig = {"F0_N": (2.04, 0.31), "Fx0_N": (4.0, 18.2), "Mx0_Nm": (-57.3, 17.9), "gain": (1.0, 0.005)}
    summary = text.build_explained(replace(result, fit=replace(result.fit, rig=rig)))
    said = " ".join(summary.split())
    for zero in ("Fy 2.04 +- 0.31 N", "Fx 4 +- 18 N", "Mx -57 +- 18 Nm"):
        assert f"load-cell zero of {zero}" in said
    assert "calibration" not in said


def test_what_is_explained_has_statuses_and_what_the_files_are(result):
    said = text.build_explained(result)
    assert "1 fitted, 1 measured, 1 regularised, 1 base, 1 default; at a bound or limit: PHYP2" in said
    assert "turn slip on" in said


def test_a_result_that_is_not_to_be_trusted_says_so_and_why_first(result):
    reasons = [f"reason {k} " + "with many words " * 40 for k in range(5)]
    lines = text.build_summary(replace(result, trust=Trust(reasons=tuple(reasons)))).splitlines()
    assert "NOT TO BE TRUSTED" in lines[0]
    assert [line[:27] for line in lines if line.startswith("NOT")] == [
        f"NOT TO BE TRUSTED: reason {k}" for k in range(MOST_REASONS)
    ]


def test_warnings_are_few_and_the_rest_is_counted():
    said = text.few([f"warning {k}" for k in range(5)])
    assert said[-1].startswith(f"{5 - MOST_REASONS} more")
    assert text.few(["one"]) == ["one"]


def test_what_to_do_is_never_cut(result):
    """A sentence ends with its cure."""
    sentence = "the readings disagree " + "with many words " * 40 + "; zero the load cell"
    summary = text.build_summary(replace(result, trust=Trust(reasons=(sentence,))))
    assert sentence in " ".join(summary.split())
    assert text.few([sentence]) == [sentence]


def test_a_doubt_is_said_whole_below_the_verdict(result):
    doubt = "what is in doubt, with " + "a long cause, " * 20 + "and the cure"
    said = " ".join(text.build_summary(replace(result, trust=Trust(doubts=(doubt,)))).split())
    assert f"In doubt: {doubt}." in said


def test_the_summary_ends_with_commands_as_a_shell_takes_them(result):
    said = text.build_summary(result, following=[("mffit build a.toml --explain", "what it does")])
    assert said.splitlines()[-2:] == ["Next:", "  mffit build a.toml --explain  # what it does"]


def test_the_terminal_states_one_cornering_stiffness(result):
    """That of the tyre; the slope along the path of the disc is a step of the direct method."""
    for said in (text.build_summary(result), text.build_explained(result)):
        assert len(re.findall(r"\bC_alpha", said)) <= 1


@pytest.mark.parametrize("width", [60, 80, 100])
def test_terminal_text_is_ascii_and_fits_a_line(result, monkeypatch, width):
    """A command stays whole, as a shell takes it."""
    monkeypatch.setenv("COLUMNS", str(width))
    command = f"mffit build {'a' * width}.toml"
    for summary in (
        text.spin_summary(result.measured),
        text.build_summary(result, following=[(command, "what it does")]),
        text.build_explained(result),
    ):
        assert summary.isascii()
        own = [line for line in summary.splitlines() if command not in line]
        assert max(map(len, own)) <= width


def test_columns_beyond_the_terminal_follow_below_beside_the_first(monkeypatch):
    monkeypatch.setenv("COLUMNS", "30")
    parts = table(["name", *("abcdefgh" for _ in range(4))], [["Fy", "1", "2", "3", "4"]]).split("\n\n")
    assert [part.splitlines()[-1].split() for part in parts] == [["Fy", "1", "2"], ["Fy", "3", "4"]]


def test_estimates_without_an_uncertainty_have_the_digits_of_the_measured_one(result):
    measured = result.measured
    _, estimates = next(
        line.split(maxsplit=1) for line in text.spin_summary(measured).splitlines() if line.startswith("from")
    )
    digits = decimals_of(measured.epsilon_gamma.u)
    assert f"slope {measured.nominal.epsilon_slope:.{digits}f}" in estimates.split(", ")
    assert f"secant {measured.nominal.epsilon_secant:.{digits}f}" in estimates.split(", ")
    assert f"Mz (informational) {measured.nominal.epsilon_moment:.{digits}f}" in estimates.split(", ")
    assert f"debiased {ascii_only(stated(measured.epsilon_gamma_debiased))}" in estimates.split(", ")


def test_a_name_with_the_mark_of_columns_costs_no_table():
    found = columns("tyre ¦ rms\na ¦ b ¦ 1.5\nc\n").splitlines()
    assert found == ["tyre  rms", "----  ---", "a       b", "c"]
