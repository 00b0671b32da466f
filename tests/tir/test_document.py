"""A file that is read and written again keeps every byte that nobody changed."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import tir
from tir.document import parse_document
from tir.parameters import BY_NAME, TABLE
from tir.tyre import interpret

VECTORS = Path(__file__).parent / "vectors"
TEXT = (VECTORS / "moto_front.tir").read_text(encoding="ascii")
WILD = (
    "$ a file as the wild has them, Größe 120 µm\n\n"
    + TEXT.replace("= 1.27\n", "=  +1.2700D+00!inline, no blank\n")
    .replace("[LATERAL", "$---- side force\n  [LATERAL")
    .replace("PKY1  ", "  pky1\t")
    .replace("'LEFT'", '"left"   $ side')
    .replace("[DIMENSION]\n", "[DIMENSION]\nHEIGHT_ÜBER = 'für'\n")
    + "\n[SHAPE]\n{radial width}\n 1.0 0.0\n 1.0 0.4\n[PARAMETER]\nUNKNOWN = 3  ! kept\nPKY1 = 99\n"
)


def written(tyre: tir.Tyre, tmp_path: Path) -> bytes:
    path = tmp_path / "written.tir"
    tyre.write(path)
    return path.read_bytes()


def read_bytes(tmp_path: Path, content: bytes) -> tir.Tyre:
    path = tmp_path / "t.tir"
    path.write_bytes(content)
    return tir.read(path)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "latin-1"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("last", ["", "\n\n"])
def test_every_byte_survives(tmp_path, encoding, end, last):
    content = (WILD.rstrip("\n") + last).replace("\n", end).encode(encoding)
    assert written(read_bytes(tmp_path, content), tmp_path) == content


@given(st.text(alphabet="AB_=[]$!'{} \t\r\n.12é", max_size=200))
def test_text_of_any_kind_survives(text):
    document = parse_document(text, encoding="utf-8")
    assert document.text == text
    for line in document.entries:
        assert line.text[line.start :].startswith(line.value)
        assert line.with_value(line.value) == line


@pytest.mark.parametrize(
    ("change", "old", "new"),
    [
        ({"PKY1": -13.5}, "-12.9", "-13.5"),
        ({"PDY1": 1.3}, "+1.2700D+00", "1.3"),
        ({"TYRESIDE": "RIGHT"}, '"left"', '"RIGHT"'),
        ({"FNOMIN": 1501.0}, "1500", "1501"),
    ],
)
def test_a_change_moves_the_characters_of_its_value_only(tmp_path, change, old, new):
    (name,) = change
    text = WILD.replace("\n", "\r\n")
    tyre = read_bytes(tmp_path, text.encode())
    lines = text.split("\r\n")
    place = next(i for i, x in enumerate(lines) if x.strip().upper().startswith(name))
    before = re.sub(r".*=\s*([^\s!$]+).*", r"\1", lines[place])
    lines[place] = lines[place].replace(before, new)
    assert written(tyre.replace(**change), tmp_path).decode() == "\r\n".join(lines)
    assert before == old or name in ("PKY1", "FNOMIN")


def test_setting_a_value_to_itself_changes_nothing(tmp_path):
    tyre = read_bytes(tmp_path, WILD.encode())
    assert written(tyre.replace(PDY1=1.27), tmp_path) == WILD.encode()


@pytest.mark.parametrize("target", [None, "mftyre", "mfeval"])
@pytest.mark.parametrize(
    "said",
    [
        "slopes at zero on the path of the measurement; " * 8,
        "0123456789abcdef" * 20,
        "a" * 100 + "  two blanks  " + "b" * 200,
        "short enough for one line",
    ],
)
def test_no_written_line_is_longer_than_readers_take(tmp_path, target, said):
    """The manuals of the programs allow 120 characters; what is longer comes back whole from several lines."""
    said = said.replace(";", ",").strip()
    given = {"note": said, "a path of some length/" + "folder/" * 20: "x", "last": "one"}
    measured = {"n" * 120: tir.Quantity(0.1, 0.02, "m")}
    tyre = read_bytes(tmp_path, TEXT.encode()).replace(PKY1=-12.345678901234567)
    tyre = tyre.annotate(provenance=given, measured=measured, status={"PKY1": "fitted " + "x" * 150})
    text = tyre.text(target)
    assert max(map(len, text.splitlines())) < 120
    back = read_bytes(tmp_path, text.encode())
    assert (dict(back.provenance), dict(back.measured)) == (given, measured)
    assert back["PKY1"] == -12.345678901234567
    assert back.text() == text
    other = back.annotate(provenance={"note": "new"})
    assert read_bytes(tmp_path, other.text().encode()).provenance == {**given, "note": "new"}
    assert said not in other.text().replace("\r", "").replace("\n!>", ""), "nothing of the old text stays"


def test_a_long_value_is_never_cut(tmp_path):
    """Only the comment behind it is."""
    side = "LEFT " + "of something " * 12
    tyre = (
        read_bytes(tmp_path, TEXT.encode())
        .replace(TYRESIDE=side.strip())
        .annotate(status={"TYRESIDE": "given"})
    )
    for target in (None, "mftyre"):
        assert read_bytes(tmp_path, tyre.text(target).encode())["TYRESIDE"] == side.strip()


def test_defaults_are_not_written_into_a_file_that_lacks_them(tmp_path):
    """For MF-Tyre a missing key means another thing than the default of the table."""
    text = re.sub(r"(?m)^(QSY8|MASS|Q_CAM1|PECP2) .*\n", "", TEXT)
    tyre = read_bytes(tmp_path, text.encode())
    assert written(tyre, tmp_path) == text.encode()
    expanded = read_bytes(tmp_path, tyre.expand().text().encode())
    for name in ("QSY8", "Q_CAM1", "PECP2"):
        assert name in expanded.present
        assert expanded.status[name].startswith("default")
        assert expanded[name] == BY_NAME[name].default
    assert {n: expanded[n] for n in tyre.present} == {n: tyre[n] for n in tyre.present}


def test_keys_that_the_file_lacks_join_their_section_in_the_order_of_the_table(tmp_path):
    text = re.sub(r"(?m)^(PDY2|PDY3|PEY1) .*\n", "", TEXT).replace("[TURNSLIP_COEFFICIENTS]", "[OTHER]")
    text = text[: text.index("[OTHER]")].rstrip("\n")
    tyre = read_bytes(tmp_path, text.encode())
    again = tyre.replace(PDY2=-0.1, PDY3=2.5, PEY1=-0.7, PECP1=0.2)
    keys = [
        line.key for line in parse_document(again.text()).entries if line.section == "LATERAL_COEFFICIENTS"
    ]
    assert keys[1:5] == ["PDY1", "PDY2", "PDY3", "PEY1"]
    found = read_bytes(tmp_path, again.text().encode())
    assert found == again
    assert "PECP1" in again.text().split("[TURNSLIP_COEFFICIENTS]")[1]
    assert set(text.splitlines()) <= set(again.text().splitlines())


def test_the_origin_of_a_value_is_its_comment(tmp_path):
    tyre = read_bytes(tmp_path, WILD.encode())
    noted = tyre.replace(PKY1=-13.0).annotate(
        status={"PKY1": "fitted +- 0.1"},
        measured={"epsilon_gamma": tir.Quantity(-0.06, 0.08, "-")},
        provenance={"program": "test"},
    )
    again = read_bytes(tmp_path, written(noted, tmp_path))
    assert again.status["PKY1"] == "fitted +- 0.1"
    assert again.measured == noted.measured
    assert again.provenance == noted.provenance
    assert again == noted
    changed = set(again.document.text.splitlines()) ^ set(WILD.splitlines())
    assert len(changed) == 4, "the line of PKY1 as it was and as it is, and two comments"
    stale = read_bytes(tmp_path, written(again.replace(PKY1=-14.0), tmp_path))
    assert "PKY1" not in stale.status, "an origin that no longer holds is taken away"
    replaced = again.annotate(measured={"epsilon_gamma": tir.Quantity(0.1, 0.02, "-")})
    assert replaced.text().count("! measured:") == 1


@given(
    st.sampled_from([r.name for r in TABLE if r.kind == "number" and r.unit not in ("", "-")]),
    st.floats(0.1, 1e5),
)
def test_changed_values_are_written_in_the_files_units(name, value):
    text = TEXT.replace("'meter'", "'mm'").replace("'newton'", "'kN'").replace("'radians'", "'deg'")
    text = text.replace("'second'", "'minute'").replace("'kg'", "'g'")
    tyre = interpret(parse_document(text)).replace(**{name: value})
    again = interpret(parse_document(tyre.text()))
    assert again[name] == pytest.approx(value, rel=4e-16)
    assert again["PKY1"] == tyre["PKY1"]


def test_a_value_that_cannot_be_written_is_refused_before_writing(tmp_path):
    tyre = read_bytes(tmp_path, WILD.encode())
    with pytest.raises(tir.TirError, match="PKY1"):
        tyre.replace(PKY1=float("nan")).write(tmp_path / "new.tir")
    assert not (tmp_path / "new.tir").exists()
