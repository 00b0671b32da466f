"""Every key of the contract is accepted; any other is refused with its line and the nearest known key."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from mffit import config
from mffit.config.loading import is_pattern, matches
from mffit.config.problems import known_keys
from mffit.config.rig_declaration import setup_names
from mffit.config.toml_file import lines_of_keys
from mffit.errors import InputError

MINIMAL = """[tyre]
name = "front-1"
unloaded_radius = 0.2998
nominal_load = 1500
nominal_pressure = 250

[rig]
path_radius = 1.323

[[sweep]]
file = "a.csv"

[[sweep]]
file = "b.csv"
"""

COMPLETE = """[tyre]
name = "front-1"
size = "120/70ZR17"
unloaded_radius = 0.2998
width = 0.120
rim_radius = 0.2159
nominal_load = 1500
nominal_pressure = 250
nominal_speed = 10
side = "symmetric"
base = "base.tir"

[rig]
type = "rotating-disk"
axes = "adapted-sae"
force_frame = "C"
path_centre = "right"
u_length = 0.001
backlash_deg = 0.17
u_backlash_deg = 0.01
u_loadcell_offset_N = 10
u_camber_alignment_deg = 0.5
u_slip_alignment_N = 25

[rig.path]
shaft_diameter = 0.080
L_B = 1.140
L_C = 0.083
L_D = 0.203

[[rolling_radius]]
load_N = 1500
revolutions = 4
angle_start_deg = 12.0
angle_end_deg = 187.0
u_angle_deg = 1.0
u_arc_m = 0.001

[[rolling_radius]]
load_N = 2000
effective_radius = 0.2924
u_effective_radius = 0.0004

[camber_stiffness]
method = "secant"
angle_deg = 15

[spin]
exact = "turn-slip"
pecp1 = "model"

[model]
turn_slip = false
star = true
u_coefficients = 0.004

[[sweep]]
file = "sideslip.csv"
direction = "forward"
mount = "flipped"
[sweep.columns]
Fy_N = { column = "FY", unit = "kN", scale = -1 }
alpha_deg = "SA"

[[sweep]]
file = "zero.csv.gz"
direction = "backward"
"""


def write(folder: Path, text: str) -> Path:
    path = folder / "tyre.toml"
    path.write_text(text)
    return path


def refusal(folder: Path, text: str) -> InputError:
    with pytest.raises(InputError) as caught:
        config.load(write(folder, text))
    return caught.value


def test_every_key_of_the_contract_is_accepted(tmp_path):
    found = config.load(write(tmp_path, COMPLETE))
    assert found.tyre.side == "symmetric"
    assert found.rig.path.L_B == 1.14
    assert found.rolling_radius[1].effective_radius == 0.2924
    assert found.sweep[0].columns["Fy_N"].scale == -1.0
    assert found.sweep[0].columns["alpha_deg"].column == "SA"
    assert found.path == tmp_path / "tyre.toml"
    assert found.base_path == tmp_path / "base.tir"


def test_defaults_are_those_of_the_contract(tmp_path):
    found = config.load(write(tmp_path, MINIMAL))
    rig = found.rig
    assert (rig.type, rig.axes, rig.force_frame, rig.path_centre) == ("rotating-disk", "iso", "W", "left")
    assert (rig.u_path_radius, rig.u_length, rig.backlash_deg) == (0.0018, 0.001, 0.0)
    assert (rig.u_loadcell_offset_N, rig.u_camber_alignment_deg, rig.u_slip_alignment_N) == (10, 0.5, 25)
    assert (found.camber_stiffness.method, found.camber_stiffness.angle_deg) == ("slope", 15.0)
    assert (found.spin.exact, found.spin.pecp1) == ("turn-slip", "direct")
    assert (found.model.turn_slip, found.model.star, found.model.u_coefficients) == (True, False, 0.0)
    assert (found.sweep[0].direction, found.sweep[0].mount) == (None, "normal")


def test_the_path_radius_is_that_of_the_four_tape_measures(tmp_path):
    """(19): half the shaft, the gap, and the middle of the sidewalls: 0.040 + 1.140 + 0.143 m."""
    assert config.load(write(tmp_path, COMPLETE)).rig.radius == pytest.approx(1.323, abs=1e-12)


def test_the_rolling_radius_follows_from_one_revolution_of_the_disc():
    """(18): 4 turns and 175 degrees over a circle of 1.323 m: 1.323 / (4 + 175/360)."""
    row = config.RollingRadiusTable(revolutions=4.0, angle_start_deg=12.0, angle_end_deg=187.0)
    assert config.effective_radius(row, 1.323) == pytest.approx(1.323 / (4 + 175 / 360), rel=1e-12)


def test_a_rolling_radius_without_a_load_holds_at_the_nominal_load(tmp_path):
    row = "\n[[rolling_radius]]\neffective_radius = 0.2945\nu_effective_radius = 0.001\n"
    found = config.load(write(tmp_path, f"{MINIMAL}{row}{row}load_N = 900\n"))
    assert [row.load_N for row in found.rolling_radius] == [1500.0, 900.0]


def test_a_column_given_by_its_heading_has_its_own_unit_and_no_factor(tmp_path):
    column = config.load(write(tmp_path, COMPLETE)).sweep[0].columns["alpha_deg"]
    assert (column.column, column.unit, column.scale) == ("SA", None, 1.0)


def test_a_pattern_is_a_name_with_wild_cards_that_no_file_has(tmp_path):
    for name in ("a[1].csv", "a1.csv", "b3.csv", "b2.csv"):
        (tmp_path / name).touch()
    assert not is_pattern("a1.csv", tmp_path)
    assert not is_pattern("a[1].csv", tmp_path)
    assert is_pattern("b*.csv", tmp_path)
    assert matches("b*.csv", tmp_path) == ["b2.csv", "b3.csv"]
    assert matches(f"{tmp_path}/b*.csv", Path("elsewhere")) == [str(tmp_path / f"b{k}.csv") for k in (2, 3)]


def test_lines_are_right_behind_a_pattern(tmp_path):
    """Two files match the first [[sweep]], so that the second table is the third sweep."""
    for name in ("a1.csv", "a2.csv"):
        (tmp_path / name).touch()
    text = MINIMAL.replace('"a.csv"', '"a*.csv"').replace('"b.csv"', '"b.csv"\ndirection = "back"')
    error = refusal(tmp_path, text)
    assert (error.key, error.line) == ("sweep[3].direction", 15)
    error = refusal(tmp_path, MINIMAL.replace('"b.csv"', '"b*.csv"'))
    assert (error.key, error.line) == ("sweep[2].file", 14)
    assert str(error).endswith('matches "b*.csv"; correct the pattern')


def test_phi_t_has_the_sign_of_the_path_centre():
    """A centre to the left turns the rig to the left, psi_dot > 0: phi_t = -psi_dot/V = -1/R."""
    rig = config.RigTable(path_radius=1.25)
    assert config.path_curvature(rig) == -0.8
    assert config.path_curvature(rig.model_copy(update={"path_centre": "right"})) == 0.8
    assert config.path_curvature(config.RigTable(type="flat-track")) == 0.0


def test_a_flat_track_needs_no_path(tmp_path):
    found = config.load(write(tmp_path, MINIMAL.replace("path_radius = 1.323", 'type = "flat-track"')))
    assert found.rig.radius is None


def test_a_loaded_configuration_is_returned_unchanged(tmp_path):
    found = config.load(write(tmp_path, MINIMAL))
    assert config.load(found) is found


@pytest.mark.parametrize(
    ("old", "new", "key", "line", "said"),
    [
        ("unloaded_radius", "unloded_radius", "tyre.unloded_radius", 3, 'did you mean "unloaded_radius"'),
        ('name = "front-1"', "", "tyre.name", 1, "missing"),
        ("nominal_load = 1500", "", "tyre.nominal_load", 1, "missing"),
        ("nominal_load = 1500", "nominal_load = 1.5", "tyre.nominal_load", 4, "kilonewtons"),
        ("nominal_load = 1500", "nominal_load = -1500", "tyre.nominal_load", 4, "outside"),
        ("nominal_pressure = 250", "nominal_pressure = 2.5", "tyre.nominal_pressure", 5, "bar"),
        ("nominal_pressure = 250", "nominal_pressure = 250000", "tyre.nominal_pressure", 5, "Pa"),
        ("unloaded_radius = 0.2998", "unloaded_radius = 299.8", "tyre.unloaded_radius", 3, "millimetres"),
        ("unloaded_radius = 0.2998", "unloaded_radius = true", "tyre.unloaded_radius", 3, "not a number"),
        ("path_radius = 1.323", "path_radius = 1323", "rig.path_radius", 8, "millimetres"),
        ("path_radius = 1.323", 'path_radius = "1.323"', "rig.path_radius", 8, "quotes"),
        ("path_radius = 1.323", "path_radius = nan", "rig.path_radius", 8, "finite"),
        ("path_radius = 1.323", "", "rig.path_radius", 7, "flat-track"),
        ("path_radius = 1.323", "path_radius = 1.3\nu_path_radius = 1.8", "rig.u_path_radius", 9, "metres"),
        ("path_radius = 1.323", "path_radius = 1.3\naxes = 'ISO'", "rig.axes", 9, "'adapted-sae'"),
        ("path_radius = 1.323", "path_radius = 1.3\nbacklash_deg = -1", "rig.backlash_deg", 9, "outside"),
        ('file = "b.csv"', 'fiel = "b.csv"', "sweep[2].fiel", 14, 'did you mean "file"'),
        ('file = "b.csv"', 'file = "a.csv"', "sweep[2].file", 14, "twice"),
        ('file = "b.csv"', 'file = "b.csv"\ndirection = "back"', "sweep[2].direction", 15, "'backward'"),
        ("[tyre]", "[tire]", "tire", 1, 'did you mean "tyre"'),
        ("[tyre]", "path_centre = 'left'\n[tyre]", "path_centre", 1, "[rig]"),
        ("[rig]", "path_radius = 1.3\n[rig]", "tyre.path_radius", 7, "is unknown here; move it to [rig]"),
        ("[rig]", "[spin]\nexact = 'all'\n[rig]", "spin.exact", 8, "'turn-slip'"),
        ("front-1", "../front", "tyre.name", 2, "cannot name"),
        (
            "[rig]",
            "[columns]\nFy_N = { clumn = 'FY' }\n[rig]",
            "columns.Fy_N.clumn",
            8,
            'did you mean "column"',
        ),
        ("[rig]", "rim_radius = 0.4\n[rig]", "tyre.rim_radius", 7, "not smaller than the unloaded radius"),
        ("nominal_load", "quux", "tyre.quux", 4, "is unknown; known here are name, size, unloaded_radius"),
        ("nominal_load", "quux", "tyre.quux", 4, "(also wrong: tyre.nominal_load)"),
        ('name = "front-1"', "", "tyre.name", 1, "is missing; add it to [tyre]"),
        ('file = "b.csv"', "", "sweep[2].file", 13, "is missing; add it to [[sweep]]"),
        ('name = "front-1"', 'name = ["a"]', "tyre.name", 2, "a list is not a text in quotes; write one"),
        (
            'name = "front-1"',
            "name = { a = 1 }",
            "tyre.name",
            2,
            "a table is not a text in quotes; write one",
        ),
        (
            "nominal_load = 1500",
            'nominal_load = "heavy"',
            "tyre.nominal_load",
            4,
            '"heavy" is not a number; write one',
        ),
        (
            "nominal_load = 1500",
            'nominal_load = "1500,5"',
            "tyre.nominal_load",
            4,
            '"1500,5" is not a number; write one, with a decimal point',
        ),
        (
            "nominal_load = 1500",
            "nominal_load = false",
            "tyre.nominal_load",
            4,
            "false is not a number; write one",
        ),
    ],
)
def test_a_mistake_is_reported_with_key_and_line(tmp_path, old, new, key, line, said):
    assert old in MINIMAL
    error = refusal(tmp_path, MINIMAL.replace(old, new, 1))
    assert (error.key, error.line) == (key, line)
    assert said in str(error)
    assert str(error).startswith(f"{tmp_path / 'tyre.toml'}:{line}: {key}: ")
    assert "\n" not in str(error)


@pytest.mark.parametrize("digits", [400, 5000])
def test_a_number_that_no_float_holds_is_refused_under_any_key(tmp_path, digits):
    number = digits * "1"
    error = refusal(tmp_path, MINIMAL.replace("[tyre]", f"[tyre]\nnominal_speed = {number}", 1))
    assert (error.key, error.line) == ("tyre.nominal_speed", MINIMAL.splitlines().index("[tyre]") + 2)
    assert error.sentence == "has more digits than a number can have; correct it"
    error = refusal(tmp_path, MINIMAL + f"\n[lab]\nhumidity = {{ air = [1, {number}] }}\n")
    assert error.key.startswith("lab.humidity")


RANGES = [
    ("tyre.unloaded_radius", 0.03, 1.5, " m"),
    ("tyre.rim_radius", 0.03, 1.5, " m"),
    ("tyre.width", 0.01, 1.0, " m"),
    ("tyre.nominal_load", 20.0, 2e5, " N"),
    ("tyre.nominal_pressure", 20.0, 2000.0, " kPa"),
    ("tyre.nominal_speed", 0.01, 150.0, " m/s"),
    ("rig.path_radius", 0.2, 100.0, " m"),
    ("rig.path.L_B", 0.001, 100.0, " m"),
    ("rig.backlash_deg", 0.0, 10.0, " deg"),
    ("rig.u_loadcell_offset_N", 0.0, 1e4, " N"),
    ("rig.u_camber_alignment_deg", 0.0, 20.0, " deg"),
    ("rolling_radius.load_N", 20.0, 2e5, " N"),
    ("rolling_radius.revolutions", 0.0, 1e4, " revolutions"),
    ("rolling_radius.angle_start_deg", -360.0, 720.0, " deg"),
    ("rolling_radius.angle_end_deg", -360.0, 720.0, " deg"),
    ("rolling_radius.u_angle_deg", 0.0, 20.0, " deg"),
    ("rolling_radius.u_arc_m", 0.0, 0.1, " m"),
    ("camber_stiffness.angle_deg", 1.0, 60.0, " deg"),
    ("model.u_coefficients", 0.0, 1.0, " of the value"),
]


def with_value(dotted: str, value: float) -> dict:
    """The content of a complete ``tyre.toml`` with one other value."""
    content = tomllib.loads(COMPLETE)
    *tables, key = dotted.split(".")
    table = content
    for name in tables:
        found = table[name]
        table = found[0] if isinstance(found, list) else found
    table[key] = value
    return content


def said_of(dotted: str, value: float) -> str:
    """The refusal of a value; empty if it is accepted."""
    try:
        config.load(with_value(dotted, value))
    except InputError as error:
        return str(error).replace("[1]", "")
    return ""


@pytest.mark.parametrize(("key", "lower", "upper", "unit"), RANGES)
def test_a_number_is_refused_outside_its_range_and_not_at_its_ends(key, lower, upper, unit):
    margin = 1e-6 * (upper - lower)
    for outside in (lower - margin, upper + margin):
        assert f"{key}: {outside:g}{unit} is outside {lower:g} to {upper:g}{unit}; " in said_of(key, outside)
    for inside in (lower, upper):  # may be refused for another reason, such as a rim larger than its tyre
        assert f"{key}: {inside:g}{unit} is outside" not in said_of(key, inside)


@pytest.mark.parametrize(
    ("key", "value", "remedy"),
    [
        ("tyre.unloaded_radius", 11.8, "inches or centimetres, write metres"),
        ("tyre.unloaded_radius", 8.1, "inches, write metres"),
        ("tyre.unloaded_radius", 29.98, "centimetres, write metres"),
        ("tyre.unloaded_radius", 299.8, "millimetres, write metres"),
        ("tyre.nominal_pressure", 2.5, "bar, write kilopascals"),
        ("tyre.nominal_pressure", 12.0, "psi, write kilopascals"),
        ("tyre.nominal_pressure", 8.0, "psi or bar, write kilopascals"),
        ("tyre.nominal_pressure", 0.3, "bar, write kilopascals"),
        ("tyre.nominal_pressure", 25e4, "pascals, write kilopascals"),
        ("tyre.nominal_load", 1.5, "kilonewtons, write newtons"),
        ("camber_stiffness.angle_deg", 0.26, "radians, write degrees"),
    ],
)
def test_the_remedy_names_the_unit_in_which_a_number_would_be_usual(key, value, remedy):
    assert said_of(key, value).endswith(f"; it looks like {remedy}")


@pytest.mark.parametrize("value", [0.0, -3.0])
def test_a_number_that_no_unit_explains_is_to_be_corrected(value):
    assert said_of("tyre.nominal_pressure", value).endswith("is outside 20 to 2000 kPa; correct it")


@pytest.mark.parametrize(
    ("row", "said"),
    [
        ("effective_radius = 0.2945", "u_effective_radius"),
        ("effective_radius = 0.59\nu_effective_radius = 0.001", "check both"),
        ("effective_radius = 0.2945\nu_effective_radius = 0.05", "a tenth"),
        ("revolutions = 4", "angle_start_deg"),
        ("revolutions = 2\nangle_start_deg = 0\nangle_end_deg = 88", "diameter"),
        ("revolutions = 7\nangle_start_deg = 0\nangle_end_deg = 88", "revolutions"),
        (
            "revolutions = 4\nangle_start_deg = 0\nangle_end_deg = 88\neffective_radius = 0.3",
            "one of the two",
        ),
    ],
)
def test_absurd_rolling_radii_are_refused(tmp_path, row, said):
    error = refusal(tmp_path, MINIMAL + f"\n[rolling_radius]\n{row}\n")
    assert error.key.startswith("rolling_radius")
    assert error.line >= 16
    assert said in str(error)


def test_a_disc_revolution_on_a_flat_track_is_refused(tmp_path):
    row = "\n[rolling_radius]\nrevolutions = 4\nangle_start_deg = 0\nangle_end_deg = 175\n"
    error = refusal(tmp_path, MINIMAL.replace("path_radius = 1.323", 'type = "flat-track"') + row)
    assert "flat track" in str(error)


def test_a_path_radius_beside_the_tape_measures_is_refused(tmp_path):
    error = refusal(tmp_path, COMPLETE.replace("u_length = 0.001", "path_radius = 1.3"))
    assert "one of the two" in str(error)


def test_several_mistakes_are_listed_in_one_sentence(tmp_path):
    text = MINIMAL.replace("1.323", "-1").replace("nominal_load", "nominal_laod")
    error = refusal(tmp_path, text)
    assert error.key == "tyre.nominal_laod"
    assert "(also wrong: rig.path_radius)" in str(error)


@pytest.mark.parametrize(
    ("text", "line"),
    [("[tyre\nname =", 1), ("[tyre]\nname = \n", 2), ('[tyre]\nname = "a"\nname = "b"\n', 3)],
)
def test_broken_toml_is_refused_with_its_line(tmp_path, text, line):
    error = refusal(tmp_path, text)
    assert error.line == line
    assert "TOML" in str(error)


def test_a_missing_configuration_says_where_to_get_one(tmp_path):
    with pytest.raises(InputError, match="mffit init"):
        config.load(tmp_path / "nowhere.toml")


def test_a_configuration_in_utf_16_is_refused(tmp_path):
    path = tmp_path / "tyre.toml"
    path.write_bytes(MINIMAL.encode("utf-16"))
    with pytest.raises(InputError, match="UTF-8"):
        config.load(path)


def test_an_empty_configuration_is_refused(tmp_path):
    assert "missing" in str(refusal(tmp_path, ""))


def test_lines_are_found_whatever_the_values_look_like():
    text = '''# [not.a.table]
top = 1
[a]
"quoted key" = "x = [ # no comment"
list = [
  "b = 3",  # c = 4
]
text = """
inside = 5
"""
after = 6
[a.b]
c.d = 7
[[s]]
x = 1
[s.t]
y = 2
[[s]]
x = { z = 1 }
'''
    assert lines_of_keys(text) == {
        "top": 2, "a": 3, "a.quoted key": 4, "a.list": 5, "a.text": 8, "a.after": 11, "a.b": 12,
        "a.b.c.d": 13, "s.0": 14, "s.0.x": 15, "s.0.t": 16, "s.0.t.y": 17, "s.1": 18, "s.1.x": 19,
    }  # fmt: skip


def test_known_keys_cover_every_table():
    known = known_keys(config.Config)
    assert set(known) == {
        "", "tyre", "rig", "rig.path", "rolling_radius", "camber_stiffness", "spin", "model", "columns.*", "sweep",
        "sweep.columns.*", "normal", "fit", "fit.exclude", "lab", "lab.instruments",
    }  # fmt: skip


def test_a_rig_toml_is_recognised():
    with pytest.raises(InputError, match="mffit simulate") as error:
        config.load(Path(__file__).parents[3] / "samples" / "front-120-70" / "rig.toml")
    assert "did you mean" not in str(error.value)


def test_a_table_named_by_a_number_is_refused_with_its_line(tmp_path):
    """Elsewhere in a key, a number counts the entries of a list."""
    (tmp_path / "tyre.toml").write_text(f"{MINIMAL}\n[9]\n")
    with pytest.raises(InputError, match="is unknown; known here are tyre, rig") as caught:
        config.load(tmp_path / "tyre.toml")
    assert (caught.value.key, caught.value.line) == ("9", 16)


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ('temperature = "yes"', "fit.temperature: \"yes\" is not allowed; write 'auto', true or false"),
        ("sense = true", "fit.sense: true is not allowed; write 'auto', 'hysteresis', 'lag' or false"),
        ("T_ref_degC = 333", "fit.T_ref_degC: 333 degC is outside -40 to 200 degC"),
    ],
)
def test_wrong_settings_of_the_fit_are_named_with_what_is_allowed(tmp_path, line, sentence):
    path = tmp_path / "tyre.toml"
    path.write_text(MINIMAL + f"\n[fit]\n{line}\n")
    with pytest.raises(InputError) as refused:
        config.load(path)
    assert sentence in str(refused.value)


def test_a_set_up_without_a_name_has_that_of_its_path(tmp_path):
    """The radius is in it where a side of the disc has several."""
    own = ("", "path_centre = 'left'\npath_radius = 1.9", "path_radius = 1.9", "setup = 'mine'")
    sweeps = "\n".join(f"[[sweep]]\nfile = '{k}.csv'\n{keys}" for k, keys in enumerate(own))
    (tmp_path / "tyre.toml").write_text(f"{MINIMAL.split('[[sweep]]')[0]}path_centre = 'right'\n{sweeps}\n")
    found = config.load(tmp_path / "tyre.toml")
    assert setup_names(found.rig, found.sweep) == ("right-1.323m", "left", "right-1.9m", "mine")
