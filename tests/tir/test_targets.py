"""Files for other programs, each read back by a small imitation of that program's habits."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import tir
from tir.checking import check
from tir.document import parse_document
from tir.parameters import SECTIONS, TABLE
from tir.targets import ADAMS, KNOWN, ONLY_62, TARGETS, use_mode_words, vendor
from tir.tyre import interpret

VECTORS = Path(__file__).parent / "vectors"
TEXT = (VECTORS / "moto_front.tir").read_text(encoding="ascii")
USABLE = [name for name, target in TARGETS.items() if not target.refusal]
HEADER = {"FILE_TYPE", "FILE_VERSION", "FILE_FORMAT", "LENGTH", "FORCE", "ANGLE", "MASS", "TIME"}
NEEDED = [row.name for row in TABLE if row.kind == "number" and row.section.endswith("COEFFICIENTS")]


@pytest.fixture(scope="module")
def tyre() -> tir.Tyre:
    """With all the text in its comments that could lead a reader astray."""
    found = tir.read(VECTORS / "moto_front.tir").replace(PVY1=0.1 + 0.2, PKY1=-12.345678901234567)
    return found.annotate(provenance={"note": "a = b; c! d"}, status={"PKY1": "fitted = 1; !" + 90 * "x"})


def numbers(found: dict[str, str]) -> dict[str, float]:
    return {name: float(text) for name, text in found.items() if name in NEEDED}


def first_equals_dollar_comments(text: str) -> dict[str, float]:
    """Anything with '=' is a parameter unless the line is a comment; only $ ends a value; later keys do not replace."""
    found: dict[str, str] = {}
    for line in text.split("\r\n"):
        if "=" in line and line[0] not in "$!":
            key, _, rest = line.partition("=")
            found.setdefault(key.strip(), rest.split("$")[0].strip())
    return numbers(found)


def every_equals(text: str) -> dict[str, float]:
    """Splits a line at each '=' and takes the second piece up to the first blank."""
    pieces = [line.split("=") for line in text.splitlines() if not line.startswith("!")]
    return numbers({p[0].strip(): p[1].split()[0] for p in pieces if len(p) > 1})


def short_buffer(text: str) -> dict[str, float]:
    """Lines of 200 characters, cut; blanks around '='; the value ends at a blank."""
    words = [line[:200].split() for line in text.splitlines()]
    return numbers({w[0]: w[2] for w in words if len(w) > 2 and w[1] == "="})


def line_ends_lost(text: str) -> dict[str, float]:
    """Splits at LF and drops the last character of every line, which it takes for CR."""
    lines = [line[:-1] for line in text.split("\n")]
    pairs = [line.split("=", 1) for line in lines if "=" in line and line[0] not in "$!"]
    return numbers({key.strip(): rest.split("$")[0].strip() for key, rest in pairs})


def comments_by_pattern(text: str) -> dict[str, float]:
    """Deletes rulers, section heads and what follows a dollar sign by patterns, then splits every line at '='."""
    for pattern in (r"\$[-]+[-]*[\w\s]*\n", r"\[\w*\]\s*\n", r"\$[^\n]*"):
        text = re.sub(pattern, "", text)
    pairs = [line.split("=") for line in text.split("\n") if "=" in line]
    return numbers({key.strip(): value.strip() for key, value in pairs})


@pytest.mark.parametrize(
    "habit",
    [first_equals_dollar_comments, every_equals, short_buffer, line_ends_lost, comments_by_pattern],
)
@pytest.mark.parametrize("name", USABLE)
def test_every_habit_reads_identical_numbers(tyre, name, habit):
    found = habit(tyre.text(name))
    wanted = {row: tyre[row] for row in found}
    assert found == wanted
    assert {"PCY1", "PKY1", "PVY1", "QDRP1", "QSY8"} <= set(found)


@pytest.mark.parametrize("name", USABLE)
def test_no_program_meets_an_unknown_key_or_a_version_it_does_not_read(tyre, name):
    target = TARGETS[name]
    document = parse_document(tyre.text(name))
    keys = {line.key for line in document.entries}
    assert keys <= HEADER | {row.name for row in TABLE} | set(target.more)
    assert all(line.section for line in document.entries)
    (version,) = [line.value for line in document.entries if line.key == "FITTYP"]
    assert int(version) in target.fittyps
    assert not keys & (set(target.without) - HEADER)


@pytest.mark.parametrize("name", USABLE)
def test_what_is_written_for_a_program_passes_its_check(tyre, name):
    written = interpret(parse_document(tyre.text(name)))
    assert [p.sentence for p in check(written, [name]) if p.level == "error"] == []


@pytest.mark.parametrize("name", USABLE)
def test_the_forces_are_the_same_in_every_file(tyre, name):
    written = interpret(parse_document(tyre.text(name)))
    condition = (1800.0, 0.05, 0.3, 0.02, -0.4)
    assert written(*condition) == tyre(*condition)


def test_reading_by_position(tyre):
    """Counts lines behind a section head and never looks at the key; the counts are those of MF 6.2."""
    text = tyre.text("mbsim")

    def section(name: str) -> list[str]:
        body = text.split(f"[{name}]\r\n")[1].split("$---")[0].split("\r\n")
        return [line.split("=")[1].split("$")[0].strip() for line in body if line]

    assert section("MODEL")[:2] == ["62", "'LEFT'"]
    assert float(section("MODEL")[2]) == tyre["LONGVL"]
    assert float(section("DIMENSION")[2]) == tyre["RIM_RADIUS"]
    assert float(section("LATERAL_COEFFICIENTS")[9]) == tyre["PKY1"]
    for name, count in (
        ("VERTICAL", 25), ("STRUCTURAL", 22), ("LATERAL_COEFFICIENTS", 42), ("ALIGNING_COEFFICIENTS", 33),
        ("TURNSLIP_COEFFICIENTS", 19), ("LONGITUDINAL_COEFFICIENTS", 26), ("OVERTURNING_COEFFICIENTS", 15),
    ):  # fmt: skip
        assert len(section(name)) == count, name


def test_a_file_for_adams_names_the_model_as_62_does(tyre):
    keys = {line.key: line.value for line in parse_document(tyre.text("adams")).entries}
    assert keys["FUNCTION_NAME"].startswith("'TNO_DelftTyre")
    assert keys["N_TIRE_STATES"] == "5"
    assert "USER_SUB_ID" not in keys
    others = {line.key for line in parse_document(tyre.text("mftyre")).entries}
    assert not others & {*ADAMS, "FUNCTION_NAME"}


@pytest.mark.parametrize("name", USABLE)
def test_the_keys_are_those_of_the_version(tyre, name):
    for version in (61.0, 62.0):
        document = parse_document(tyre.replace(FITTYP=version).text(name))
        keys = {line.key: line.value for line in document.entries}
        assert bool(keys.keys() & set(ONLY_62)) == (keys["FITTYP"] == "62")
        assert keys["FITTYP"] == str(int(version)) or int(version) not in TARGETS[name].fittyps


def test_tyredyn_refuses_text_in_model_and_a_line_with_two_equals_signs(tyre):
    """Every value of [MODEL] but two has to be a number; whole-line comments other than rulers are split too."""
    (model,) = re.findall(r"\[MODEL\]\r\n(.*?)\r\n\$-", tyre.text("tyredyn"), re.DOTALL)
    values = dict(line.split("$")[0].split("=") for line in model.split("\r\n"))
    for key, value in values.items():
        assert key.strip() in ("TYRESIDE", "FITTYP") or float(value) is not None


@pytest.mark.parametrize("name", ["chrono", "pac2002", "adams-motorcycle"])
def test_another_formula_is_refused_with_the_reason(tyre, name):
    formula = TARGETS[name].refusal.split()[1].strip(",")
    with pytest.raises(tir.TirError, match=rf"{formula}.*another formula.*mffit convert"):
        tyre.text(name)
    assert any(p.level == "error" and formula in p.sentence for p in check(tyre, [name]))


@pytest.mark.parametrize(
    ("form", "mode", "said"),
    [
        ("", 124, ["no PROPERTY_FILE_FORMAT", "USE_MODE 124 is none of 1 to 4", "behind the peak"]),
        ("", 4, ["no PROPERTY_FILE_FORMAT", "behind the peak"]),
        ("USER", 124, ["stops at PROPERTY_FILE_FORMAT 'USER'", "USE_MODE 124 is none", "behind the peak"]),
        ("PAC2002", 4, ["behind the peak"]),
    ],
)
def test_what_chrono_does_with_the_file_itself_is_told(tyre, form, mode, said):
    text = tyre.replace(USE_MODE=float(mode)).text("mftyre")
    if form:
        text = text.replace("[MODEL]\r\n", f"[MODEL]\r\nPROPERTY_FILE_FORMAT = '{form}'\r\n")
    found = [
        p.sentence for p in check(interpret(parse_document(text)), ["chrono"]) if "for chrono" in p.sentence
    ]
    assert len(found) == len(said)
    assert all(words in sentence for words, sentence in zip(said, found, strict=True))


@pytest.mark.parametrize(
    ("programs", "said"),
    [
        ([], 1),
        (["mftyre", "carsim"], 1),
        (["carmaker-mftyre"], 1),
        (["recurdyn", "mfeval"], 1),
        (["mfeval"], 0),
    ],
)
def test_turn_slip_needs_the_licence_of_swift_where_siemens_solver_runs(tyre, programs, said):
    """Once, and only if the file asks for turn slip and a program may compute it so."""
    for mode, times in ((225.0, said), (124.0, 0)):
        found = [p for p in check(tyre.replace(USE_MODE=mode), programs) if "MF-Swift licence" in p.sentence]
        assert len(found) == times


def test_an_unknown_program_is_refused_with_the_known_ones(tyre):
    with pytest.raises(tir.TirError, match="mftyre"):
        tyre.text("excel")
    with pytest.raises(tir.TirError, match="mftyre"):
        check(tyre, ["excel"])


def test_the_digits_of_use_mode_are_explained(tyre):
    assert (
        use_mode_words(225)
        == "smooth road, round cross-section, nonlinear relaxation, combined and turn slip"
    )
    assert use_mode_words(4) == "road contact by default, steady state, combined slip"
    assert vendor(225) == vendor(134) == "'TNO-SWIFT'"
    assert vendor(114) == "'TNO-MF'"
    assert "round cross-section" in tyre.replace(USE_MODE=214.0).text("mftyre")


class TestCheckOfText:
    """Faults planted in a file's text are named with their line."""

    @staticmethod
    def sentences(text: str, target: str) -> list[str]:
        return [
            p.sentence
            for p in check(interpret(parse_document(text)), [target])
            if f"for {target}" in p.sentence
        ]

    def number_of(self, text: str, key: str) -> int:
        return next(i for i, line in enumerate(text.splitlines(), 1) if line.startswith(key))

    @pytest.mark.parametrize(
        ("mangled", "target", "key", "words"),
        [
            (TEXT.replace("'meter'", "'mm'"), "simscape", "LENGTH", "SI"),
            (TEXT.replace("= 1.27\n", "= 1.27 ! peak\n"), "mfeval", "PDY1", "only $"),
            (re.sub(r"(?m)^QSY3 .*\n", "", TEXT), "carmaker", "", "QSY3"),
            (TEXT.replace("= 62\n", "= 61\n"), "simscape", "FITTYP", "FITTYP 61"),
            (TEXT, "mbsim", "ASPECT_RATIO", "RIM_RADIUS"),
            (TEXT, "recurdyn", "", "VENDER_TIRE_TYPE"),
            (
                TEXT.replace("[MODEL]\n", "[MODEL]\nFUNCTION_NAME = 'a::b'\n"),
                "adams",
                "USER_SUB_ID",
                "keep one",
            ),
            (TEXT.replace("= 1.27\n", "= 1.27 $" + 250 * "x" + "\n"), "mftyre", "PDY1", "characters"),
            (TEXT.replace("= 1.27\n", "= 1.27 $ für\n"), "mftyre", "PDY1", "ASCII"),
            (
                TEXT.replace("USE_MODE                 = 124", "USE_MODE = 225"),
                "simscape",
                "USE_MODE",
                "an option of the block",
            ),
        ],
    )
    def test_a_planted_stumbling_block_is_named(self, mangled, target, key, words):
        found = [s for s in self.sentences(mangled, target) if words in s]
        assert found, self.sentences(mangled, target)
        if key:
            assert any(f"line {self.number_of(mangled, key)}" in s for s in found), found


def test_only_keys_of_the_forces_are_called_indispensable(tyre):
    """A file that asks for no turn slip does without its coefficients."""
    text = tyre.expand().text("mftyre")
    for key, level in (("PKY4", "error"), ("MC_CONTOUR_A", "warning"), ("PKYP1", "warning")):
        lacking = interpret(parse_document(re.sub(rf"(?m)^{key} .*\n", "", text)))
        found = [p.level for p in check(lacking, ["simscape"]) if f"lacks {key};" in p.sentence]
        assert found == [level]


def test_the_order_of_sections_is_the_manuals(tyre):
    heads = [line.section for line in parse_document(tyre.text("mftyre")).lines if line.head]
    assert heads == ["MDI_HEADER", "UNITS", *SECTIONS]


@pytest.mark.parametrize(
    ("program", "changes", "name", "said"),
    [
        ("mbsim", {"MC_CONTOUR_B": 0.0}, "MC_CONTOUR_B", "NaN"),
        ("mbsim", {"LFZO": 1.1}, "LFZO", "at every evaluation"),
        ("mbsim", {"QDRP2": -0.3, "USE_MODE": 225.0}, "QDRP2", "no QDRP2"),
        ("simscape", {"USE_MODE": 225.0}, "USE_MODE", "an option of the block"),
        ("simscape", {}, "MC_CONTOUR_A", "square cross-section"),
        ("mbsim", {"USE_MODE": 225.0}, "USE_MODE", "Mz is NaN"),
        ("mfeval", {"USE_MODE": 225.0}, "USE_MODE", "reverses camber thrust"),
        ("ansysmotion", {"USE_MODE": 225.0}, "USE_MODE", "'SWIFT'"),
        ("chrono", {"LMUY": 0.8}, "LKY", "by LMUY instead of LKY"),
        ("tyredyn", {"USE_MODE": 225.0}, "USE_MODE", "reverses camber thrust"),
        ("teasit", {}, "MC_CONTOUR_A", "sine of camber"),
    ],
)
def test_what_a_program_does_with_a_value_is_told(tyre, program, changes, name, said):
    """The rest of this motorcycle tyre, written for the program, has no such problem."""
    found = {
        p.name: p.sentence
        for p in check(tyre.replace(**changes), [program])
        if f"for {program}" in p.sentence
    }
    assert said in found[name]
    plain = tyre.replace(MC_CONTOUR_A=0.0, MC_CONTOUR_B=0.5)
    assert name not in {p.name for p in check(plain, [program]) if f"for {program}" in p.sentence}


def test_every_profile_says_how_it_is_known():
    """By the program's source, or else with what it rests on; the form of the manual needs no words."""
    assert {target.known for target in TARGETS.values()} == set(KNOWN)
    for name in USABLE:
        target = TARGETS[name]
        assert bool(target.verified) == (target.known != "source read" and name not in ("mftyre", "mf61"))
        assert not target.verified or target.verified.endswith("nothing was run")
    assert "is assumed" in TARGETS["carmaker"].verified


def test_check_notes_what_is_not_verified_of_a_program(tyre):
    assert [p.level for p in check(tyre, ["carsim"]) if "nothing was run" in p.sentence] == ["note"]
    assert not [p for p in check(tyre, ["mftyre"]) if p.level == "note"]


def test_a_file_for_ansys_motion_selects_the_model(tyre):
    keys = {line.key: line.value for line in parse_document(tyre.text("ansysmotion")).entries}
    assert keys["PROPERTY_FILE_FORMAT"] == "'MF'"


def test_a_file_that_selects_another_model_is_warned_of(tyre, tmp_path):
    for other, warned in (("USER", True), ("MF", False)):
        text = tyre.text("ansysmotion").replace("'MF'", f"'{other}'")
        (tmp_path / "m.tir").write_text(text)
        found = [p.sentence for p in check(tir.read(tmp_path / "m.tir"), ["ansysmotion"])]
        assert any("PROPERTY_FILE_FORMAT is 'USER', but has to be 'MF'" in one for one in found) == warned


def test_what_is_wrong_over_the_range_has_the_origin_of_its_coefficient(tyre):
    """A coefficient that nobody measured is warned of in another way than a fitted one."""
    odd = tyre.replace(RCX1=1.7, RBX3=0.0, REX1=0.0, ALPMAX=0.3)
    (plain,) = (p.sentence for p in check(odd) if p.name == "RBX1")
    (said,) = (p.sentence for p in check(odd.annotate(status={"RBX1": "from base"})) if p.name == "RBX1")
    assert said == f"{plain} (RBX1: from base)"
