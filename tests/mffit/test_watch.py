"""``mffit watch``: a campaign is played into a folder, look by look, without waiting for any clock."""

from __future__ import annotations

import gzip
import io
import json
import os
import shutil
from collections.abc import Callable, Iterable
from contextlib import suppress
from itertools import count

import numpy as np
import pandas as pd
import pytest
from disc_project import ZEROS, disc_project, rows

import mffit
from mffit.cli import main
from mffit.errors import InputError
from mffit.recordings.constants import LOOK_AT_RECORDINGS, LOOKS_OF_PATIENCE
from mffit.report.text import campaign_text

LONG = int(LOOKS_OF_PATIENCE) + 2
TIMES = count(1)
NOMINAL = [f"{kind}_1500.csv" for kind in ("sideslip", "camber", "forward", "backward")]
"""The sweeps from which eps_gamma is measured."""


class Ended(Exception):
    """The play is over."""


def put(path, content: str | bytes) -> None:
    """Write a file with a time of its own, however coarse the clock of the disk is."""
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    at = next(TIMES)
    os.utime(path, (at, at))


def played(path, steps: Iterable[Callable[[], object] | None], **options):
    """The campaigns while one step is done after every look; None does nothing."""
    left = iter(steps)

    def pause(seconds: float) -> None:
        try:
            step = next(left)
        except StopIteration:
            raise Ended from None
        if step is not None:
            step()

    found = []
    with suppress(Ended):
        for campaign in mffit.watch(path, pause=pause, **options):
            found.append(campaign)
    return found


@pytest.fixture
def rig(tmp_path):
    """A project without its sweeps, and their contents by name."""
    project = disc_project(tmp_path / "rig")
    path = project.write()
    contents = {name: (project.folder / name).read_bytes() for name in project.tables}
    for name in contents:
        (project.folder / name).unlink()
    return path, contents


def test_a_campaign_ends_with_what_spin_and_align_say(rig):
    path, contents = rig
    first, then = list(contents)[:5], list(contents)[5:]
    steps = [None, lambda: [put(path.parent / name, contents[name]) for name in first], None]
    for name in then:
        steps += [lambda n=name: put(path.parent / n, contents[n]), None]
    found = played(path, steps)
    assert [one.file for one in found[1].changed] == first
    assert [one.changed[0].file for one in found[2:]] == then  # one campaign for each file
    assert [one.points for one in found] == np.cumsum([0, 47, 13, 4, 4]).tolist()
    assert len(found[0].awaited) == 8
    assert not found[-1].awaited
    known = mffit.spin(path)
    assert found[-1].epsilon_gamma == known.epsilon_gamma
    assert found[-1].measured.per_load == known.per_load
    assert found[-1].alignment == mffit.align(path)
    assert found[-1].before == found[-2].epsilon_gamma
    step = found[-1].next_run.step
    assert step.before == pytest.approx(known.epsilon_gamma.u)
    assert step.after < 0.95 * step.before
    assert not list(path.parent.glob("out*"))


def test_the_next_run_brings_what_it_promises(rig):
    """The run is made with the toy tyre of these sweeps, and the direct method states the uncertainty again."""
    path, contents = rig
    for name, content in contents.items():
        put(path.parent / name, content)
    (found,) = mffit.watch(path, once=True, pause=lambda seconds: None)
    run, made = found.next_run.step.run, []
    R = 1.0 / -run.points.phi_t[0]
    for way in (1, -1):
        own = run.points.select(run.points.direction == way)
        angles = np.degrees(own.alpha), np.degrees(own.gamma)
        made.append(rows(*angles, own.Fz[0], direction=way, side=-1.323 / R, seed=60 + way))
        put(path.parent / f"next{way}.csv", made[-1].to_csv(index=False))
    side = "left" if R > 0.0 else "right"
    with path.open("a") as file:
        for way, word in ((1, "forward"), (-1, "backward")):
            if len(made[0 if way > 0 else 1]):
                file.write(f'\n[[sweep]]\nfile = "next{way}.csv"\ndirection = "{word}"\n')
                file.write(f'path_centre = "{side}"\npath_radius = {abs(R)}\n')
    assert mffit.spin(path).epsilon_gamma.u == pytest.approx(found.next_run.step.after, rel=0.1)


def test_a_file_that_is_being_written_is_waited_for(rig):
    path, contents = rig
    name = "sideslip_1500.csv"
    file, content = path.parent / name, contents[name]
    parts = [content[:k] for k in (5, 200, 210, 215)]
    found = played(path, [*(lambda part=part: put(file, part) for part in parts), None, None, None])
    assert [one.taken for one in found] == [()]  # it ends within a line, and is not said to be bad
    assert name in found[0].awaited
    found = played(path, [lambda: put(file, content), None, None])
    assert found[-1].taken == (name,)


@pytest.mark.parametrize("ending", [".csv.gz", ".xlsx"])
def test_half_a_packed_file_is_not_read(rig, ending):
    path, contents = rig
    name = f"more{ending}"
    whole = gzip.compress(contents["sideslip_1500.csv"])
    if ending == ".xlsx":
        table = rows(ZEROS, 0.0, 1500.0)
        table.to_excel(path.parent / "made.xlsx", index=False)
        whole = (path.parent / "made.xlsx").read_bytes()
        (path.parent / "made.xlsx").unlink()
    file = path.parent / name
    found = played(path, [lambda: put(file, whole[: len(whole) // 2]), None, None, None])
    assert not any(one.changed for one in found)
    found = played(path, [lambda: put(file, whole), None, None])
    assert found[-1].taken == (name,)


def test_a_bad_file_is_said_once_and_taken_when_it_is_corrected(rig):
    path, contents = rig
    good = {"sideslip_1500.csv", "camber_1500.csv"}
    bad = path.parent / "forward_1500.csv"
    broken = contents[bad.name].replace(b"250.0", b"x", 1)
    for name in good:
        put(path.parent / name, contents[name])
    within = [None] * int(3.0 / LOOK_AT_RECORDINGS - 1)  # looks of three seconds
    found = played(path, [lambda: put(bad, broken), *within, lambda: put(bad, contents[bad.name]), None])
    first, refused, last = found
    assert set(first.taken) == set(refused.taken) == good
    (arrival,) = refused.changed
    assert (arrival.file, arrival.state) == (bad.name, "refused")
    assert f"{bad.name}:2: column p_kPa" in arrival.why
    assert [one.state for one in last.changed] == ["taken"]
    assert refused.refused == (bad.name,)
    assert len({one.headline.split()[2] for one in found}) == 1  # as many files as tyre.toml lists
    assert last.points == 30


def test_a_sweep_against_all_others_is_set_aside_with_the_sentence_of_a_build(rig):
    path, contents = rig
    for name, content in contents.items():
        put(path.parent / name, content)
    wrong = contents["sideslip_1000.csv"].decode().splitlines()
    head = wrong[0].split(",")
    k = head.index("Fy_N")
    turned = [
        ",".join(c if i != k else str(-float(c)) for i, c in enumerate(row.split(","))) for row in wrong[1:]
    ]
    put(path.parent / "sideslip_1000.csv", "\n".join([wrong[0], *turned]) + "\n")
    (found,) = mffit.watch(path, once=True, pause=lambda seconds: None)
    refused = [one for one in found.changed if one.state == "refused"]
    with pytest.raises(InputError) as error:
        mffit.spin(path)
    assert [(one.file, one.why) for one in refused] == [("sideslip_1000.csv", str(error.value))]
    assert found.epsilon_gamma is not None


def leaning(content: bytes) -> bytes:
    """A table whose side force is along the leaning axis of the wheel, as another rig may report it."""
    table = pd.read_csv(io.BytesIO(content))
    gamma = np.radians(table["gamma_deg"])
    force = table["Fy_N"] * np.cos(gamma) + 2.0 * table["Fz_N"] * np.sin(gamma)
    return table.assign(Fy_N=force).to_csv(index=False).encode()


def test_a_foreign_file_for_which_the_rig_is_blamed_is_left_out_and_named(rig):
    path, contents = rig
    names = ["sideslip_1500.csv"]
    head = path.read_text().partition("[[sweep]]")[0]
    path.write_text(head + "".join(f'[[sweep]]\nfile = "{name}"\n' for name in names))
    for name in names:
        put(path.parent / name, contents[name])
    (alone,) = mffit.watch(path, once=True, pause=lambda seconds: None)
    foreign = {"rear.csv": "camber_1000.csv", "rear_again.csv": "camber_1500.csv"}
    for name, origin in foreign.items():
        put(path.parent / name, leaning(contents[origin]))
    put(path.parent / "more.csv", contents["sideslip_1000.csv"])
    (found,) = mffit.watch(path, once=True, pause=lambda seconds: None)
    assert not found.problem
    assert found.taken == (*names, "more.csv")
    assert found.points == alone.points + 13
    states = {one.file: one for one in found.changed}
    assert all(states[name].state == "refused" and not states[name].sweep for name in foreign)

    assert states["more.csv"].sweep
    said = " ".join(campaign_text(found).split())
    assert all(f"not taken: {name}: " in said for name in foreign)
    assert said.count("if it is of another tyre") == len(foreign)


def test_files_that_nobody_listed_are_taken_in_and_shown_as_toml(rig):
    path, contents = rig
    for name, content in contents.items():
        put(path.parent / name, content)
    before = path.read_bytes()
    table = rows(ZEROS, 0.0, 1500.0, direction=-1, seed=77)
    file = path.parent / "again_backward.csv"
    ignored = [path.parent / name for name in ("~$again.xlsx", ".again.csv", "again.csv~", "notes.md")]
    (path.parent / "out").mkdir()

    def arrive():
        put(file, table.to_csv(index=False))
        for one in (*ignored, path.parent / "out" / "points.csv"):
            put(one, "alpha_deg\n")

    found = played(path, [None, arrive, *[None] * LONG])
    assert len(found) == 2
    (arrival,) = found[-1].changed
    assert (arrival.file, arrival.points) == (file.name, 4)
    assert path.read_bytes() == before
    path.write_bytes(before + b"\n" + arrival.sweep.encode())
    assert mffit.spin(path).epsilon_gamma == found[-1].epsilon_gamma


def test_columns_of_listed_sweeps_hold_for_new_files_with_their_headings(rig):
    path, contents = rig
    name = "sideslip_1500.csv"

    def other(content: bytes) -> bytes:
        return content.replace(b"Fy_N", b"side force", 1)

    text = path.read_text().replace(f'"{name}"\n', f'"{name}"\n[sweep.columns]\nFy_N = "side force"\n', 1)
    path.write_text(text)
    put(path.parent / name, other(contents[name]))
    table = rows(ZEROS, 0.0, 1500.0, seed=77).to_csv(index=False).encode()
    found = played(path, [None, lambda: put(path.parent / "new.csv", other(table)), None, None])
    assert 'column = "side force"' in found[-1].changed[0].sweep
    assert found[-1].points == 17


def test_a_replaced_file_is_read_again_as_soon_as_it_rests(rig):
    path, contents = rig
    name = "sideslip_1500.csv"
    put(path.parent / name, contents[name])
    fewer = b"\n".join(contents[name].splitlines()[:-3]) + b"\n"
    found = played(path, [None, lambda: put(path.parent / name, fewer), None])
    assert [(one.points, one.changed[0].state) for one in found] == [(13, "taken"), (10, "taken")]


def test_a_file_that_is_rewritten_badly_is_news_once(rig):
    path, contents = rig
    name = "sideslip_1500.csv"
    put(path.parent / name, contents[name])
    found = played(path, [None, lambda: put(path.parent / name, b"garbage\n1,2\n"), *[None] * 8])
    assert [[(arrival.file, arrival.state) for arrival in one.changed] for one in found] == [
        [(name, "taken")],
        [(name, "refused")],
    ]


def test_files_that_are_gone_leave(rig):
    path, contents = rig
    for name in ("sideslip_1500.csv", "camber_1500.csv"):
        put(path.parent / name, contents[name])
    found = played(path, [None, None, (path.parent / "camber_1500.csv").unlink, None])
    assert [(one.file, one.state) for one in found[-1].changed] == [("camber_1500.csv", "gone")]
    assert found[-1].points == 13


def test_tyre_toml_is_read_again_and_its_last_state_kept_while_it_is_wrong(rig):
    path, contents = rig
    for name in NOMINAL:
        put(path.parent / name, contents[name])
    text = path.read_text()
    steps = [
        None,
        lambda: put(path, text + "\n[rigg]\n"),
        None,
        None,
        lambda: put(path, text.replace("u_effective_radius = 0.0005", "u_effective_radius = 0.02")),
        None,
    ]
    assert len(played(path, steps[:2])) == 2  # said at the look after it
    path.write_text(text)
    first, wrong, last = played(path, steps)
    assert "rigg" in wrong.problem
    assert wrong.epsilon_gamma == first.epsilon_gamma
    assert not last.problem
    assert last.epsilon_gamma.u > first.epsilon_gamma.u


def test_recordings_are_taken_with_the_last_correct_tyre_toml_while_it_is_wrong(rig):
    path, contents = rig
    names = ["sideslip_1500.csv", "camber_1500.csv", "forward_1500.csv"]
    put(path.parent / names[0], contents[names[0]])
    text = path.read_text()
    steps = [None, lambda: put(path, text + "\n[rigg]\n"), None]
    for name in names[1:]:
        steps += [lambda n=name: put(path.parent / n, contents[n]), None]
    found = played(path, steps)
    assert [one.points for one in found] == [13, 13, 26, 30]
    assert all("rigg" in one.problem for one in found[1:])
    assert [[(one.file, one.state) for one in campaign.changed] for campaign in found[2:]] == [
        [(name, "taken")] for name in names[1:]
    ]
    put(path, text)
    (right,) = mffit.watch(path, once=True, pause=lambda seconds: None)
    assert found[-1].epsilon_gamma == right.epsilon_gamma


def test_a_pattern_finds_files_as_they_come(rig):
    path, contents = rig
    head = path.read_text().partition("[[sweep]]")[0]
    path.write_text(head + '[[sweep]]\nfile = "sideslip_*.csv"\n')
    put_one = [
        lambda n=n: put(path.parent / n, contents[n]) for n in ("sideslip_1500.csv", "sideslip_1000.csv")
    ]
    found = played(path, [None, put_one[0], None, None, put_one[1], None])
    assert found[0].awaited == ("sideslip_*.csv",)
    assert found[-1].taken == ("sideslip_1000.csv", "sideslip_1500.csv")
    assert not any(one.sweep for campaign in found for one in campaign.changed)


def test_warnings_are_given_once(rig):
    path, contents = rig
    names = ["sideslip_1500.csv", "camber_1500.csv", "forward_1500.csv"]
    steps = [None]
    for name in names:
        steps += [lambda n=name: put(path.parent / n, contents[n]), None]
    found = played(path, steps)
    assert sum("no backward runs" in sentence for one in found for sentence in one.warnings) == 1


def test_a_straight_path_has_stiffness_and_a_plan_for_the_file(rig):
    path, contents = rig
    text = path.read_text()
    head = text.partition("[rig]")[0] + '[rig]\ntype = "flat-track"\n'
    names = ["sideslip_1000.csv", "sideslip_1500.csv"]
    path.write_text(head + "".join(f'[[sweep]]\nfile = "{name}"\n' for name in names))
    for name in names:
        put(path.parent / name, contents[name])
    (found,) = mffit.watch(path, once=True, pause=lambda seconds: None)
    assert found.epsilon_gamma is None
    assert found.measured.per_load[0].C_alpha is not None
    assert found.next_run.goal.kind == "file"


def test_the_command_prints_a_block_or_a_line_of_json_and_ends_well(rig, capsys, monkeypatch):
    path, contents = rig
    for name, content in contents.items():
        put(path.parent / name, content)
    main(["watch", str(path), "--once", "--json"])
    (line,) = capsys.readouterr().out.splitlines()
    document = json.loads(line)
    assert document["epsilon_gamma"] == mffit.spin(path).epsilon_gamma.value
    assert document["points"] == 68
    assert document["next"]["u_after"] < document["next"]["u_before"]

    looks = iter([None, None])

    def interrupted(seconds: float) -> None:
        if next(looks, "end") == "end":
            raise KeyboardInterrupt

    monkeypatch.setattr("mffit.pipeline.watching.time.sleep", interrupted)
    main(["watch", str(path)])  # ends as a command that is done
    text = capsys.readouterr().out
    assert text.count("8 of 8 files, 68 points") == 2  # the block, and the summary at the end
    assert "next run:" in text
    assert "alignment" not in text or "nan" not in text


def test_a_wrong_project_is_refused_at_the_start(tmp_path, capsys):
    with pytest.raises(SystemExit) as ended:
        main(["watch", str(tmp_path / "none.toml")])
    assert ended.value.code == 2
    assert "none.toml" in capsys.readouterr().err
    shutil.rmtree(tmp_path)
