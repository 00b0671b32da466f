"""`mffit show` without a browser: the files it reads, names of tyres, ranges of sliders, files it refuses to replace."""

from __future__ import annotations

import math
import os
from pathlib import Path

import pytest

import mffit
import tir
from mffit.cli import main
from mffit.errors import InputError
from mffit.tested import end_tested, words_on_tested
from mffit.viewer.controls import settings
from mffit.viewer.named import described, named, tell_apart

SAMPLES = Path(__file__).parents[3] / "samples"
FRONT, REAR = SAMPLES / "front-120-70" / "true.tir", SAMPLES / "rear-190-55" / "true.tir"


def status(*arguments: object) -> int:
    try:
        main([str(argument) for argument in arguments])
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else 1
    return 0


def test_the_command_writes_the_page_of_the_python_function(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert status("show", FRONT, REAR) == 0
    assert "front-120-70/true, rear-190-55/true" in capsys.readouterr().out
    assert (tmp_path / "true.html").read_text(encoding="utf-8").startswith(mffit.show([FRONT, REAR]).html)


def test_the_page_is_opened_when_asked(tmp_path, monkeypatch):
    launched: list[str] = []
    monkeypatch.setattr("click.launch", launched.append)
    page = tmp_path / "page.html"
    assert status("show", FRONT, "--out", page) == 0
    assert launched == []
    assert status("show", FRONT, "--out", page, "--open") == 0
    assert launched == [str(page)]


def test_a_page_is_written_again_and_nothing_else_is_replaced(tmp_path):
    page = tmp_path / "page.html"
    assert status("show", FRONT, "--out", page) == 0
    first = page.read_bytes()
    assert status("show", FRONT, REAR, "--out", page) == 0
    assert page.read_bytes() != first
    page.write_bytes(first.replace(b"<main>", b"<main>my own words"))
    changed = page.read_bytes()
    assert status("show", FRONT, "--out", page) == 2
    assert page.read_bytes() == changed
    mine = tmp_path / "copy.tir"
    mine.write_bytes(FRONT.read_bytes())
    assert status("show", mine, "--out", mine) == 2
    assert mine.read_bytes() == FRONT.read_bytes()
    assert sorted(os.listdir(tmp_path)) == ["copy.tir", "page.html"]


@pytest.mark.parametrize("out", ["a-folder", "a-file/page.html"])
def test_a_place_that_cannot_be_written_to_is_named(tmp_path, capsys, out):
    (tmp_path / "a-folder").mkdir()
    (tmp_path / "a-file").write_text("mine", encoding="ascii")
    assert status("show", FRONT, "--out", tmp_path / out) == 2
    assert str(tmp_path / out) in capsys.readouterr().err


def test_a_missing_file_ends_in_a_sentence(tmp_path, capsys):
    assert status("show", tmp_path / "none.tir") == 2
    assert "none.tir" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_a_value_that_cannot_be_drawn_is_named():
    with pytest.raises(InputError, match="PKY1 is nan"):
        mffit.show(tir.read(FRONT).replace(PKY1=math.nan))
    with pytest.raises(InputError, match="no tyre"):
        mffit.show([])


def test_names_tell_files_apart():
    assert tell_apart([Path("a/x.tir"), Path("a/y.tir")]) == ["x", "y"]
    assert tell_apart([Path("r/a/x.tir"), Path("r/b/x.tir"), Path("r/b/y.tir")]) == ["a/x", "b/x", "b/y"]
    assert len(set(tell_apart([Path("x.tir"), Path("x.tir")]))) == 2
    assert list(named({"before": FRONT, "after": tir.read(FRONT)})) == ["before", "after"]


def test_names_are_escaped():
    page = mffit.show({"</script><script>alert(1)</script>": FRONT}).html
    assert "<script>alert" not in page
    assert page.count("</script>") == 2


def test_the_page_makes_no_requests():
    page = mffit.show(FRONT).html
    assert "default-src 'none'" in page
    page = page.replace("http://www.w3.org/2000/svg", "")  # a namespace, not an address
    assert [word for word in ("http://", "https://", " src=", "@import", "fetch(") if word in page] == []


def test_the_tested_range_of_a_build_is_read_back():
    """Comments of a built file, and the ranges that the page reads from them."""
    assert end_tested(f"estimate, checked plausible, {words_on_tested(-0.139626, 'rad')}") == -0.139626
    assert end_tested("estimate, checked plausible") is None
    built = tir.read(FRONT).annotate(
        status={"ALPMIN": words_on_tested(-0.14, "rad"), "ALPMAX": words_on_tested(0.14, "rad")}
    )
    ranges = described("x", built, [])["ranges"]
    assert ranges["alpha"] == {"written": (-0.26, 0.26), "tested": [-0.14, 0.14]}
    assert ranges["gamma"]["tested"] is None


@pytest.mark.parametrize(
    ("outputs", "estimates"),
    [
        (["Fx", "K_xk"], ["PKX1"]),
        (["Mx"], [*(f"QSX{i}" for i in range(1, 15)), "PPMX1"]),
        (["My"], [f"QSY{i}" for i in range(1, 9)]),
        (["sigma_y"], ["LATERAL_STIFFNESS"]),
    ],
)
def test_an_estimated_output_is_told_from_a_measured_one(outputs, estimates):
    known = tir.read(FRONT).annotate(status=dict.fromkeys(estimates, "fitted +- 0.3"))
    one = known.annotate(status=dict.fromkeys(estimates[1:], "default, not measured"))
    guessed = one.annotate(status={estimates[0]: "estimate, not measured"})
    found = [described("x", tyre, [])["estimated"] for tyre in (known, one, guessed)]
    assert found == [[], [], outputs]


def test_sliders_reach_as_far_as_the_files_and_no_further_than_tyres():
    by_name = {row["name"]: row for row in settings([tir.read(FRONT)])}
    assert (by_name["Fz"]["min"], by_name["Fz"]["max"], by_name["Fz"]["start"]) == (200, 3500, 1400)
    assert by_name["gamma"]["max"] == pytest.approx(math.degrees(0.96), abs=0.5)
    uneven = tir.read(FRONT).replace(FZMIN=697.5, FZMAX=3303.0)
    row = settings([uneven])[0]
    assert row["min"] >= 697.5 > row["min"] - row["step"]
    assert row["max"] <= 3303.0 < row["max"] + row["step"]
    endless = tir.Tyre.from_values({"FNOMIN": 1000.0, "UNLOADED_RADIUS": 0.3, "ALPMIN": -1.5, "ALPMAX": 1.5})
    by_name = {row["name"]: row for row in settings([endless])}
    assert by_name["alpha"]["max"] == pytest.approx(20.0)
    assert (by_name["Fz"]["min"], by_name["Fz"]["max"]) == (100, 2000)
    for row in by_name.values():
        assert row["min"] <= row["start"] <= row["max"]
        assert 100 <= (row["max"] - row["min"]) / row["step"] <= 600


def test_public_names_exist():
    assert set(mffit.__all__) <= set(dir(mffit))
    assert "Any" not in dir(mffit)
    assert all(callable(getattr(mffit, name)) for name in mffit.__all__)
