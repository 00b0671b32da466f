"""Property files as other tools leave them: each kind is read as it is meant, or refused with what to do."""

from __future__ import annotations

import pytest

import tir
from tir.checking import check

BODY = """[DIMENSION]
UNLOADED_RADIUS = 0.31
[VERTICAL]
FNOMIN = 4000
[LATERAL_COEFFICIENTS]
PCY1 = 1.4
PDY1 = 1.1
PKY1 = -22
PKY2 = 1.7
"""


def read(tmp_path, text):
    path = tmp_path / "t.tir"
    path.write_text(text, encoding="ascii")
    return tir.read(path)


def test_keys_that_a_program_left_empty_are_said_in_one_sentence_forces_first(tmp_path):
    """A fitting tool writes every key of its template, also those that it has no value for."""
    empty = "[OPERATING_CONDITIONS]\nINFLPRES =\nNOMPRES = 97000\n[INERTIA]\nMASS =\n"
    found = read(tmp_path, f"[MODEL]\nFITTYP = 61\nROAD_INCREMENT =   $ none\n{empty}{BODY}")
    (problem,) = (p for p in found.problems if "no value" in p.sentence)
    assert "3 keys have no value, defaults are taken: INFLPRES = 97000 Pa, " in problem.sentence
    assert problem.name == "INFLPRES"
    assert found["INFLPRES"] == 97e3


@pytest.mark.parametrize(
    ("section", "written", "meant"),
    [
        ("SCALING_COEFFICIENTS", "LFZ0 = 0.8", "LFZO"),
        ("OPERATING_CONDITIONS", "NORMPRES = 90000", "NOMPRES"),
        ("DIMENSION", "RIMRADIUS = 0.2", "RIM_RADIUS"),
        ("LATERAL_COEFFICIENTS", "P_EY1 = -0.5", "PEY1"),
    ],
)
def test_a_misspelt_key_is_named_with_the_one_that_is_meant(tmp_path, section, written, meant):
    found = read(tmp_path, f"[MODEL]\nFITTYP = 61\n{BODY}[{section}]\n{written}\n")
    assert any(f"(is {meant} meant?)" in p.sentence for p in found.problems)


def test_a_key_of_another_generation_is_no_misspelling(tmp_path):
    """QPZ1 and LGAX are like PPZ1 and LCX, but are what they are."""
    found = read(tmp_path, f"[MODEL]\nFITTYP = 61\n{BODY}[MORE]\nQPZ1 = 0.1\nLGAX = 1\nPDY4 = 2\nPLANT = 3\n")
    assert not any("meant" in p.sentence for p in found.problems)


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ("= 0.31", "= 0.31 m", "only a comment may follow the number"),
        ("= 4000", "= 4000 [N]", "only a comment may follow the number"),
        ("= 1.4", "= 1.4 % shape", r"begins with \$ or !"),
        ("= 1.4", "= 1.4 // shape", r"begins with \$ or !"),
        ("= 61", "= 'MF61'", "FITTYP .* such as 61"),
        ("PCY1 = 1.4\nPDY1 = 1.1\nPKY1", "p_Cy1 = 1.4\np_Dy1 = 1.1\np_Ky1", "names p_Cy1 in another form"),
        (" = ", " : ", "names PCY1 in another form"),
        (" = ", "  ", "names PCY1 in another form"),
    ],
    ids=["unit", "bracket", "percent", "slashes", "words", "underscores", "colons", "blanks"],
)
def test_what_cannot_be_read_is_refused_with_the_remedy(tmp_path, before, after, said):
    with pytest.raises(tir.TirError, match=said):
        read(tmp_path, f"[MODEL]\nFITTYP = 61\n{BODY}".replace(before, after))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("\n<!DOCTYPE html>\n<html lang='en'>PCY1 = 1.3</html>\n", "web page about the file"),
        ("version https://git-lfs.github.com/spec/v1\noid sha256:12\nsize 9\n", "git lfs pull"),
    ],
)
def test_what_stands_in_for_the_file_is_named(tmp_path, text, said):
    with pytest.raises(tir.TirError, match=said):
        read(tmp_path, text)


def test_units_in_the_plural_are_the_same_units(tmp_path):
    text = f"[UNITS]\nLENGTH = 'Millimeters'\nFORCE = 'newtons'\n[MODEL]\nFITTYP = 61\n{BODY.replace('0.31', '310')}"
    found = read(tmp_path, text)
    assert found["UNLOADED_RADIUS"] == pytest.approx(0.31)
    assert any("LENGTH in 'Millimeters' is ignored" in p.sentence for p in check(found, ["mfeval"]))
    with pytest.raises(tir.TirError, match="unknown unit"):
        read(tmp_path, text.replace("newtons", "newtonss"))


def in_units(text: str, **words: str) -> str:
    units = "".join(f"{kind} = '{word}'\n" for kind, word in words.items())
    return f"[UNITS]\n{units}FORCE = 'newton'\n[MODEL]\nFITTYP = 61\n{text}"


PRESSURES_AND_RANGES = (
    BODY + "\nNOMPRES = 250000\nINFLPRES = 220000\nALPMIN = -0.3\nALPMAX = 0.3\nCAMMIN = -0.9\nCAMMAX = 0.9\n"
)


@pytest.mark.parametrize("word", ["mm", "cm", "inch"])
def test_a_unit_of_length_that_radius_and_pressures_contradict_is_named_with_the_one_that_fits(
    tmp_path, word
):
    found = check(read(tmp_path, in_units(PRESSURES_AND_RANGES, LENGTH=word)))
    (error,) = [p for p in found if p.level == "error"]
    assert (error.name, error.line) == ("LENGTH", 2)
    assert (
        "write 'meter', by which UNLOADED_RADIUS is 0.31 m, NOMPRES is 2.5e+05 Pa and INFLPRES is 2.2e+05 Pa"
        in str(error)
    )
    assert not [p for p in found if p.name in ("NOMPRES", "INFLPRES", "UNLOADED_RADIUS")]


def test_a_unit_of_length_that_fits_is_believed(tmp_path):
    text = PRESSURES_AND_RANGES.replace("0.31", "310").replace("250000", "0.25").replace("220000", "0.22")
    found = check(read(tmp_path, in_units(text, LENGTH="mm")))
    assert not [p for p in found if p.level == "error" or "contradicts" in p.sentence]


def test_degrees_that_the_ranges_contradict_are_named(tmp_path):
    found = check(read(tmp_path, in_units(PRESSURES_AND_RANGES, LENGTH="meter", ANGLE="deg")))
    (about,) = [p for p in found if p.name == "ANGLE" and "contradicts" in p.sentence]
    assert (about.level, about.line) == ("warning", 3)
    assert (
        "ALPMAX 0.3 deg, CAMMIN -0.9 deg and CAMMAX 0.9 deg: they look like radians; write 'radians'"
        in about.sentence
    )
    in_degrees = PRESSURES_AND_RANGES.replace("0.3\n", "17\n").replace("0.9", "50")
    found = check(read(tmp_path, in_units(in_degrees, LENGTH="meter", ANGLE="deg")))
    assert not [p for p in found if p.name == "ANGLE" and "contradicts" in p.sentence]


def test_two_pressures_in_two_units_contradict_one_another(tmp_path):
    found = check(
        read(
            tmp_path,
            f"[MODEL]\nFITTYP = 61\n[OPERATING_CONDITIONS]\nNOMPRES = 220\nINFLPRES = 220000\n{BODY}",
        )
    )
    (sentence,) = (p.sentence for p in found if p.level == "error")
    assert "INFLPRES 220000 Pa is 1e+03 times NOMPRES 220 Pa" in sentence
    both = read(
        tmp_path, f"[MODEL]\nFITTYP = 61\n[OPERATING_CONDITIONS]\nNOMPRES = 120000\nINFLPRES = 300000\n{BODY}"
    )
    assert not [p for p in check(both) if p.level == "error"]


def test_a_car_file_under_the_number_of_motorcycles_says_how_to_convert_it(tmp_path):
    with pytest.raises(tir.TirError, match=r"FITTYP 52.*--fittyp 6"):
        read(tmp_path, f"[MODEL]\nTYPE = 'CAR'\nFITTYP = 52\n{BODY}PHY3 = 0.01\nPKY4 = 2\nPKY6 = 0\n")


def test_a_peak_of_the_other_sign_is_the_same_curve(tmp_path):
    """Files of other axes have a negative friction; the slope factor turns with it."""
    tyre, other = (
        read(tmp_path, f"[MODEL]\nFITTYP = 61\n{BODY.replace('1.1', peak)}") for peak in ("1.1", "-1.1")
    )
    assert other(3000.0, 0.08).Fy == pytest.approx(tyre(3000.0, 0.08).Fy, rel=1e-9)
    found = [(p.name, p.level) for p in check(other)]
    assert ("PDY1", "warning") in found
    assert ("PDY1", "error") not in found
