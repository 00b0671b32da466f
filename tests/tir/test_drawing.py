"""Pictures of a tyre: the lines are the tyre's forces, and without matplotlib there is a sentence or a table."""

from __future__ import annotations

import builtins
import pydoc
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

import tir

needs_matplotlib = pytest.mark.skipif(find_spec("matplotlib") is None, reason="matplotlib is not installed")
FILE = Path(__file__).parent / "vectors" / "moto_front.tir"


@pytest.fixture
def without_matplotlib(monkeypatch):
    known = builtins.__import__

    def refused(name, *arguments, **keywords):
        if name.split(".")[0] == "matplotlib":
            raise ImportError(name)
        return known(name, *arguments, **keywords)

    monkeypatch.setattr(builtins, "__import__", refused)


@needs_matplotlib
def test_the_lines_are_the_forces_at_the_loads_asked_for():
    tyre = tir.read(FILE)
    figure = tyre.plot(loads=[1000.0, 2000.0])
    assert [len(ax.lines) for ax in figure.axes] == [2, 2, 2, 2]
    alpha, Fy = figure.axes[0].lines[1].get_data()
    assert np.allclose(Fy, tyre(2000.0, alpha=np.radians(alpha)).Fy)
    kappa, Fx = figure.axes[2].lines[0].get_data()
    assert np.allclose(Fx, tyre(1000.0, kappa=kappa).Fx)
    gamma, thrust = figure.axes[3].lines[0].get_data()
    assert np.allclose(thrust, tyre(1000.0, gamma=np.radians(gamma)).Fy)
    assert {text.get_text() for text in figure.legends[0].get_texts()} == {"1000 N", "2000 N"}


@needs_matplotlib
def test_of_itself_a_picture_has_the_nominal_load_between_a_lower_and_a_higher_one():
    tyre = tir.read(FILE)
    low, middle, high = (float(text.get_text().split()[0]) for text in tyre.plot().legends[0].get_texts())
    assert low < middle < high
    assert middle == pytest.approx(tyre["FNOMIN"], abs=0.5)


@needs_matplotlib
def test_turn_slip_is_drawn_when_asked_for():
    plain, spun = (tir.read(FILE).plot(turn_slip=on).axes[3].lines[0].get_ydata() for on in (False, True))
    assert np.max(np.abs(plain - spun)) > 10.0


@needs_matplotlib
def test_a_notebook_shows_a_small_picture():
    shown = tir.read(FILE)._repr_html_()
    assert shown.count("data:image/png;base64,") == 1
    assert len(shown) < 60_000


@needs_matplotlib
def test_a_tyre_of_which_nothing_can_be_computed_is_text_in_a_notebook():
    shown = tir.read(FILE).replace(NOMPRES=0.0)._repr_html_()
    assert "NOMPRES is 0" in shown
    assert "UNLOADED_RADIUS" in shown
    assert "<img" not in shown


def test_text_of_a_file_is_escaped_in_a_notebook():
    tyre = tir.read(FILE).annotate(measured={"<img src=x>": tir.Quantity(1.0, 0.1, "<b>")})
    assert "<img src=x>" not in tyre._repr_html_()


def test_without_matplotlib_there_is_a_sentence(without_matplotlib):
    tyre = tir.read(FILE)
    with pytest.raises(tir.TirError, match="pip install matplotlib"):
        tyre.plot()
    assert "pip install matplotlib" in tyre._repr_html_()


def test_help_begins_with_the_call():
    words = pydoc.render_doc(tir.Tyre, renderer=pydoc.plaintext)
    first = [line for line in words.splitlines() if line.strip(" |")][2:4]
    assert first[0].strip(" |") == "Tyre(values)"
    assert "tyre(Fz, alpha, gamma, kappa, phi_t, Vx, p)" in first[1]


def test_a_document_is_one_line():
    document = tir.read(FILE).document
    assert len(repr(document)) < 200
