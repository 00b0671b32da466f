"""The notebooks of the documentation, run cell by cell: what they show is true."""

from __future__ import annotations

import json
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

NOTEBOOKS = Path(__file__).parents[1] / "docs" / "notebooks"


@pytest.fixture
def run(monkeypatch):
    """Run a notebook; gives the variables that it leaves."""
    monkeypatch.chdir(NOTEBOOKS)

    def of(name):
        names = {}
        for cell in json.loads((NOTEBOOKS / f"{name}.ipynb").read_text(encoding="utf-8"))["cells"]:
            if cell["cell_type"] == "code":
                assert not cell["outputs"], "notebooks are stored without outputs"
                exec(compile("".join(cell["source"]), name, "exec"), names)
        return names

    yield of
    plt.close("all")


def test_the_tables_of_the_paper_and_a_tyre_of_known_truth(run):
    found = run("paper-and-disc")
    table = found["table"]
    assert abs(table["eps_gamma"] - table["printed eps"]).max() < 0.001
    assert abs(table["u(eps_gamma)"] - table["printed u(eps)"]).max() < 0.001
    epsilon = found["result"].measured.epsilon_gamma
    assert abs(epsilon.value - found["truth"].nominal.epsilon_gamma) < 2.0 * epsilon.u


def test_readings_of_a_campaign_that_the_fit_never_saw_lie_in_the_bands(run):
    assert 0.88 <= run("flat-belt")["share"] <= 0.995


def test_the_planted_effect_is_named_and_repaired(run):
    found = run("planted-effect")
    assert {one.effect.id for one in found["found"].effects} == {"camber-grip", "loadcell-offset-fy"}
    assert found["repaired"]["PDY3"] == pytest.approx(found["hidden"]["PDY3"], abs=0.05)
    assert found["after"].rms("Fy") < 0.1 * found["before"].rms("Fy")
