"""[lab] and [fit] exclude: what is accepted, and one sentence for each mistake."""

from __future__ import annotations

from datetime import date

import pytest
from test_config_loading import MINIMAL, refusal, write

from mffit import config
from mffit.config.laboratory import lab_warnings

EXCLUDE = '\n[fit]\nexclude = [ {{ file = "{file}", {lines}{why} }} ]\n'
LAB = """
[lab]
order = "T-1234"
operator = "Operator 7"
instruments = [
    { name = "Fy load cell", serial = "F 17", certificate = "K-2026-3", calibrated = 2026-03-01, due = 2027-03-01 },
    { name = "pressure gauge" },
]
"""


def excluding(file="a.csv", lines='lines = "39-44, 60"', why=', why = "belt tracking"'):
    head, sweeps = MINIMAL.split("[[sweep]]", 1)
    return head + EXCLUDE.format(file=file, lines=lines, why=why) + "\n[[sweep]]" + sweeps


def in_lab(old="", new=""):
    head, sweeps = MINIMAL.split("[[sweep]]", 1)
    return head + LAB.replace(old, new) + "\n[[sweep]]" + sweeps


def test_the_example_of_the_contract_is_accepted(tmp_path):
    (entry,) = config.load(write(tmp_path, excluding())).fit.exclude
    assert (entry.file, entry.ranges, entry.why) == ("a.csv", ((39, 44), (60, 60)), "belt tracking")


def test_one_line_may_be_a_number(tmp_path):
    (entry,) = config.load(write(tmp_path, excluding(lines="lines = 39"))).fit.exclude
    assert entry.ranges == ((39, 39),)


@pytest.mark.parametrize(
    ("text", "key", "words"),
    [
        (excluding(file="aa.csv"), "fit.exclude[1].file", 'did you mean "a.csv"'),
        (excluding(file="runs/x.mat"), "fit.exclude[1].file", "as [[sweep]] gives it"),
        (excluding(lines='lines = "44-39"'), "fit.exclude[1].lines", 'write "39-44"'),
        (excluding(lines='lines = "row 39"'), "fit.exclude[1].lines", "is not a line or a range"),
        (excluding(why=""), "fit.exclude[1].why", "is missing; add it to this entry"),
        (excluding(why=', why = "  "'), "fit.exclude[1].why", "is empty; write why"),
        (excluding(why=', why = "x", wy = "x"'), "fit.exclude[1].wy", 'did you mean "why"'),
        (in_lab("order =", "ordr ="), "lab.ordr", 'did you mean "order"'),
        (in_lab('serial = "F 17"', "serial = 17"), "lab.instruments[1].serial", "17 is not a text in quotes"),
        (in_lab("calibrated = 2026-03-01", 'calibrated = "2026-03-01"'), "lab.instruments[1].calibrated", "remove the quotes"),
        (in_lab("calibrated = 2026-03-01", 'calibrated = "March"'), "lab.instruments[1].calibrated", "is not a date such as"),
        (in_lab("2027-03-01", "2025-03-01"), "lab.instruments[1].due", "is before the calibration of 2026-03-01"),
        (in_lab('name = "pressure gauge"', 'serial = "1"'), "lab.instruments[2].name", "add it to this entry"),
        (in_lab('name = "pressure gauge"', 'name = ""'), "lab.instruments[2].name", "write the instrument"),
        (in_lab('"pressure gauge"', '"p", channel = "p"'), "lab.instruments[2].channel", "Fy"),
        (in_lab('"pressure gauge"', '"p", channel = "Fy"'), "lab.instruments[2]", "only one of channel and expanded_uncertainty"),
        (
            in_lab('"pressure gauge"', '"p", channel = "Fy", expanded_uncertainty = 40'),
            "lab.instruments[2].expanded_uncertainty",
            "as at",
        ),
        (in_lab("name =", 'channel = "Fy", expanded_uncertainty = 0.01, name ='), "lab.instruments[2].channel", "remove one"),
    ],
)  # fmt: skip
def test_a_mistake_is_one_sentence_with_file_line_and_key(tmp_path, text, key, words):
    error = refusal(tmp_path, text)
    assert error.key == key
    assert words in error.sentence
    assert error.line is not None
    assert "\n" not in str(error)


@pytest.mark.parametrize(
    ("measured", "today", "said"),
    [
        ("", date(2027, 3, 1), ()),
        ("", date(2027, 3, 2), ("due on 2027-03-01, before today, 2027-03-02",)),
        ("measured = 2027-02-01", date(2030, 1, 1), ()),
        ("measured = 2027-04-01", date(2030, 1, 1), ("before the measurement on 2027-04-01",)),
        ("measured = 2026-02-01", date(2030, 1, 1), ("calibrated on 2026-03-01, after the measurement on 2026-02-01",)),
        ("measured = 2031-01-01", date(2030, 1, 1), ("later than today, 2030-01-01", "due on 2027-03-01, before the")),
    ],
)  # fmt: skip
def test_a_calibration_must_cover_the_measurement(tmp_path, measured, today, said):
    lab = config.load(write(tmp_path, in_lab("[lab]", f"[lab]\n{measured}"))).lab
    found = tuple(lab_warnings(lab, today))
    assert len(found) == len(said)
    assert all(words in sentence for words, sentence in zip(said, found, strict=True))


def test_a_certificate_states_the_calibration_of_its_channel_unless_the_rig_does(tmp_path):
    """U = 0.8 % with k = 2 is 0.4 %; 40 N of 5 kN with k = 2.5 is 0.32 %."""
    share = in_lab('"pressure gauge"', '"p", channel = "Fz", expanded_uncertainty = 0.008')
    force = in_lab('"pressure gauge"', '"p", channel = "Fz", expanded_uncertainty = 40, at = 5000, k = 2.5')
    typed = share.replace("[rig]", "[rig]\nu_Fz_gain = 0.01")
    found = [config.load(write(tmp_path, text)).rig for text in (share, force, typed)]
    assert [rig.u("gain_Fz") for rig in found] == pytest.approx([0.004, 0.0032, 0.01])
    assert {rig.u("gain") for rig in found} == {0.005}


def test_both_tables_survive_resolving(tmp_path):
    import tomli_w

    path = write(
        tmp_path,
        in_lab().replace("[lab]", '[fit]\nexclude = { file = "a.csv", lines = 3, why = "x" }\n[lab]'),
    )
    found = config.load(path)
    folder = tmp_path / "out"
    folder.mkdir()
    (folder / "resolved.toml").write_text(tomli_w.dumps(config.resolved(found, folder)))
    again = config.load(folder / "resolved.toml")
    assert again.lab == found.lab
    assert [(folder / e.file).resolve() for e in again.fit.exclude] == [(tmp_path / "a.csv").resolve()]
