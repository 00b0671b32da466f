"""A user's own file is saved over: what belongs to it stays, and what another program saves is never lost."""

from __future__ import annotations

import errno
import os
import sys
import threading
from pathlib import Path

import pytest

from mffit import output
from mffit.errors import InputError
from mffit.output import ChangedMeanwhile, finish_save, save_over

posix = pytest.mark.skipif(os.name == "nt", reason="owners and modes of POSIX")
OLD, NEW = b"a = 1\nb = 2  # both\n", b"a = 3\n"


@pytest.fixture
def path(tmp_path: Path) -> Path:
    found = tmp_path / "tyre.toml"
    found.write_bytes(OLD)
    return found


@pytest.mark.parametrize("names", [1, 2])
def test_another_content_stays(path, names):
    if names == 2:
        os.link(path, path.parent.parent / f"{path.parent.name}-hard.toml")
    with pytest.raises(ChangedMeanwhile) as error:
        save_over(path, NEW, OLD + NEW)
    assert (error.value.now, path.read_bytes()) == (OLD, OLD)
    save_over(path, OLD, NEW)
    assert path.read_bytes() == NEW
    assert os.listdir(path.parent) == ["tyre.toml"]


@pytest.mark.skipif(sys.platform not in ("linux", "darwin"), reason="files are not exchanged here")
@pytest.mark.parametrize("saves", [1, 2, 3])
def test_the_newest_of_others_stays_if_they_save_at_the_last_moment(path, monkeypatch, saves):
    """Between comparison and replacement, and again while theirs is put back."""
    exchanged, theirs = output._exchanged, [b"theirs = %d\n" % k for k in range(saves)]
    left = iter(theirs)

    def late(new: str, where: Path) -> bool:
        if (content := next(left, None)) is not None:
            other = where.with_name("other")
            other.write_bytes(content)
            os.replace(other, where)
        return exchanged(new, where)

    monkeypatch.setattr(output, "_exchanged", late)
    with pytest.raises(ChangedMeanwhile) as error:
        save_over(path, OLD, NEW)
    assert error.value.now == path.read_bytes() == theirs[-1]
    assert os.listdir(path.parent) == ["tyre.toml"]


@posix
def test_what_belongs_to_the_file_stays(path):
    (path.parent / "sub").mkdir()
    link = path.parent / "sub" / "link.toml"
    link.symlink_to(path)
    path.chmod(0o640)
    if os.geteuid() == 0:
        os.chown(path, 1234, 2345)
    try:
        os.setxattr(path, "user.why", b"by Anna")
        attributes = {"user.why": b"by Anna"}
    except (OSError, AttributeError):  # this file system has none
        attributes = {}
    before = path.stat()
    save_over(link, OLD, NEW)
    after = path.stat()
    assert link.is_symlink()
    assert path.read_bytes() == NEW
    assert (after.st_mode, after.st_uid, after.st_gid) == (before.st_mode, before.st_uid, before.st_gid)
    assert {name: os.getxattr(path, name) for name in attributes} == attributes
    assert after.st_mtime_ns > before.st_mtime_ns


@pytest.mark.parametrize("new", [NEW, OLD + NEW])
def test_all_names_of_a_file_see_the_new_content(path, new):
    other = path.with_name("hard.toml")
    os.link(path, other)
    save_over(path, OLD, new)
    assert other.read_bytes() == path.read_bytes() == new
    assert path.samefile(other)


def _refusing(number: int):
    def refuse(*given, **more):
        raise OSError(number, os.strerror(number))

    return refuse


def test_a_folder_that_takes_no_file_needs_none(path, monkeypatch):
    monkeypatch.setattr("tempfile.mkstemp", _refusing(errno.EACCES))
    save_over(path, OLD, NEW)
    assert path.read_bytes() == NEW


@pytest.mark.parametrize(
    ("number", "remedy"), [(errno.ENOSPC, "free some space"), (errno.EROFS, "check the permissions")]
)
def test_a_disk_that_takes_nothing_is_told_as_it_is(path, monkeypatch, number, remedy):
    monkeypatch.setattr("tempfile.mkstemp", _refusing(number))
    with pytest.raises(InputError, match=remedy):
        save_over(path, OLD, NEW)
    assert path.read_bytes() == OLD


@posix
def test_a_full_disk_leaves_the_old_content(tmp_path):
    """A small file system of its own would need root; a file size limit refuses in the same place."""
    import resource
    import signal

    path = tmp_path / "tyre.toml"
    before, after = b"a\n" * 2000, b"b\n" * 4000
    path.write_bytes(before)
    os.link(path, tmp_path / "hard.toml")
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    old = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (6000, limits[1]))
    try:
        with pytest.raises(InputError, match="free some space"):
            save_over(path, before, after)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        signal.signal(signal.SIGXFSZ, old)
    assert path.read_bytes() == before


@posix
@pytest.mark.parametrize(("long", "short"), [(9000, 5000), (5000, 9000), (9000, 9000)])
@pytest.mark.parametrize("written", [0, 4096, 8192, 9000])
def test_a_file_that_a_kill_divided_is_whole_when_it_is_opened_again(path, monkeypatch, long, short, written):
    before, after = b"a" * long, b"b" * short
    path.write_bytes(before)
    os.link(path, path.with_name("hard.toml"))

    def killed(old, before, after):
        old.seek(0)
        old.write(after.ljust(len(before), b"\n")[:written])
        os._exit(9)

    monkeypatch.setattr(output, "_write_over", killed)
    if not (child := os.fork()):
        save_over(path, before, after)
    os.waitpid(child, 0)
    monkeypatch.undo()
    theirs = b"theirs" + path.read_bytes()[6:-1]
    if written == 9000:  # saved by another program since
        path.write_bytes(theirs)
    finish_save(path)
    assert path.read_bytes() == {0: before, 9000: theirs}.get(written, after)
    assert sorted(os.listdir(path.parent)) == ["hard.toml", "tyre.toml"]


def test_windows_at_work_on_one_file_lose_no_save(path):
    """Each adds its lines to what it has read; whoever was too late reads again."""
    path.write_bytes(b"")

    def work(name: int) -> None:
        for k in range(25):
            while True:
                before = path.read_bytes()
                try:
                    save_over(path, before, before + b"%d %d\n" % (name, k))
                    break
                except ChangedMeanwhile:
                    continue

    threads = [threading.Thread(target=work, args=(name,)) for name in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    lines = path.read_bytes().split(b"\n")[:-1]
    assert sorted(lines) == sorted(b"%d %d" % (name, k) for name in range(4) for k in range(25))
