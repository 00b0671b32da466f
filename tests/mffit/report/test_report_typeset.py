"""Symbols of sentences as a page shows them."""

from __future__ import annotations

import pytest

from mffit.quantities import CHANNELS, DIRECT
from mffit.report import typeset


@pytest.mark.parametrize(
    ("said", "shown"),
    [
        ("eps_gamma was 0.1 +- 0.2", f"{DIRECT['epsilon_gamma'].html} was 0.1 ± 0.2"),
        ("Fy = -3.2 N at -0.5 deg", f"{CHANNELS['Fy'].html} = −3.2 N at −0.5°"),
        ("alpha_M is 3 deg", f"{DIRECT['alpha_M'].html} is 3°"),
        ("PECP1 = -0.10", '<span class="mono">PECP1</span> = −0.10'),
        (
            "Give front-120-70.tir to a simulator.",
            "Give <code>front-120-70.tir</code> to a simulator.",
        ),
        ("columns Fy_N and u_Fy_N of camber_900N.csv", "columns Fy_N and u_Fy_N of <code>camber_900N.csv</code>"),
        ("120/70-17, 2022-11-21, 5-pole", "120/70-17, 2022-11-21, 5-pole"),
        ("chi2 5 of 20 degC", "χ² 5 of 20 °C"),
    ],
)  # fmt: skip
def test_sentence(said, shown):
    assert typeset.sentence(said) == shown


def test_what_is_verbatim_stays():
    page = '<p title="eps_gamma">eps_gamma <code>eps_gamma</code> <td class="n mono">PECP1</td><br>+-</p>'
    script = "<script>if (a < b && Fy +- c) eps_gamma</script>"
    assert typeset.page(script + "+-") == script + "±"
    assert typeset.page(page) == (
        f'<p title="eps_gamma">{DIRECT["epsilon_gamma"].html} <code>eps_gamma</code> '
        '<td class="n mono">PECP1</td><br>±</p>'
    )


def test_every_symbol_of_a_quantity_is_set():
    for quantity in DIRECT.values():
        if len(quantity.ascii) > 1:
            assert typeset.sentence(f"({quantity.ascii})") == f"({quantity.html})"


def test_a_cell_of_many_columns_knows_its_heading():
    """Also behind one that spans several; a table of few columns stays as it is."""
    heads = "".join(f"<th>{text}</th>" for text in ("Source", "u<sub>a</sub> &amp; b", "dof", ""))
    row = '<tr><td>sum</td><td colspan="2"></td><td>3</td></tr><tr><td>one</td><td>5</td><td>6</td><td></td></tr>'
    found = typeset.page(f'<table class="keep"><thead><tr>{heads}</tr></thead>{row}</table>')
    assert '<table class="stacked keep">' in found
    assert '<td colspan="2" data-label="ua &amp; b"></td><td>3</td>' in found
    assert '<td data-label="ua &amp; b">5</td><td data-label="dof">6</td><td></td>' in found
    few = "<table><thead><tr><th>File</th><th>for</th></tr></thead><tr><td>a</td><td>b</td></tr></table>"
    assert typeset.page(few) == few
