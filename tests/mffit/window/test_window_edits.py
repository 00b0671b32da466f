"""Changes of tyre.toml: what they write, and that they keep everything else byte for byte."""

from __future__ import annotations

import os
import random
import re
import threading
import time
import tomllib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mffit.config.lines import line_ranges
from mffit.errors import InputError
from mffit.window.edits import EDITS, coefficient, leave_out, setting, take_back
from mffit.window.session import ChangedElsewhere, ProjectFile
from mffit.window.settings import settings

ROOT = Path(__file__).parents[3]
LEFT_OUT = 'exclude = [ { file = "sideslip_1400.csv", lines = "4", why = "belt tracking" } ]  # by Anna'

TEXT = """# the front tyre
[tyre]
name   = "a"      # aligned by hand

[coefficients]   # the engineer's hand
PCY1 = 1.3       # from the last tyre
PEY1 = { min = -3.0, max = 0.5, start = -0.5 } # bounds

[fit]
exclude = [ { file = "a.csv", lines = "39-44", why = "belt tracking" } ]  # by Anna

[[sweep]]
file = "a.csv"
"""


def reading(file: str, first: int, last: int | None = None) -> dict[str, object]:
    return {"file": file, "lines": f"{first}" if last is None else f"{first}-{last}"}


def changed_lines(before: str, after: str) -> tuple[set[str], set[str]]:
    """Lines that are only in the old, and only in the new text."""
    a, b = before.splitlines(keepends=True), after.splitlines(keepends=True)
    return {line for line in a if line not in b}, {line for line in b if line not in a}


def test_holding_changes_one_line_and_keeps_its_comment():
    found = coefficient(TEXT, name="PCY1", entry=1.35)
    assert changed_lines(TEXT, found) == (
        {"PCY1 = 1.3       # from the last tyre\n"},
        {"PCY1 = 1.35       # from the last tyre\n"},
    )


def test_a_new_coefficient_is_added_to_the_table():
    found = coefficient(TEXT, name="PKY1", entry=-15.0)
    assert changed_lines(TEXT, found) == (set(), {"PKY1 = -15.0\n"})
    assert tomllib.loads(found)["coefficients"]["PKY1"] == -15.0


@pytest.mark.parametrize("name", ["PCY1", "PEY1", "PKY1", "PDY1"])
@pytest.mark.parametrize(
    "entry",
    [{"min": 1.0}, {"value": -0.3, "u": 0.1, "max": 0.5}, {"start": 2.0, "min": 1.0}, {}],
    ids=",".join,
)
def test_limits_replace_the_entry_and_keep_every_comment(name, entry):
    """A number, a table on one line, a table of its own, and none at all."""
    text = TEXT + "\n[coefficients.PKY1]  # from the report\nstart = -20.0  # a guess\n"
    found = coefficient(text, name=name, entry=entry)
    before, after = tomllib.loads(text), tomllib.loads(found)
    assert after["coefficients"].pop(name, {}) == entry
    before["coefficients"].pop(name, None)
    assert after == before
    if entry:
        assert [
            c
            for c in ("the engineer's hand", "from the last tyre", "# bounds", "from the report", "by Anna")
            if c not in found
        ] == []


def test_an_unknown_key_of_limits_is_refused():
    with pytest.raises(InputError, match='"least" is not a key'):
        coefficient(TEXT, name="PCY1", entry={"least": 1.0})


def test_freeing_removes_the_line_and_nothing_else():
    found = coefficient(TEXT, name="PCY1", entry=None)
    assert changed_lines(TEXT, found) == ({"PCY1 = 1.3       # from the last tyre\n"}, set())
    assert coefficient(TEXT, name="PKY1", entry=None) == TEXT


def test_tables_are_added_where_there_are_none():
    bare = '[tyre]\nname = "a"\n\n[[sweep]]\nfile = "a.csv"'
    found = leave_out(coefficient(bare, name="PCY1", entry=1.0), readings=[reading("a.csv", 7)], why="a jump")
    assert found.startswith(bare)
    content = tomllib.loads(found)
    assert content["coefficients"] == {"PCY1": 1.0}
    assert content["fit"]["exclude"] == [{"file": "a.csv", "lines": "7", "why": "a jump"}]
    assert content["sweep"] == [{"file": "a.csv"}]


def test_readings_of_one_reason_are_one_entry():
    found = leave_out(TEXT, readings=[reading("a.csv", 45), reading("a.csv", 60, 62)], why="belt tracking")
    assert tomllib.loads(found)["fit"]["exclude"] == [
        {"file": "a.csv", "lines": "39-45, 60-62", "why": "belt tracking"}
    ]
    assert "# by Anna" in found
    found = leave_out(TEXT, readings=[reading("a.csv", 44, 46)], why="a jump")
    assert [entry["lines"] for entry in tomllib.loads(found)["fit"]["exclude"]] == ["39-44", "45-46"]


def test_readings_are_taken_back():
    assert (
        tomllib.loads(take_back(TEXT, readings=[reading("a.csv", 41)]))["fit"]["exclude"][0]["lines"]
        == "39-40, 42-44"
    )
    assert "fit" not in tomllib.loads(take_back(TEXT, readings=[reading("a.csv", 30, 50)]))
    assert take_back(TEXT, readings=[reading("b.csv", 41)]) == TEXT


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_what_is_taken_back_leaves_the_file_as_it_was(end):
    text = TEXT.partition("[coefficients]")[0].replace("\n", end)
    out = leave_out(text, readings=[reading("b.csv", 9)], why="y")
    assert take_back(out, readings=[reading("b.csv", 9)]) == text
    held = coefficient(out, name="PKY1", entry=-15.0)
    freed = coefficient(held, name="PKY1", entry=None)
    assert freed == out + end  # a blank line at most, however often
    assert coefficient(coefficient(freed, name="PKY1", entry=-15.0), name="PKY1", entry=None) == freed
    described = out.replace("[fit]", "[fit]  # by Anna")
    assert "[fit]  # by Anna" in take_back(described, readings=[reading("b.csv", 9)])


def test_an_array_of_tables_is_extended():
    text = '[tyre]\nname = "a"\n\n[[fit.exclude]]\nfile = "a.csv"\nlines = 3\nwhy = "x"\n'
    found = leave_out(text, readings=[reading("b.csv", 9)], why="y")
    assert tomllib.loads(found)["fit"]["exclude"] == [
        {"file": "a.csv", "lines": 3, "why": "x"},
        {"file": "b.csv", "lines": "9", "why": "y"},
    ]


def test_line_ends_stay_as_they_are():
    found = leave_out(TEXT.replace("\n", "\r\n"), readings=[reading("b.csv", 1)], why="x")
    found = coefficient(found, name="PKY1", entry=-15.0)
    assert "\n" not in found.replace("\r\n", "")


@given(st.lists(st.tuples(st.booleans(), st.integers(1, 30), st.integers(0, 5)), max_size=8))
def test_lines_are_left_out_as_a_set(steps):
    """Any sequence of leaving out and taking back ends with the lines of the set operations."""
    text, wanted = '[[sweep]]\nfile = "a.csv"\n', set()
    for out, first, more in steps:
        lines = set(range(first, first + more + 1))
        if out:
            wanted |= lines
            text = leave_out(text, readings=[reading("a.csv", first, first + more)], why=f"{first % 3}")
        else:
            wanted -= lines
            text = take_back(text, readings=[reading("a.csv", first, first + more)])
    entries = tomllib.loads(text).get("fit", {}).get("exclude", [])
    found = [n for entry in entries for a, b in line_ranges(entry["lines"]) for n in range(a, b + 1)]
    assert sorted(found) == sorted(wanted)  # each line once


def test_thousands_of_readings_are_left_out_and_taken_back_one_by_one(tyre_toml):
    """As a selection of every other reading has them; the number of comparisons is that of the ranges, not its square."""
    every_other = ", ".join(str(line) for line in range(2, 60_000, 2))
    found = leave_out(TEXT, readings=[{"file": "b.csv", "lines": every_other}], why="x")
    assert tomllib.loads(found)["fit"]["exclude"][-1]["lines"] == every_other
    half = ", ".join(str(line) for line in range(2, 60_000, 4))
    rest = tomllib.loads(take_back(found, readings=[{"file": "b.csv", "lines": half}]))["fit"]["exclude"][-1]
    assert rest["lines"] == ", ".join(str(line) for line in range(4, 60_000, 4))


def test_every_other_of_many_entries_is_taken_back_and_the_comments_of_the_others_stay():
    entries = [f'{{ file = "b.csv", lines = "{line}", why = "{line}" }}' for line in range(2, 402)]
    text = (
        "[fit]\nexclude = [\n" + "".join(f"    {one},  # of {k}\n" for k, one in enumerate(entries)) + "]\n"
    )
    gone = ", ".join(str(line) for line in range(2, 402, 2))
    found = take_back(text, readings=[{"file": "b.csv", "lines": gone}])
    assert [one["lines"] for one in tomllib.loads(found)["fit"]["exclude"]] == [
        str(k) for k in range(3, 402, 2)
    ]
    assert all(f"# of {k}\n" in found for k in range(1, 400, 2))
    assert leave_out(found, readings=[reading("b.csv", 3)], why="again") == found
    bare = take_back(re.sub("  # .*", "", text), readings=[{"file": "b.csv", "lines": gone}])
    assert bare == re.sub("  # .*", "", found)  # without comments the list is written anew


def test_readings_without_a_line_are_refused():
    with pytest.raises(InputError, match="file and lines"):
        leave_out(TEXT, readings=[{"file": "a.csv"}], why="x")


def test_an_edit_is_saved_and_undone_byte_for_byte(tyre_toml):
    file, before = ProjectFile(tyre_toml), tyre_toml.read_bytes()
    beside = set(tyre_toml.parent.iterdir())
    file.edit(lambda text: coefficient(text, name="PCY1", entry=1.35), file.digest)
    file.edit(lambda text: coefficient(text, name="PCY1", entry=None), file.digest)
    assert file.config().coefficients == {}
    file.undo()
    assert file.config().coefficients["PCY1"].held == 1.35
    file.undo()
    assert tyre_toml.read_bytes() == before
    assert not file.can_undo
    assert set(tyre_toml.parent.iterdir()) == beside


def test_a_change_that_the_program_would_refuse_is_not_written(tyre_toml):
    file, before = ProjectFile(tyre_toml), tyre_toml.read_bytes()
    with pytest.raises(InputError, match="lies beyond the bounds"):
        file.edit(lambda text: coefficient(text, name="PCY1", entry={"min": 99.0}), file.digest)
    with pytest.raises(InputError, match="is not the file of"):
        file.edit(lambda text: leave_out(text, readings=[reading("no.csv", 2)], why="x"), file.digest)
    with pytest.raises(InputError, match="why"):
        file.edit(lambda text: leave_out(text, readings=[reading("camber_900.csv", 2)], why=" "), file.digest)
    assert tyre_toml.read_bytes() == before
    assert not file.can_undo


def test_changes_of_others_are_neither_overwritten_nor_undone(tyre_toml):
    file = ProjectFile(tyre_toml)
    seen = file.digest
    file.edit(lambda text: coefficient(text, name="PCY1", entry=1.35), seen)
    with pytest.raises(InputError, match="changed elsewhere"):
        file.edit(lambda text: coefficient(text, name="PCY1", entry=None), seen)
    mine = tyre_toml.read_text(encoding="utf-8") + "# my own words\n"
    tyre_toml.write_text(mine, encoding="utf-8")
    with pytest.raises(InputError, match="no change of this window"):
        file.undo()
    assert tyre_toml.read_text(encoding="utf-8") == mine


def test_thirty_of_thirty_saves_of_another_program_are_kept(tyre_toml):
    """At any time while a click is saved; a click that was too late is refused with both versions."""
    file, draw, before = ProjectFile(tyre_toml), random.Random(31), tyre_toml.read_bytes()
    begun, seen = time.perf_counter(), file.digest
    file.edit(lambda text: coefficient(text, name="PCY1", entry=1.31), seen)
    duration, refused = time.perf_counter() - begun, []
    for k in range(30):
        tyre_toml.write_bytes(before)
        seen, theirs, other = file.digest, before + b"# theirs %d\n" % k, tyre_toml.with_name("other")

        def save(
            content: bytes = theirs, wait: float = draw.uniform(0.0, duration), to: Path = other
        ) -> None:
            time.sleep(wait)
            to.write_bytes(content)
            os.replace(to, tyre_toml)

        thread = threading.Thread(target=save)
        thread.start()
        try:
            file.edit(lambda text: coefficient(text, name="PCY1", entry=1.32), seen)
        except ChangedElsewhere as error:
            refused.append(error.versions)
        thread.join()
        assert tyre_toml.read_bytes() == theirs
    for both in refused:
        assert "+# theirs" in both["theirs"]
        assert "+PCY1 = 1.32" in both["mine"]


def test_both_versions_are_shown(tyre_toml):
    file, seen = ProjectFile(tyre_toml), ProjectFile(tyre_toml).digest
    assert file.digest == seen  # shown in a window
    tyre_toml.write_bytes(tyre_toml.read_bytes() + b"# theirs\n")
    with pytest.raises(ChangedElsewhere) as error:
        file.edit(lambda text: coefficient(text, name="PCY1", entry=1.32), seen)
    assert [line for line in error.value.versions["theirs"].splitlines() if line[0] == "+"] == ["+# theirs"]
    mine = [line for line in error.value.versions["mine"].splitlines() if line[0] == "+"]
    assert "+PCY1 = 1.32" in mine
    assert "+# theirs" not in mine


def test_a_link_is_read_and_saved_beside_its_own_files(tyre_toml):
    """The file that it leads to lies in another folder, where no recording is."""
    away = tyre_toml.parent.parent / "away.toml"
    tyre_toml.rename(away)
    tyre_toml.symlink_to(away)
    file = ProjectFile(tyre_toml)
    file.edit(lambda text: coefficient(text, name="PCY1", entry=1.35), file.digest)
    assert tyre_toml.is_symlink()
    assert b"PCY1 = 1.35" in away.read_bytes()
    assert file.config().folder == tyre_toml.parent
    file.undo()
    assert b"PCY1 = 1.35" not in away.read_bytes()


def test_a_mark_of_the_encoding_stays(tyre_toml):
    tyre_toml.write_bytes(b"\xef\xbb\xbf" + tyre_toml.read_bytes())
    file = ProjectFile(tyre_toml)
    file.edit(lambda text: coefficient(text, name="PCY1", entry=1.35), file.digest)
    assert tyre_toml.read_bytes().startswith(b"\xef\xbb\xbf#")


def test_every_setting_is_offered_and_saved(tyre_toml):
    """Its default, written down, means the same; the keys are those of the documentation."""
    file = ProjectFile(tyre_toml)
    whole, documented = file.config(), (ROOT / "docs" / "configuration.md").read_text(encoding="utf-8")
    listed = settings(file.tables())
    assert {one["table"] for one in listed} >= {"tyre", "rig", "fit", "normal", "spin", "sweep"}
    text = tyre_toml.read_text(encoding="utf-8")
    for one in listed:
        for key in one["keys"]:
            assert f"`{key['key']}`" in documented
            if key["default"] in ("", "required") or key["value"] or key["key"] == "u_path_radius":
                continue
            text = setting(text, table=one["table"], file=one["file"], key=key["key"], value=key["default"])
    tyre_toml.write_text(text, encoding="utf-8")
    given = [key for one in settings(file.tables()) for key in one["keys"] if key["value"]]
    assert len(given) > 50
    assert file.config().model_dump() == whole.model_dump()
    assert LEFT_OUT in text


def test_another_name_of_a_choice_is_shown():
    _, rig, *_ = settings({"rig": {"axes": "calspan"}})
    (axes,) = [key for key in rig["keys"] if key["key"] == "axes"]
    assert (axes["value"], axes["choices"][-1]) == ('"calspan"', '"calspan"')


@pytest.mark.parametrize(
    ("given", "line"),
    [
        ({"table": "tyre", "key": "size", "value": "120/70 ZR17"}, 'size = "120/70 ZR17"'),
        ({"table": "tyre", "key": "size", "value": '"17"'}, 'size = "17"'),
        ({"table": "normal", "key": "weight", "value": '"road"'}, 'weight = "road"'),
        ({"table": "fit", "key": "wear", "value": "true"}, "wear = true"),
        ({"table": "lab", "key": "measured", "value": "2026-03-01"}, "measured = 2026-03-01"),
        (
            {"table": "rig", "key": "u_Fx_offset_N", "value": "{ value = 20.0, dof = 5 }"},
            "u_Fx_offset_N = { value = 20.0, dof = 5 }",
        ),
        ({"table": "sweep", "file": "camber_900.csv", "key": "setup", "value": "second"}, 'setup = "second"'),
    ],
)
def test_a_setting_is_one_line(tyre_toml, given, line):
    before = tyre_toml.read_text(encoding="utf-8")
    after = setting(before, **given)
    gone, new = changed_lines(before, after)
    assert gone == set()
    assert {one.strip() for one in new if one.strip() and one[0] != "["} == {line}
    file = ProjectFile(tyre_toml)
    file.edit(lambda text: setting(text, **given), file.digest)
    assert (
        setting(after, **{**given, "value": ""}).replace("[normal]", "").replace("[lab]", "").split()
        == before.split()
    )


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"table": "coefficients", "key": "PCY1", "value": "1"}, "no settings here"),
        ({"table": "normal", "key": "weight", "value": '"rode"'}, "weight"),
        ({"table": "normal", "key": "wait", "value": "1"}, "did you mean"),
        ({"table": "tyre", "key": "width", "value": "1\nbase = 'x'"}, "is no value"),
        ({"table": "tyre", "key": "width", "value": "[1"}, "is no value"),
        ({"table": "tyre", "key": "nominal_load", "value": ""}, "missing"),
        ({"table": "sweep", "file": "none.csv", "key": "setup", "value": "b"}, "load this page again"),
    ],
)
def test_a_setting_that_a_build_would_refuse_is_not_saved(tyre_toml, given, sentence):
    file, before = ProjectFile(tyre_toml), tyre_toml.read_bytes()
    with pytest.raises(InputError, match=sentence):
        file.edit(lambda text: setting(text, **given), file.digest)
    assert tyre_toml.read_bytes() == before


def test_every_edit_is_known_by_its_name():
    assert {edit.__name__: edit for edit in EDITS.values()} == dict(EDITS)
