"""Which formula a file is of: by FITTYP, else by keys that only one formula has, else by its format; else it is asked."""

from __future__ import annotations

import pytest

import tir
from tir.document import parse_document
from tir.formula import NEW_KEYS, OLD_KEYS, formula_of
from tir.parameters import BY_NAME

COMMON = "[DIMENSION]\nUNLOADED_RADIUS = 0.3\n[VERTICAL]\nFNOMIN = 4000\n"
COMMON += "[LATERAL_COEFFICIENTS]\nPCY1 = 1.3\nPDY1 = 1\nPKY1 = -20\n"


def kind(tag="", more="", fittyp=""):
    head = [f"PROPERTY_FILE_FORMAT = '{tag}'"] * bool(tag) + [f"FITTYP = {fittyp}"] * bool(fittyp)
    return formula_of(parse_document("\n".join(["[MODEL]", *head, COMMON + more]))).kind


@pytest.mark.parametrize("tag", ["", "USER", "MF52", "MF_52", "SWIFT", "DELFT", "anything else"])
@pytest.mark.parametrize(
    ("more", "expected"),
    [
        ("PHY3 = 0.01\n", "5.2"),
        ("PTX1 = 2\nPPX1 = -0.3\nPHYP1 = 1\n", "5.2"),  # PAC2002 has terms of pressure and turn slip too
        (
            "LGAX = 1\n[OPERATING_CONDITIONS]\nNOMPRES = 2e5\n",
            "5.2",
        ),  # completed for a program that asks for a pressure
        ("PKY6 = -1\n", "6"),
        ("QSX13 = 0\nPKY4 = 2\n", "6"),
        ("PHY3 = 0.01\nPPY5 = 0.1\n", "unknown"),
        (
            "PHY3 = 0.01\nPPY5 = 0\nPKY4 = 2\nLKYC = 1\n",
            "5.2",
        ),  # completed for a program that asks for every key
        ("PHY3 = 0\nLGAX = 1\nPKY6 = -0.9\n", "6"),
        ("PCY2 = 0.7\nPKY6 = 0.9\nPTY1 = 1\n", "motorcycle"),
    ],
)
def test_keys_decide_whatever_the_format_is_called(tag, more, expected):
    assert kind(tag, more) == expected


@pytest.mark.parametrize(
    ("tag", "expected"),
    [
        ("PAC2002", "5.2"),
        ("MF_05", "5.2"),
        ("MF-TYRE", "5.2"),
        ("MF-Tyre 5.2", "5.2"),
        ("MF61", "6"),
        ("MF-TYRE 6.2", "6"),
        ("PAC_MC", "motorcycle"),
        ("PAC-MC", "motorcycle"),
        ("MF-MCTYRE", "motorcycle"),
        ("PAC_TIME", "other"),
        ("PAC94", "other"),
        ("", "unknown"),
        ("USER", "unknown"),
    ],
)
def test_the_format_decides_between_keys_that_all_have(tag, expected):
    assert kind(tag) == expected


@pytest.mark.parametrize(
    ("remark", "tag", "expected"),
    [
        ("MF61", "", "6"),
        ("MF-TYRE 5.0 (W-axis system)", "", "5.2"),
        ("PAC2002 2018", "USER", "5.2"),
        ("MF61", "MF-TYRE", "5.2"),  # the format comes before a remark
        ("anything", "", "unknown"),
    ],
)
def test_a_remark_decides_where_no_format_does(remark, tag, expected):
    head = f"! : TIRE_VERSION :  {remark} \n[MODEL]\nPROPERTY_FILE_FORMAT = '{tag}'\n"
    assert formula_of(parse_document(head + COMMON)).kind == expected


def test_a_stated_version_comes_first():
    assert kind("PAC2002", "PHY3 = 0.01\n", "61") == "6"
    assert kind("", "", "6") == kind("MF61", "", "21") == "5.2"
    assert kind("", "", "52") == "motorcycle"
    assert kind("", "PKY6 = -1\nPPY5 = 0\n", "6") == "unknown"  # it contradicts its keys
    assert kind("", "PKY4 = 2\nPKY6 = 0\nLKYC = 1\n", "6") == "5.2"


def test_the_keys_of_a_formula_are_its_own():
    assert not OLD_KEYS & BY_NAME.keys()
    assert set(BY_NAME) >= NEW_KEYS


def test_what_cannot_be_told_is_asked_and_can_be_said(tmp_path):
    path = tmp_path / "t.tir"
    path.write_text(COMMON)
    with pytest.raises(
        tir.TirError, match=r"which version.*FITTYP = 62.*tir\.read\(path, FITTYP=62\).*--fittyp 6"
    ):
        tir.read(path)
    said = tir.read(path, FITTYP=62)
    path.write_text("[MODEL]\nFITTYP = 62\n" + COMMON)
    assert tir.read(path) == said


@pytest.mark.parametrize("model", ["FIALA", "5.2.1", "UA", "FTIRE", "TMEASY"])
def test_another_model_is_named(tmp_path, model):
    path = tmp_path / "t.tir"
    text = f"[MODEL]\nPROPERTY_FILE_FORMAT = '{model}'\n[DIMENSION]\nUNLOADED_RADIUS = 0.3\n[PARAMETER]\nCALPHA = 5e4\n"
    path.write_text(text)
    with pytest.raises(tir.TirError, match=f"another tyre model, {model} "):
        tir.read(path)
