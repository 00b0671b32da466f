"""The server of a window: what it answers, to whom, and what it refuses to serve."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable
from multiprocessing import Pipe
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from inside import client_of

from mffit.errors import InputError
from mffit.window.app import Opened, within
from mffit.window.runs import RunOutcome, _work, carry_out, out_of
from mffit.window.session import Session


@pytest.fixture
def client(session: Session) -> Any:
    with client_of(Opened(session)) as found:
        yield found


def post(client: Any, address: str, **content: Any) -> Any:
    return client.post(f"{client.home}{address}", content=json.dumps(content))


def edit(client: Any, session: Session, do: str, /, **given: Any) -> Any:
    return post(client, "edit", **{"do": do, "seen": session.file.digest, "with": given})


def test_pages_and_data_travel_compressed(client):
    for address in ("", "project"):
        answer = client.get(f"{client.home}{address}")
        assert answer.headers["content-encoding"] == "gzip"
        assert int(answer.headers["content-length"]) < 0.8 * len(answer.content)


def test_the_values_of_a_file_are_told_in_si(client, result, tmp_path):
    text = result.fit.tyre.text().replace("'newton'", "'kilonewton'")
    values = post(client, "values", name="other.tir", text=text).json()["values"]
    assert values["FNOMIN"] == pytest.approx(1e3 * result.fit.tyre["FNOMIN"])
    assert values["PCY1"] == pytest.approx(result.fit.tyre["PCY1"])
    refused = post(client, "values", name="other.tir", text="no tyre")
    assert refused.status_code == 422
    assert refused.json()["error"].startswith("other.tir")


@pytest.mark.parametrize(
    ("path", "headers"),
    [
        ("/wrong-home/state", {}),
        ("//", {}),
        ("/", {}),
        ("*", {}),
        ("/enter/", {}),
        ("{home}", {"host": "tyres.example:8123"}),  # a name that another site lets point to this machine
        ("{home}", {"host": "127.0.0.1:9999"}),
        ("{home}state", {"origin": "http://tyres.example"}),
        ("{home}state", {"origin": "null"}),  # a sandboxed page, such as a report
        ("{home}state", {"sec-fetch-site": "cross-site"}),
        (
            "{home}",
            {"sec-fetch-site": "cross-site", "sec-fetch-mode": "navigate", "sec-fetch-dest": "iframe"},
        ),
    ],
)
def test_others_are_refused(session, path, headers):
    """Also without an origin, which a browser does not send when it opens a page."""
    client = client_of(Opened(session), headers={})
    assert client.get(f"{client.home}state").status_code == 200
    for method in ("GET", "OPTIONS"):
        answer = client.request(method, path.format(home=client.home), headers=headers)
        assert answer.status_code == 403
        assert "coefficients" not in answer.text


def test_the_address_of_the_page_is_no_key(session):
    """Whoever reads it over a shoulder or in a history; nor is a wrong cookie."""
    client = client_of(Opened(session), has_cookie=False)
    for cookie in ("", "mffit=", "mffit=x", client.entrance.secret, f"other={client.entrance.secret}"):
        assert client.get(f"{client.home}state", headers={"cookie": cookie}).status_code == 403
    assert client.post(f"{client.home}undo").status_code == 403


def test_an_address_lets_one_browser_in(session):
    client = client_of(Opened(session), has_cookie=False)
    address = client.entrance.new_address()
    for refused in ({"host": "tyres.example"}, {"sec-fetch-site": "cross-site", "sec-fetch-dest": "image"}):
        assert client.get(address, headers=refused).status_code == 403
    assert client.head(address).status_code == 403  # a look that opens nothing leaves the address
    answer = client.get(address)
    assert answer.status_code == 200
    cookie = answer.headers["set-cookie"]
    assert cookie.endswith(f"; Path={client.home}; HttpOnly; SameSite=Strict")
    assert client.home in answer.text
    assert address not in answer.text
    assert client.get(client.home).status_code == 200  # the client keeps cookies as a browser does
    again = client_of(Opened(session), has_cookie=False)
    assert again.get(address).status_code == 403
    assert client.get(address).status_code == 403


def test_a_change_needs_an_origin(client, session):
    before = session.file.path.read_bytes()
    for origin in ({"origin": "http://tyres.example"}, {"origin": ""}):
        assert client.post(f"{client.home}undo", headers=origin).status_code == 403
    without = client_of(Opened(session), headers={})
    assert without.post(f"{without.home}undo").status_code == 403
    assert session.file.path.read_bytes() == before


def test_a_link_from_elsewhere_opens_the_page(client):
    """From a terminal within a browser, for example."""
    headers = {"sec-fetch-site": "cross-site", "sec-fetch-mode": "navigate", "sec-fetch-dest": "document"}
    answer = client.get(client.entrance.new_address(), headers=headers)
    assert answer.status_code == 200
    assert answer.headers["x-frame-options"] == "DENY"
    assert answer.headers["referrer-policy"] == "no-referrer"


def test_no_process_shows_how_to_get_in(tyre_toml, tmp_path):
    """A stand-in for the browser notes with what it is started; the address is in a file that only this user reads."""
    noted, home = tmp_path / "noted", tmp_path / "home"
    browser = tmp_path / "browser"
    browser.write_text(f'#!/bin/sh\necho "$@" > {noted}\n')
    browser.chmod(0o755)
    surroundings = {**os.environ, "HOME": str(home), "XDG_CONFIG_HOME": str(home), "BROWSER": f"{browser} %s"}
    command = [sys.executable, "-m", "mffit", "open", str(tyre_toml)]
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=surroundings
    )
    try:
        printed = process.stdout.readline().split()[-1]
        until(lambda: noted.exists() and noted.read_text(), 30.0)
        page = Path(noted.read_text().strip().removeprefix("file://"))
        assert (page.stat().st_mode & 0o777, page.parent.stat().st_mode & 0o777) == (0o600, 0o700)
        (address,) = re.findall(r"url=(http://127\.0\.0\.1:\d+/enter/[\w-]+)", page.read_text())
        assert address != printed
        with urllib.request.urlopen(address) as answer:
            assert "mffit=" in answer.headers["set-cookie"]
        with urllib.request.urlopen(printed) as answer:
            assert "mffit=" in answer.headers["set-cookie"]
        process.stdout.readline()
        assert "another browser: http" in process.stdout.readline()
    finally:
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=30)
    assert not page.exists()


def test_the_page_asks_nobody_else(client):
    page = client.get(f"{client.home}").text
    assert "default-src 'none'" in page
    assert [word for word in ("http://", "https://", " src=", "@import") if word in page] == []


def test_the_data_are_those_of_the_build(client, result):
    found = client.get(f"{client.home}project").json()
    assert {row["name"]: row["rmse"] for row in found["channels"] if row["of_fit"]} == {
        name: row.rmse for name, row in result.fit.channels.items() if row.n
    }
    values = {row["name"]: (row["value"], row["stderr"]) for row in found["coefficients"]}
    assert values["PCY1"] == (result.tyre["PCY1"], result.fit.coefficients["PCY1"].stderr)
    assert found["points"]["fitted"] == len(result.points)
    assert found["exclude"] == [{"file": "sideslip_1400.csv", "lines": "4", "why": "belt tracking"}]


def test_a_click_changes_its_line_of_the_file_and_no_other_file(client, session):
    before = {path.name: path.read_bytes() for path in session.file.path.parent.iterdir()}
    answer = edit(client, session, "coefficient", name="PCY1", entry=1.35).json()
    assert answer["state"]["hand"] == {"PCY1": 1.35}
    assert not answer["state"]["is_fitted"]
    after = {path.name: path.read_bytes() for path in session.file.path.parent.iterdir()}
    assert {name for name in after if after[name] != before.get(name)} == {"tyre.toml"}
    assert after["tyre.toml"].startswith(before["tyre.toml"])
    assert post(client, "undo").json()["state"]["is_fitted"]
    assert session.file.path.read_bytes() == before["tyre.toml"]


@pytest.mark.parametrize(
    ("name", "given", "sentence"),
    [
        ("coefficient", {"name": "PCY1", "entry": {"min": 99.0}}, "lies beyond the bounds"),
        ("coefficient", {"name": "PCY9", "entry": 1.0}, "not a coefficient"),
        ("coefficient", {"nam": "PCY1"}, "cannot be done with"),
        ("coefficient", {"name": "PCY1", "entry": {"min": 1.6, "max": 1.2}}, "1.6 is not below max, 1.2"),
        ("coefficient", {"name": "PCY1", "entry": {"min": "1.6"}}, "is a text, not a number"),
        ("__import__", {}, "not a change"),
        ("coefficient", {"name": ["PCY1"], "entry": 1.0}, "cannot be done with"),
        ("leave_out", {"readings": [{"file": "a", "lines": "5-2"}], "why": "x"}, "ends before it begins"),
        (
            "leave_out",
            {"readings": [{"file": "a", "lines": 1e400}], "why": "x"},
            "not a line or a range of lines",
        ),
        ("coefficient", {"name": "PCY1", "entry": 10**400}, "more digits than a number can have"),
        (
            "leave_out",
            {"readings": [{"file": "camber_900.csv", "lines": f"2-{10**400}"}], "why": "x"},
            "beyond the end of any file",
        ),
        (
            "leave_out",
            {"readings": [{"file": "camber_900.csv", "lines": f"2-{10**11}"}], "why": "x"},
            "beyond the end of the file; the readings of camber_900.csv are in lines 2-",
        ),
        (
            "leave_out",
            {"readings": [{"file": "camber_900.csv", "lines": "2"}], "why": "\ud800"},
            "cannot hold a character",
        ),
        (
            "leave_out",
            {"readings": [{"file": "../secret.csv", "lines": "1"}], "why": "x"},
            "not the file",
        ),
    ],
)
def test_what_is_not_possible_is_refused_with_a_sentence(client, session, name, given, sentence):
    before = session.file.path.read_bytes()
    answer = edit(client, session, name, **given)
    assert answer.status_code == 422
    assert sentence in answer.json()["error"]
    assert session.file.path.read_bytes() == before


@pytest.mark.parametrize(
    ("body", "sentence"),
    [
        *((body, "a change needs do, seen and with") for body in (b"", b"no json", b"[]")),
        (b'{"a":' + b"[" * 200_000, "a change needs do, seen and with"),
        (b"{" + b" " * 2_000_000 + b"}", "a change has at most 1 MB; make it in parts"),
    ],
)
def test_a_request_that_is_no_change_is_refused(client, session, body, sentence):
    before = session.file.path.read_bytes()
    answer = client.post(f"{client.home}edit", content=body)
    assert (answer.status_code, answer.json()["error"]) == (422, sentence)
    assert session.file.path.read_bytes() == before


@pytest.mark.parametrize(
    ("key", "name", "sentence"),
    [
        ("base", "nothere.tir", "nothere.tir does not exist"),
        ("base", "camber_900.csv", "camber_900.csv"),
        ("priors", "nothere.json", "there is no file"),
    ],
)
def test_a_file_that_a_build_refuses_is_not_named_in_tyre_toml(client, session, key, name, sentence):
    before = session.file.path.read_bytes()
    answer = edit(client, session, "setting", table="tyre", key=key, value=f'"{name}"')
    assert answer.status_code == 422
    assert sentence in answer.json()["error"]
    assert session.file.path.read_bytes() == before


@pytest.mark.parametrize(
    ("table", "key", "value", "sentence"),
    [
        ("rig", "axes", '"sae"', "rises with gamma_deg"),
        ("fit", "sense", '"lag"', "asks for the lag"),
        ("fit", "temperature", "true", "asks for the tyre temperature"),
    ],
)
def test_a_setting_that_the_readings_contradict_is_not_saved(client, session, table, key, value, sentence):
    before = session.file.path.read_bytes()
    answer = edit(client, session, "setting", table=table, key=key, value=value)
    assert (answer.status_code, answer.json()["key"]) == (422, f"{table}.{key}")
    assert sentence in answer.json()["error"]
    assert session.file.path.read_bytes() == before


def test_two_wrong_settings_can_be_corrected_one_after_the_other(client, session):
    path = session.file.path
    right = path.read_text(encoding="utf-8")
    assert "[fit]\n" in right
    wrong = right.replace("[rig]\n", '[rig]\naxes = "sae"\n').replace(
        "[fit]\n", "[fit]\ntemperature = true\n"
    )
    path.write_text(wrong, encoding="utf-8")
    for table, key in (("rig", "axes"), ("fit", "temperature")):
        assert edit(client, session, "setting", table=table, key=key, value="").status_code == 200
    assert path.read_text(encoding="utf-8") == right


def test_a_project_that_a_build_refuses_already_can_be_changed(client, session):
    path = session.file.path
    named = re.sub("base = .*", "base = 'nothere.tir'", path.read_text())
    path.write_text(named)
    assert "nothere" in named
    assert edit(client, session, "coefficient", name="PCY1", entry=1.35).status_code == 200
    assert edit(client, session, "setting", table="tyre", key="base", value="").status_code == 200


def test_a_comment_or_an_empty_table_is_no_difference_from_the_fit(session):
    text = session.file.path.read_text(encoding="utf-8")
    session.file.path.write_text(f"# seen by Anna\n{text}\n[model]\n", encoding="utf-8")
    assert session.state()["is_fitted"]
    session.file.path.write_text(f"{text}\n[coefficients]\nPCY1 = 1.3\n", encoding="utf-8")
    assert not session.state()["is_fitted"]


@pytest.mark.parametrize("change", ["replaced", "replaced by one of its time", "gone"])
def test_curves_of_other_readings_are_not_those_of_a_build(session, change):
    assert session.state()["is_fitted"]
    recording = session.file.path.parent / "camber_900.csv"
    content = recording.read_bytes()
    if change == "gone":
        recording.unlink()
    else:
        time = recording.stat().st_mtime_ns
        recording.write_bytes(content.replace(b"0", b"1", 1))
        if change.endswith("time"):
            os.utime(recording, ns=(time, time))
    state = session.state()
    assert not state["is_fitted"]
    assert state["differs"] == ["camber_900.csv (gone)" if change == "gone" else "camber_900.csv"]
    recording.write_bytes(content)
    assert session.state()["is_fitted"]


def test_a_recording_that_cannot_be_used_is_named_and_not_offered(tyre_toml):
    folder = tyre_toml.parent
    table = pd.read_csv(folder / "camber_900.csv")
    table.assign(Fy_N=-table["Fy_N"]).to_csv(folder / "rear.csv", index=False)
    again = pd.read_csv(folder / "sideslip_900.csv")
    again.assign(Fy_N=again["Fy_N"] + np.resize([3.0, -4.0, 1.0], len(again))).to_csv(
        folder / "again.csv", index=False
    )
    found = carry_out("watch", tyre_toml, lambda sentence: None)
    assert found["unlisted"] == ["again.csv"]
    assert [line for line in found["lines"] if line.startswith("not taken: ") and "rear.csv" in line]


def test_two_windows_do_not_overwrite_each_other(client, session):
    seen = session.file.digest
    assert edit(client, session, "coefficient", name="PCY1", entry=1.35).status_code == 200
    answer = post(
        client, "edit", **{"do": "coefficient", "seen": seen, "with": {"name": "PCY1", "entry": 1.2}}
    )
    assert answer.status_code == 422
    assert "changed elsewhere" in answer.json()["error"]
    assert answer.json()["state"]["hand"] == {"PCY1": 1.35}


def test_a_file_that_somebody_broke_is_said_and_left_alone(client, session):
    session.file.path.write_text("[tyre\n", encoding="utf-8")
    state = client.get(f"{client.home}state").json()
    assert "not valid TOML" in state["problem"]
    assert edit(client, session, "coefficient", name="PCY1", entry=1.35).status_code == 422
    assert client.get(f"{client.home}").status_code == 200
    assert session.file.path.read_text(encoding="utf-8") == "[tyre\n"


def test_only_results_are_served(client, session, tmp_path):
    out = out_of(session.file.path)
    (out / "plots").mkdir(parents=True)
    (out / "report.html").write_text("<p>the report</p>", encoding="utf-8")
    (out / "plots" / "Fy.png").write_bytes(b"png")
    (out / "small.tir").write_text("[UNITS]\n", encoding="utf-8")
    (out / ".mffit.json").write_text("{}", encoding="utf-8")
    (tmp_path / "secret.html").write_text("secret", encoding="utf-8")
    (out / "link.html").symlink_to(tmp_path / "secret.html")
    (out / "run.sh").write_text("echo", encoding="utf-8")
    report = client.get(f"{client.home}out/report.html")
    assert report.text == "<p>the report</p>"
    assert report.headers["content-security-policy"].startswith("sandbox allow-scripts")
    assert "allow-same-origin" not in report.headers["content-security-policy"]
    assert client.get(f"{client.home}out/plots/Fy.png").status_code == 200
    for name in (
        "link.html",
        "run.sh",
        "plots",
        "none.html",
        "../tyre.toml",
        "%2e%2e/tyre.toml",
        "/etc/passwd",
    ):
        assert client.get(f"{client.home}out/{name}").status_code == 404, name
    assert within(out, "../tyre.toml") is None
    state = client.get(f"{client.home}state").json()
    (report,) = [page for page in state["pages"] if page["run"] == "build"]
    assert (report["href"], report["files"]) == ("out/report.html", ["small.tir"])
    assert client.get(f"{client.home}out/small.tir").text == "[UNITS]\n"


def until(true: Callable[[], bool], seconds: float = 600.0) -> None:
    end = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < end, "not in time"
        time.sleep(0.05)


def test_a_run_can_be_stopped_and_leaves_nothing(client, session):
    files = sorted(path.name for path in session.file.path.parent.iterdir())
    assert post(client, "run/build").status_code == 200
    assert "under way" in post(client, "run/fit").json()["error"]
    assert post(client, "stop").status_code == 200
    until(lambda: session.state()["run"] is None)
    assert session.state()["last"]["state"] == "stopped"
    assert session.fits == 1
    assert sorted(path.name for path in session.file.path.parent.iterdir()) == files


def test_a_run_on_a_wrong_project_ends_with_its_sentence(tyre_toml):
    text = tyre_toml.read_text(encoding="utf-8")
    tyre_toml.write_text(text.replace("sideslip_1400.csv", "gone.csv"), encoding="utf-8")
    receiver, sender = Pipe(duplex=False)
    _work("fit", tyre_toml, sender)
    sent = []
    while receiver.poll():
        sent.append(receiver.recv())
    kind, outcome = sent[-1]
    assert (kind, outcome.state) == ("outcome", "refused")
    assert "gone.csv" in outcome.sentence


def test_a_new_recording_is_news_until_tyre_toml_lists_it(session):
    session._news = {"lines": ["2 new"], "unlisted": ["new.csv", "sideslip_900.csv"]}
    assert session.state()["news"] == {"lines": ["2 new"], "unlisted": ["new.csv"]}


def test_a_refusal_of_a_run_is_shown_until_tyre_toml_or_a_recording_changes(session):
    session.last = RunOutcome("refused", 'there is no file "gone.csv"')
    session._ended_with = session.file.digest, session._there()
    assert session.state()["last"]["sentence"] == session.last.sentence
    (session.file.path.parent / "gone.csv").write_text("alpha_deg\n1\n", encoding="utf-8")
    assert session.state()["last"] is None


def test_a_comparison_with_the_base_file_is_offered_once_there_is_a_build(session):
    config = session.file.config()
    config = config.model_copy(update={"tyre": config.tyre.model_copy(update={"base": "base.tir"})})
    out = session.file.path.parent / "out"
    offered = []
    for _ in range(2):
        offered.append("compare" in [page["run"] for page in session._pages(config)])
        out.mkdir(exist_ok=True)
        (out / "result.json").touch()
    assert offered == [False, True]


def test_an_unknown_run_is_refused(client):
    assert "not something to run" in post(client, "run/rm").json()["error"]


def test_events_bring_the_state_at_once(session):
    """The stream ends when the server is about to."""
    with client_of(Opened(session), closing=iter([False, True]).__next__) as client:
        text = client.get(f"{client.home}events").text
    assert re.match(r'data: \{"digest": "\w{64}"', text)


def test_a_folder_that_is_not_there_is_said(tmp_path):
    from mffit.window import open_path

    with pytest.raises(InputError, match="does not exist"):
        open_path([tmp_path / "none"], opened=print)
