"""A user's own file is saved over: what belongs to it stays, and what another program saves is never lost."""

from __future__ import annotations

import errno
import io
import os
import threading
from pathlib import Path

import pytest

from mffit import output
from mffit.errors import InputError
from mffit.output import ChangedMeanwhile, save_over

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


def test_what_others_put_in_its_place_at_the_last_moment_stays(path, monkeypatch):
    """Between comparison and replacement."""
    written, theirs = output._write_over, b"theirs = 1\n"

    def late(*given):
        other = path.with_name("other")
        other.write_bytes(theirs)
        os.replace(other, path)
        written(*given)

    monkeypatch.setattr(output, "_write_over", late)
    with pytest.raises(ChangedMeanwhile) as error:
        save_over(path, OLD, NEW)
    assert error.value.now == path.read_bytes() == theirs
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


@posix
def test_a_folder_that_takes_no_file_needs_none(path):
    path.parent.chmod(0o555)
    try:
        save_over(path, OLD, NEW)
    finally:
        path.parent.chmod(0o755)
    assert path.read_bytes() == NEW


@pytest.mark.parametrize(
    ("number", "remedy"), [(errno.ENOSPC, "free some space"), (errno.EROFS, "check the permissions")]
)
def test_a_disk_that_takes_nothing_is_told_as_it_is(path, monkeypatch, number, remedy):
    def refuse(*given):
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(output, "_write_over", refuse)
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


class Watched(io.BytesIO):
    """A file that notes what it holds before it is cut off."""

    def truncate(self, size: int | None = None) -> int:
        self.before_the_cut = self.getvalue()
        return super().truncate(size)


def test_what_is_too_long_is_blank_until_it_is_cut_off():
    """Another program may read the file at any time."""
    file = Watched(OLD)
    output._write_over(file, OLD, NEW)
    assert file.getvalue() == NEW
    assert file.before_the_cut.rstrip(b"\n") == NEW.rstrip(b"\n")


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
