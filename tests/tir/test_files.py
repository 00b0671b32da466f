"""Property files: what the wild holds is read, what is written comes back, readers of every kind accept it."""

from __future__ import annotations

import math
import os
import re
import threading
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tir
from tir.checking import check
from tir.document import encoded
from tir.parameters import TABLE

VECTORS = Path(__file__).parent / "vectors"
TEXT = (VECTORS / "moto_front.tir").read_text(encoding="ascii")
NUMBERS = [
    row.name
    for row in TABLE
    if row.kind == "number" and row.name not in ("FITTYP", "UNLOADED_RADIUS", "FNOMIN")
]


@pytest.fixture
def tyre() -> tir.Tyre:
    return tir.read(VECTORS / "moto_front.tir")


def read_text(tmp_path: Path, text: str | bytes) -> tir.Tyre:
    path = tmp_path / "t.tir"
    path.write_bytes(text if isinstance(text, bytes) else text.encode("latin-1"))
    return tir.read(path)


@pytest.mark.parametrize(
    "mangled",
    [
        TEXT.replace("\n", "\r\n"),
        TEXT.replace("\n", "\r"),
        b"\xef\xbb\xbf" + TEXT.encode(),
        TEXT.encode("utf-16"),
        b"\xfe\xff" + TEXT.encode("utf-16-be"),
        TEXT.replace("! Motorcycle", "! Motorradreifen, Größe 120").encode("latin-1"),
        TEXT.replace("= 1.27\n", "= 1.27D+00   $ Fortran\n"),
        TEXT.replace("= 1.27\n", "=1.27!inline\n"),
        TEXT.replace("'LEFT'", '"LEFT"'),
        TEXT.replace("PDY1  ", "pdy1  "),
        TEXT + "[SHAPE]\n{radial width}\n 1.0 0.0\n 1.0 0.4\n",
        TEXT.replace("[MDI_HEADER]", "(COMMENTS)\n{comment_string}\n'free text = here'\n[MDI_HEADER]"),
        TEXT + "[FOREIGN]\nSOME_KEY = 3\n",
    ],
    ids=[
        "crlf",
        "cr",
        "bom",
        "utf16",
        "utf16-be",
        "latin1",
        "fortran",
        "tight",
        "quotes",
        "lowercase",
        "shape",
        "comments",
        "foreign",
    ],
)
def test_the_usual_variants_of_files_read_alike(tmp_path, tyre, mangled):
    assert read_text(tmp_path, mangled) == tyre


def split(text):
    """Key and value on two lines each, as listings on pages of programs have them, with the sign on either line."""
    text = re.sub(r"(?m)^([A-Z]\w*) *(= *\S.*)$", r"\1\n      \2", text)
    return re.sub(r"(?m)^(PDY1|FNOMIN|LONGVL)\n *= *", r"\1 =\n  ", text)


def test_values_on_the_line_below_their_keys_are_read(tmp_path, tyre):
    found = read_text(tmp_path, split(TEXT))
    assert found == tyre
    (problem,) = (p for p in found.problems if "below their keys" in p.sentence)
    assert problem.line is not None
    assert encoded(found.document.text, found.document.encoding) == split(TEXT).encode()
    changed = found.replace(PDY1=1.375)
    assert changed.text() == split(TEXT).replace("PDY1 =\n  1.27", "PDY1 =\n  1.375")
    assert read_text(tmp_path, changed.text()) == tyre.replace(PDY1=1.375)


def test_a_number_below_another_line_is_no_value(tmp_path):
    with pytest.raises(tir.TirError, match="PKY1 has no value"):
        read_text(tmp_path, re.sub(r"(?m)^PKY1 .*$", "PKY1 =\n[MORE]\n3", TEXT))
    with pytest.raises(tir.TirError, match="lacks FNOMIN"):
        read_text(tmp_path, re.sub(r"(?m)^FNOMIN .*$", "FNOMIN of the tyre\n= 1500", TEXT))


@pytest.mark.parametrize("mark", ["utf-16", "utf-8-sig"])
def test_a_file_with_a_byte_order_mark_is_written_with_it(tmp_path, mark):
    raw = TEXT.encode(mark)
    path = tmp_path / "again.tir"
    read_text(tmp_path, raw).write(path)
    assert path.read_bytes() == raw


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"MATLAB 5.0 MAT-file, Platform: PCWIN64".ljust(128) + b"\0\1IM", ["MATLAB", "PCY1 = 1.3"]),
        (b"\x89HDF\r\n\x1a\n" + bytes(50), ["MATLAB 7.3", "from_values"]),
        (b"PK\x03\x04" + bytes(50), ["Excel", "PCY1 = 1.3"]),
        (b"\xd0\xcf\x11\xe0\xa1\xb1" + bytes(50), ["Excel"]),
        (b"name,value\nPCX1,1.6\nPCY1,1.3\n", ["line 3 names PCY1", "from_values"]),
        (b'{"UNLOADED_RADIUS": 0.3,\n "PKY1": -20}\n', ["line 2 names PKY1"]),
        (b"tyre.FNOMIN = 4000\ntyre.PCY1 = 1.3\n", ["line 2 names PCY1", "PCY1 = 1.3"]),
        (TEXT.replace("= 1.27\n", "= 1.27;\n").encode(), ["PDY1", "leave the semicolon out"]),
    ],
    ids=["mat", "mat73", "xlsx", "xls", "csv", "json", "matlab", "semicolon"],
)
def test_coefficients_in_another_form_are_refused_with_what_to_do(tmp_path, content, words):
    with pytest.raises(tir.TirError) as caught:
        read_text(tmp_path, content)
    assert all(word in str(caught.value) for word in words), caught.value


def test_unknown_keys_are_kept_and_named(tmp_path):
    found = read_text(tmp_path, TEXT + "[FOREIGN]\nSOME_KEY = 3\n")
    assert found.extra["FOREIGN.SOME_KEY"] == "3"
    assert any("FOREIGN.SOME_KEY" in problem.sentence for problem in found.problems)


@pytest.mark.parametrize(("version", "missed"), [(61, False), (62, True)])
def test_only_a_file_of_mf62_misses_its_keys(tmp_path, version, missed):
    text = re.sub(r"(?m)^Q_CAM1 .*$", "", TEXT).replace("QSY8", "!QSY8")
    text = re.sub(r"(?m)^FITTYP .*$", f"FITTYP = {version}", text)
    (sentence,) = [p.sentence for p in read_text(tmp_path, text).problems if "missing" in p.sentence]
    assert "QSY8" in sentence
    assert ("Q_CAM1" in sentence) is missed


def test_a_car_file_needs_no_keys_of_motorcycles_or_of_single_programs(tmp_path):
    """Car files of 6.2 as they are published: no USE_MODE, no contour of a motorcycle tyre, solver's words in [MODEL]."""
    text = re.sub(r"(?m)^(USE_MODE|MC_CONTOUR_[AB]) .*\n", "", TEXT)
    text = text.replace("[MODEL]", "[MODEL]\nFUNCTION_NAME = 'TNO_X::TYR815'\nSWITCH_INTEG = 1")
    assert not read_text(tmp_path, text).on_reading


def test_a_key_without_a_value_is_reported_once(tmp_path):
    text = re.sub(r"(?m)^ROAD_INCREMENT .*$", "ROAD_INCREMENT = ", TEXT)
    assert [p.name for p in read_text(tmp_path, text).on_reading] == ["ROAD_INCREMENT"]


def test_a_file_of_mf60_gets_one_warning(tmp_path):
    text = re.sub(r"(?m)^FITTYP .*$", "FITTYP = 60", TEXT)
    text = re.sub(r"(?m)^(INFLPRES|NOMPRES) .*\n", "", text)
    (problem,) = read_text(tmp_path, text).on_reading
    assert re.search(r"60.*2 keys of MF 6\.1", problem.sentence)


@pytest.mark.parametrize(("shape", "told"), [(1.005, False), (1.05, True)])
def test_a_side_force_reversed_by_less_than_a_rig_can_see_is_accepted(tyre, shape, told):
    """The weight cos(C atan(B kappa)) tends to cos(C pi / 2): -0.8 % for C = 1.005, -7.8 % for 1.05."""
    steep = tyre.replace(RBY1=1e4, RBY2=0.0, RCY1=shape, REY1=0.0, REY2=0.0, RHY1=0.0, RHY2=0.0)
    assert any("reverses the side force" in p.sentence for p in check(steep)) is told


def test_mass_of_units_and_mass_of_inertia_are_two_things(tyre):
    assert tyre["MASS"] == 4.4


def test_units_other_than_si_are_converted(tmp_path, tyre):
    text = TEXT.replace("'meter'", "'mm'").replace("'newton'", "'kN'").replace("'radians'", "'deg'")
    text = re.sub(r"(?m)^UNLOADED_RADIUS( +)= .*$", r"UNLOADED_RADIUS\1= 299.8", text)
    text = re.sub(r"(?m)^FNOMIN( +)= .*$", r"FNOMIN\1= 1.5", text)
    text = re.sub(r"(?m)^ALPMAX( +)= .*$", r"ALPMAX\1= 20.0", text)
    text = re.sub(r"(?m)^NOMPRES( +)= .*$", r"NOMPRES\1= 2.5e-4", text)
    found = read_text(tmp_path, text)
    assert found["UNLOADED_RADIUS"] == pytest.approx(0.2998)
    assert found["FNOMIN"] == pytest.approx(1500.0)
    assert found["ALPMAX"] == pytest.approx(0.349, abs=1e-3)
    assert found["NOMPRES"] == pytest.approx(250e3)
    assert found["PKY1"] == tyre["PKY1"]
    assert any("FORCE is in kN;" in p.sentence for p in found.problems)


@pytest.mark.parametrize(
    ("mangled", "words"),
    [
        (b"", ["empty"]),
        (TEXT.encode("utf-16-le"), ["UTF-16"]),
        ("nothing of the kind\n", ["not a property file"]),
        (TEXT.replace("FITTYP                   = 62", "FITTYP = 6"), ["5.2", "fit"]),
        (TEXT.replace("= 62", "= 21").replace("'USER'", "'MF_05'"), ["5.2"]),
        (TEXT.replace("PDY1                     = 1.27", "PDY1 = 1,27"), ["PDY1", "1.27", ":"]),
        (TEXT.replace("PDY1                     = 1.27", "PDY1 ="), ["PDY1", "truncated"]),
        (TEXT.replace("PDY1                     = 1.27", "PDY1 = nan"), ["PDY1"]),
        (TEXT.rstrip().removesuffix("0.88"), ["QDRP1", "truncated"]),
        (TEXT.replace("UNLOADED_RADIUS", "!UNLOADED_RADIUS"), ["UNLOADED_RADIUS to [DIMENSION]"]),
        (TEXT.replace("FITTYP                   = 62", "FITTYP = 52"), ["MF-MCTyre", "motorcycle"]),
        (TEXT.replace("FITTYP                   = 62", "FITTYP = 21"), ["MF-Tyre 5.2"]),
        (TEXT[: TEXT.index("[LATERAL")], ["PCY1", "truncated"]),
        (TEXT[: TEXT.index("[VERTICAL]")], ["FNOMIN"]),
        (TEXT.replace("'meter'", "'cubit'"), ["cubit", "meter"]),
        (
            TEXT.replace("PDY1                     = 1.27", "PDY1 = 1_27"),
            ["PDY1", "1_27", "a number was expected"],
        ),
        (
            TEXT.replace("PDY1                     = 1.27", "PDY1 = \u0661.27").encode(),
            ["PDY1", "a number was expected"],
        ),
        (TEXT.replace("PDY1                     = 1.27", "PDY1 = 0x10"), ["PDY1", "a number was expected"]),
        (TEXT.replace("FITTYP                   = 62", "FITTYP = 63"), ["63", "only 60, 61 and 62"]),
        (
            TEXT[: TEXT.index("1.27\n") + 3],
            [f":{TEXT[: TEXT.index('1.27')].count(chr(10)) + 1}:", "PDY1 = 1.2", "truncated"],
        ),
    ],
    ids=[
        "empty",
        "utf16",
        "prose",
        "old",
        "mf05",
        "comma",
        "novalue",
        "nan",
        "last",
        "radius",
        "52",
        "21",
        "truncated",
        "shorter",
        "unit",
        "underscore",
        "arabic",
        "hexadecimal",
        "63",
        "cut",
    ],
)
def test_an_unusable_file_is_refused_with_the_place_and_the_remedy(tmp_path, mangled, words):
    with pytest.raises(tir.TirError) as caught:
        read_text(tmp_path, mangled)
    text = str(caught.value)
    assert "t.tir" in text
    assert all(word in text for word in words), text
    assert "\n" not in text


@pytest.mark.parametrize("turn_slip", [True, False])
def test_a_whole_file_may_lack_its_last_line_end(tmp_path, tyre, turn_slip):
    whole = TEXT if turn_slip else TEXT[: TEXT.index("[TURNSLIP")]
    whole = whole.rstrip("\r\n$-")
    assert whole[-1].isdigit()
    assert read_text(tmp_path, whole) == read_text(tmp_path, whole + "\n")


def test_a_file_that_ends_behind_a_whole_number_is_read(tmp_path):
    """Short on purpose, or cut: what was read of it is right."""
    end = TEXT.index("1.27\n") + 4
    for finish in ("\n", " ", " $ friction"):
        assert read_text(tmp_path, TEXT[:end] + finish)["PDY1"] == 1.27


def test_a_file_cut_within_a_number_of_the_lateral_coefficients_is_refused(tmp_path):
    section = TEXT[TEXT.index("[LATERAL") : TEXT.index("[ROLLING")]
    for line in re.findall(r"\w+ += [-\d.]+", section):
        with pytest.raises(tir.TirError, match=line.split()[0]):
            read_text(tmp_path, TEXT[: TEXT.index(line) + len(line) - 1])


def test_a_file_that_may_be_truncated_before_the_turn_slip_gets_a_warning(tmp_path):
    whole = TEXT[: TEXT.index("[TURNSLIP")].rstrip("\r\n$-")
    for text, told in ((whole, True), (whole + "\n", False)):
        assert any(p.name == "SSZ4" for p in read_text(tmp_path, text).problems) is told


def test_a_measured_quantity_that_is_not_a_number_is_a_comment(tmp_path, tyre):
    found = read_text(tmp_path, "! measured: epsilon_gamma about u 0.1 -\n! measured: C 2 u 0.1 Nm\n" + TEXT)
    assert found == tyre
    assert found.measured == {"C": tir.Quantity(2.0, 0.1, "Nm")}


def test_a_quantity_says_whether_it_was_measured_or_fitted_and_keeps_it_when_written(tmp_path):
    found = read_text(tmp_path, "! measured: C 2 u 0.1 Nm\n! fitted: K 3 u 0.2 N/rad\n" + TEXT)
    assert {name: q.origin for name, q in found.measured.items()} == {"C": "measured", "K": "fitted"}
    found.write(tmp_path / "again.tir", target="mftyre")
    assert tir.read(tmp_path / "again.tir").measured == found.measured


def test_what_no_force_needs_may_be_blank_or_text(tmp_path, tyre):
    """As widely used programs write it; the file is used, and the list of problems says what was not."""
    text = re.sub(r"(?m)^ROAD_INCREMENT .*$", "ROAD_INCREMENT =   $ not known", TEXT)
    text = re.sub(r"(?m)^MASS  .*4.4$", "MASS = kg", text)
    text = re.sub(r"(?m)^QSY8 .*$", "QSY8 = ", text)
    found = read_text(tmp_path, text)
    assert found["MASS"] == pytest.approx(8.0 * 1500.0 / 4000.0)  # the default of 4000 N, at this load
    assert found["QSY8"] == 0.0
    assert not {"MASS", "ROAD_INCREMENT", "QSY8"} & found.present
    (text_found,) = [p for p in found.problems if p.name == "MASS"]
    assert f"line {text_found.line}: MASS" in text_found.sentence
    (empty,) = [p for p in found.problems if "no value" in p.sentence]
    assert "2 keys have no value" in empty.sentence
    assert "ROAD_INCREMENT" in empty.sentence
    assert "QSY8" in empty.sentence
    assert text.splitlines()[text_found.line - 1].startswith("MASS")


def test_a_pressure_unit_is_honoured(tmp_path, tyre):
    text = TEXT.replace("[UNITS]\n", "[UNITS]\nPRESSURE = 'kpascal'\n")
    text = re.sub(r"(?m)^(NOMPRES|INFLPRES)( +)= .*$", r"\1\2= 250", text)
    assert read_text(tmp_path, text)["NOMPRES"] == 250e3
    text = text.replace("kpascal", "bar").replace("= 250\n", "= 2.5\n")
    assert read_text(tmp_path, text)["INFLPRES"] == 250e3


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="named pipes are a matter of Unix")
def test_a_pipe_is_read_if_a_program_writes_into_it(tmp_path):
    path = tmp_path / "pipe"
    os.mkfifo(path)
    with pytest.raises(tir.TirError, match="no program writes"):
        tir.read(path)
    writer = os.open(path, os.O_RDWR)
    late = threading.Timer(0.05, lambda: (os.write(writer, TEXT.encode()), os.close(writer)))
    late.start()
    assert tir.read(path)["PKY1"] == tir.read(VECTORS / "moto_front.tir")["PKY1"]
    late.join()


def test_a_missing_file_is_a_sentence(tmp_path):
    with pytest.raises(tir.TirError, match="cannot be read"):
        tir.read(tmp_path / "none.tir")


@given(st.dictionaries(st.sampled_from(NUMBERS), st.floats(-1e9, 1e9, allow_nan=False), max_size=20))
def test_written_values_come_back_bit_for_bit(values):
    tyre = tir.Tyre.from_values({"UNLOADED_RADIUS": 0.3, "FNOMIN": 1500.0, **values})
    from tir.document import parse_document
    from tir.tyre import interpret

    again = interpret(parse_document(tyre.text()))
    assert dict(again.values) == dict(tyre.values)


def test_status_measured_and_provenance_come_back(tmp_path, tyre):
    noted = tyre.annotate(
        status={"PKY1": "fitted +- 0.12"},
        measured={
            "epsilon_gamma": tir.Quantity(-0.0617, 0.084, "-"),
            "C_phit_Nm": tir.Quantity(501.25, 40.1, "Nm"),
        },
        provenance={"program": "mffit 0.1.0", "input a.csv": "0123456789abcdef"},
    )
    noted.write(tmp_path / "n.tir")
    again = tir.read(tmp_path / "n.tir")
    assert again == noted
    assert again.status["PKY1"] == "fitted +- 0.12"
    assert again.measured == noted.measured
    assert again.provenance == noted.provenance


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_a_value_that_is_not_finite_is_never_written(tmp_path, tyre, value):
    target = tmp_path / "t.tir"
    target.write_text("before")
    with pytest.raises(tir.TirError, match="PKY1"):
        tyre.replace(PKY1=value).write(target)
    assert target.read_text() == "before"
    assert [path.name for path in tmp_path.iterdir()] == ["t.tir"]


def test_a_name_that_mf62_does_not_have_is_refused(tyre):
    with pytest.raises(tir.TirError, match="PKY99"):
        tyre.replace(PKY99=1.0)


@pytest.mark.parametrize("value", [None, "text", [1.0], {"a": 1}, Decimal("1.5"), Path("a")])
def test_a_value_of_the_wrong_kind_is_refused_by_its_name(tyre, value):
    for make in (tyre.replace, lambda **given: tir.Tyre.from_values(given)):
        with pytest.raises(tir.TirError, match=r"PKY1 is .*a number was expected"):
            make(PKY1=value)
    with pytest.raises(tir.TirError, match="TYRESIDE is 3, but a text"):
        tyre.replace(TYRESIDE=3)


def test_numbers_of_every_kind_are_values(tyre):
    for value in (
        -12,
        -12.5 + 1e-3j,
        np.float32(-12.0),
        np.int64(-12),
        np.array([-12.0, -13.0]),
        Fraction(-25, 2),
    ):
        assert np.all(tyre.replace(PKY1=value)["PKY1"] == value)


def test_a_version_that_is_not_computed_is_not_shown_as_one_that_is(tyre):
    old = tir.Tyre.from_values({"FITTYP": 52})
    assert "FITTYP 52" in repr(old)
    assert any(p.level == "error" and "only 60, 61 and 62" in p.sentence for p in check(old))
    assert "MF 6.1" in repr(tyre.replace(FITTYP=61))


def test_equal_tyres_have_equal_hashes(tyre):
    whole, point, numpy_s = (tyre.replace(FNOMIN=x) for x in (1500, 1500.0, np.float64(1500.0)))
    assert whole == point == numpy_s
    assert hash(whole) == hash(point) == hash(numpy_s)
    assert len({whole, point, numpy_s, tyre.replace(FNOMIN=1501.0)}) == 2
    hash(tyre.replace(PKY1=np.array([-12.0, -13.0])))


def test_a_tyre_is_a_mapping_of_its_parameters(tyre):
    assert "PKY1" in tyre
    assert "PKY99" not in tyre
    assert 0 not in tyre
    assert list(tyre) == list(tyre.keys())
    assert dict(tyre) == dict(tyre.values)
    assert {row.name for row in TABLE} == set(tyre)


@pytest.mark.parametrize("text", ["O'Neil front", "'quoted'", 'size 4.50" front', "left"])
def test_text_with_quotes_comes_back(tmp_path, tyre, text):
    tyre.replace(TYRESIDE=text).write(tmp_path / "merged.tir")
    tyre.replace(TYRESIDE=text).write(tmp_path / "new.tir", target="mftyre")
    for name in ("merged.tir", "new.tir"):
        again = tir.read(tmp_path / name)
        assert again["TYRESIDE"] == text
        assert again["LONGVL"] == tyre["LONGVL"]


def test_text_with_both_quotes_damages_nothing_else(tmp_path, tyre):
    tyre.replace(TYRESIDE="""5" 'x'""").write(tmp_path / "t.tir")
    assert tir.read(tmp_path / "t.tir").replace(TYRESIDE="LEFT") == tyre


class TestOtherReaders:
    """What every reader can rely on; their habits one by one are in test_targets.py."""

    @pytest.fixture
    def text(self, tyre) -> str:
        noted = tyre.annotate(provenance={"note": "a = b; c! d"}, status={"PKY1": "fitted = 1; !"})
        return noted.text("mftyre")

    def test_plain_ascii_crlf_and_short_lines(self, text):
        assert text.isascii()
        lines = text.split("\r\n")
        assert "\n" not in "".join(lines)
        assert "\t" not in text
        assert max(map(len, lines)) < 120

    def test_a_dollar_comment_needs_a_blank_before_it(self, text):
        assert not re.search(r"[^ \n]\$(?!-)", "\n".join(x for x in text.splitlines() if x[:1] not in "!$"))

    def test_no_comment_line_between_the_keys_of_a_section(self, text):
        body = text.split("[UNITS]")[1]
        keys = [line for line in body.splitlines() if line and not line.startswith(("[", "$---"))]
        assert all("=" in line for line in keys)


TURN_SLIP_DEFAULTS = {
    row.name: row.default for row in TABLE if row.section == "TURNSLIP_COEFFICIENTS" and row.files == ""
}


class TestCheck:
    @pytest.mark.parametrize("name", ["MagicFormula61", "MagicFormula62", "moto_front"])
    def test_sound_tyres_have_no_error(self, name):
        assert not [p for p in check(tir.read(VECTORS / f"{name}.tir")) if p.level == "error"]

    @pytest.mark.parametrize(
        ("change", "level", "words"),
        [
            ({"UNLOADED_RADIUS": 299.8}, "error", "millimetres"),
            ({"FNOMIN": -1500.0}, "error", "positive"),
            ({"PKY1": 12.6}, "error", "cornering stiffness"),
            ({"PKY6": 1.2}, "warning", "camber"),
            ({"PDY1": -1.0}, "warning", "friction"),
            ({"PDY2": -3.0}, "error", "friction"),
            ({"PEY1": 3.0, "PEY2": 0.0}, "warning", "E_y"),
            ({"PECP1": 1.0}, "warning", "eps_gamma"),
            ({"PECP1": 0.5, "PECP2": 0.0, "MC_CONTOUR_A": 0.1}, "warning", "common default 0.5"),
            ({"PECP1": 0.93, "PECP2": 0.0}, "warning", "eps_gamma comes close to 1"),
            (TURN_SLIP_DEFAULTS, "warning", "common defaults"),
            ({"USE_MODE": 225.0}, "warning", "licence"),
            ({"USE_MODE": 124.0, "MC_CONTOUR_A": 0.1}, "warning", "motorcycle"),
            ({"USE_MODE": 200.0, "MC_CONTOUR_A": 0.0}, "warning", "is not a motorcycle tyre"),
            ({"FITTYP": 61.0, "Q_CAM1": 0.4}, "warning", "Q_CAM1"),
            ({"QSX4": 0.1, "QSX12": 0.1}, "warning", "same effect"),
            ({"INFLPRES": 900e3, "PRESMAX": 400e3}, "warning", "PRESMAX"),
            ({"ALPMIN": -0.03, "ALPMAX": 0.03}, "warning", "of its peak"),
            ({"FZMAX": 1600.0}, "warning", "limit the load"),
            ({"FZMIN": 900.0}, "warning", "reduces forces"),
            ({"PKY3": 1.2, "CAMMAX": 0.8, "CAMMIN": -0.8}, "warning", "just outside"),
            ({"RBY1": 30.0, "RCY1": 2.5, "REY1": 0.0}, "warning", "G_yk"),
            ({"CAMMAX": 50.0}, "error", "degrees"),
            ({"FZMIN": 5000.0}, "error", "FZMIN"),
            ({"QDZ1": -0.1}, "warning", "align"),
            ({"TYRESIDE": "SYMMETRIC"}, "warning", "odd terms"),
            ({"LMUY": 0.8}, "warning", "LMUY"),
            ({"LFZO": 0.0}, "error", "LFZO"),
            ({"LONGVL": 0.0}, "error", "LONGVL"),
            ({"TYRESIDE": "SYMMETRIC", "QSX1": 0.01}, "warning", "QSX1"),
            ({"NOMPRES": 250.0, "INFLPRES": 250.0}, "warning", "kPa"),
            ({"NOMPRES": 1.8e9}, "warning", "write Pa"),
            ({"ALPMIN": -30.0}, "error", "ALPMIN is -30 rad: it looks like degrees"),
            ({"CAMMIN": -60.0}, "error", "CAMMIN is -60 rad: it looks like degrees"),
            ({"LATERAL_STIFFNESS": 0.0}, "warning", "relaxation"),
            ({"LONGITUDINAL_STIFFNESS": -3e5}, "warning", "relaxation"),
            ({"PCX1": 0.0}, "error", "PCX1"),
            ({"PKY2": 0.0}, "error", "PKY2 is 0: the load is divided by it"),
            ({"LCY": -1.0}, "error", "LCY"),
            ({"QBZ1": -1.0}, "error", "QBZ1"),
            ({"MASS": -4.4}, "error", "MASS is -4.4 kg"),
            ({"BELT_IYY": -0.2}, "error", "BELT_IYY is -0.2 kg m2"),
            ({"WIDTH": 120.0}, "warning", "millimetres"),
            ({"RIM_WIDTH": 7.0}, "warning", "inches"),
            ({"USE_MODE": 999.0}, "warning", "unknown digit"),
            ({"USE_MODE": 4.5}, "warning", "whole"),
            ({"TYRESIDE": "UP"}, "warning", "TYRESIDE is 'UP'"),
            ({"VERTICAL_STIFFNESS": 150.0}, "error", "N/mm"),
        ],
    )
    def test_a_planted_fault_is_named(self, tyre, change, level, words):
        found = check(tyre.replace(**change))
        assert any(p.level == level and words in p.sentence for p in found), [p.sentence for p in found]

    def test_one_program_may_be_named_alone(self, tyre):
        assert check(tyre, "chrono") == check(tyre, ["chrono"]) != check(tyre)

    def test_a_stiffness_in_other_units_is_not_reported_as_a_wrong_radius(self, tyre):
        assert not [p for p in check(tyre.replace(VERTICAL_STIFFNESS=150.0)) if p.name == "BREFF"]

    def test_a_force_that_was_not_measured_is_not_judged(self, tyre):
        """Files of cornering tests alone hold zeros for Fx."""
        assert not [p for p in check(tyre.replace(PDX1=0.0, PCX1=0.0)) if p.name == "PCX1"]

    @pytest.mark.parametrize(
        "harmless",
        [
            {"GRAVITY": -9.81},
            {"WIDTH": 0.9, "RIM_WIDTH": 0.8, "FNOMIN": 4e4, "VERTICAL_STIFFNESS": 1e6},
            {"NOMPRES": 1.5e6, "INFLPRES": 1.5e6},
            {"TYRESIDE": "Right"},
            {"USE_MODE": -14.0},
        ],
        ids=["gravity", "lorry", "aircraft", "lower case", "the other side"],
    )
    def test_values_of_real_tyres_are_accepted(self, tyre, harmless):
        sentences = " ".join(p.sentence for p in check(tyre.replace(**harmless)))
        assert not re.search("looks like|write|must|unknown|GRAVITY", sentences), sentences

    def test_a_file_of_mf61_gets_no_warning_about_keys_of_62(self, tmp_path):
        found = read_text(tmp_path, (VECTORS / "MagicFormula61.tir").read_text(encoding="ascii"))
        assert not [p for p in check(found, ["mf61"]) if p.level == "error"]
        assert found.on_reading == ()

    def test_a_file_without_the_keys_of_adams_lacks_nothing(self, tmp_path, tyre):
        assert read_text(tmp_path, tyre.text("mftyre")).on_reading == ()

    def test_a_template_of_zeros_is_judged_without_a_warning_of_numpy(self):
        zeros = {row.name: 0.0 for row in TABLE if row.section.endswith("COEFFICIENTS") and not row.scaling}
        assert any(p.level == "error" for p in check(tir.Tyre.from_values(zeros)))

    def test_every_problem_of_a_key_has_its_line(self, tmp_path, tyre):
        text = TEXT.replace("PECP1                    =", "PECP1                    = 0.999 $")
        (found,) = [p for p in check(read_text(tmp_path, text)) if p.name == "PECP1"]
        assert TEXT.splitlines()[found.line - 1].startswith("PECP1")
        assert found.sentence.startswith(f"line {found.line}: ")

    def test_renamed_keys_of_mf52_are_seen(self, tmp_path):
        text = TEXT + "[RELAXATION]\nPTX1 = 2\nQTZ1 = 0.1\n"
        (one,) = (p for p in check(read_text(tmp_path, text)) if "PTX1, QTZ1 are keys" in p.sentence)
        assert (one.name, one.line) == ("PTX1", text.splitlines().index("PTX1 = 2") + 1)


def test_the_worst_point_is_found_between_the_points_of_a_coarse_grid(tyre):
    """A dip that the corners and the middle of the ranges do not show."""
    from tir.envelope import worst

    box = np.array([[300.0, -0.8, 2e5, -0.3, -0.5], [3000.0, 0.8, 3e5, 0.3, 0.5]])
    margin, place = worst(tyre, lambda p, q: (q.gamma - 0.317) ** 2 + ((q.Fz - 1234.0) / 1e4) ** 2, box)
    assert margin < 1e-5
    assert place[:2] == pytest.approx([1234.0, 0.317], abs=30.0)


def test_a_condition_names_only_inputs_that_it_depends_on(tyre):
    from tir.envelope import CONDITIONS, _measured

    point = np.array([[2000.0], [0.0], [2.3e5], [0.1], [0.1]])
    leaning, slipping = point.copy(), point.copy()
    leaning[1], slipping[3:] = 0.3, 0.02
    for condition in CONDITIONS:
        here, there, elsewhere = (_measured(tyre, condition.measure, p) for p in (point, leaning, slipping))
        assert condition.camber or np.all(here == there), condition.sentence
        assert condition.slips or np.all(here == elsewhere), condition.sentence
    (sentence,) = [p.sentence for p in check(tyre.replace(PKY1=12.6)) if "at zero camber" in p.sentence]
    assert "deg camber" not in sentence


def test_values_of_missing_keys_can_be_given_on_reading(tmp_path):
    path = tmp_path / "student.tir"
    path.write_text(re.sub(r"(?m)^UNLOADED_RADIUS .*\n", "", TEXT))
    with pytest.raises(tir.TirError, match=r"lacks UNLOADED_RADIUS.* tir.read\(path, UNLOADED_RADIUS"):
        tir.read(path)
    tyre = tir.read(path, UNLOADED_RADIUS=0.2998)
    assert tyre == tir.read(VECTORS / "moto_front.tir")
    assert tyre.status["UNLOADED_RADIUS"].startswith("given")
    tyre.write(path)
    assert tir.read(path)["UNLOADED_RADIUS"] == 0.2998
    with pytest.raises(tir.TirError, match="the given UNLOADED_RADIUS is nan"):
        tir.read(path, UNLOADED_RADIUS=math.nan)
    other = tir.read(path, UNLOADED_RADIUS=0.4)
    assert other["UNLOADED_RADIUS"] == 0.2998
    assert any("the given 0.4 is not used" in problem.sentence for problem in other.problems)
    with pytest.raises(tir.TirError, match="no parameter RADIUS"):
        tir.read(path, RADIUS=0.3)


def test_a_tyre_does_not_change_and_says_what_to_do_instead(tyre):
    before = tyre(1400.0, 0.05)
    with pytest.raises(AttributeError, match=r"tyre\.replace\(PKY1=-5\)"):
        tyre.PKY1 = -5
    with pytest.raises(TypeError, match=r"tyre\.replace\(PKY1=-5\)"):
        tyre["PKY1"] = -5
    with pytest.raises(AttributeError, match=r"tyre\.replace\(\.\.\.\)"):
        tyre.values = {}
    with pytest.raises(AttributeError, match="replace"):
        del tyre.values
    with pytest.raises(TypeError, match="replace"):
        del tyre["PKY1"]
    with pytest.raises(AttributeError, match=r"tyre\['PKY1'\]"):
        tyre.PKY1  # noqa: B018
    assert tyre(1400.0, 0.05) == before
    assert tyre.replace(PKY1=-5.0)(1400.0, 0.05) != before
