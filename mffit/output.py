"""Output folders that are written completely or not at all, and never over files that mffit did not write."""

from __future__ import annotations

import contextlib
import ctypes
import errno
import hashlib
import io
import json
import os
import platform
import re
import shutil
import sys
import tempfile
import time
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from typing import NamedTuple

from mffit.errors import InputError

RECORD = ".mffit.json"
"""The record: the files that mffit wrote to a folder, each with its SHA-256 and the command."""

ABOUT = "Written by mffit: it replaces the files listed here, while they are unchanged, and no others."

DISK_FULL = frozenset({errno.ENOSPC, errno.EROFS, errno.EDQUOT, errno.EFBIG})
"""Errors of a full or read-only disk."""

ELSEWHERE = "name another folder with --out"


class OutputEntry(NamedTuple):
    """A written file in the record; ``by:sha256`` in JSON."""

    by: str  #: the command that wrote it
    sha256: tuple[str, ...]  #: two while a run replaces the file: that of the old one and that of the new one


@contextmanager
def output_folder(
    out: Path, *, by: str = "mffit", protected: Iterable[Path] = (), outdated: Collection[str] = ()
) -> Iterator[Path]:
    """A temporary folder beside ``out`` whose files move to ``out`` only if the block succeeds.

    ``by`` is the command that writes; only files of the same command are ever removed. ``protected`` are files that the run
    reads, ``outdated`` names of files that would be mistaken for this run's output if an earlier run left them.

    A file in ``out`` is replaced only if an earlier run wrote it and it is unchanged since (by the record), or if the new
    content is the same. A file that the run reads is never replaced by other content. Files that the run does not write stay.
    In folders within ``out`` (``plots``), files that an earlier run of the same command wrote, and this one does not, are
    removed if they are unchanged.

    An interrupted or failed run leaves ``out`` unchanged. A killed run leaves its temporary folder, whose name has machine and
    process; the next run to the same place removes it. If the run was killed while its finished files were moving, the record
    knows the old and the new files, and the next run may replace both.

    Raises InputError if ``out`` cannot be written to, or a file there may not be replaced; ``out`` is then unchanged.
    """
    temporary = _temporary_folder(out)
    try:
        yield temporary
        _publish(temporary, out, by, protected, outdated)
    except OSError as error:
        if error.errno not in DISK_FULL:
            raise
        raise InputError(
            f"cannot be written to ({error.strerror}); free some space or {ELSEWHERE}", file=out
        ) from error
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def _temporary_folder(out: Path) -> Path:
    """A new folder beside ``out``; folders that killed runs left are removed."""
    parent = out.absolute().parent
    refuse_unusable(out)
    try:
        parent.mkdir(parents=True, exist_ok=True)
        _remove_litter(out.absolute())
        return Path(tempfile.mkdtemp(prefix=f"{_prefix(out.name)}{os.getpid()}-", dir=parent))
    except OSError as error:
        raise InputError(f"cannot be written to ({error.strerror}); {ELSEWHERE}", file=parent) from error


def _publish(
    temporary: Path, out: Path, by: str, protected: Iterable[Path], outdated: Collection[str]
) -> None:
    """Move the finished files to their places, or raise and leave the output as it was."""
    written, recorded = _digests(temporary), _recorded(out)
    _refuse(out, written, recorded, protected)
    stale = _stale(out, by, written, recorded, outdated)
    kept = {name: entry for name, entry in recorded.items() if name not in stale and (out / name).is_file()}
    new = {name: OutputEntry(by, (sha256,)) for name, sha256 in written.items()}
    both = {
        name: OutputEntry(by, (*entry.sha256, *(kept[name].sha256 if name in kept else ())))
        for name, entry in new.items()
    }
    try:
        out.mkdir(exist_ok=True)
        _record(temporary, out, recorded | both)
        for name in written:
            (out / name).parent.mkdir(exist_ok=True)
            os.replace(temporary / name, out / name)
        for name in stale:
            (out / name).unlink(missing_ok=True)
        _record(temporary, out, kept | new)
    except OSError as error:
        raise InputError(
            f"cannot be written to ({error.strerror}: {error.filename}); close the program that uses it or {ELSEWHERE}",
            file=out,
        ) from error


def _record(temporary: Path, out: Path, entries: Mapping[str, OutputEntry]) -> None:
    """Replace the record of a folder."""
    files = {name: ":".join((entry.by, *entry.sha256)) for name, entry in sorted(entries.items())}
    text = json.dumps({"about": ABOUT, "files": files}, indent=2, ensure_ascii=False) + "\n"
    (temporary / RECORD).write_text(text, encoding="utf-8")
    os.replace(temporary / RECORD, out / RECORD)


def refuse_unusable(out: Path, *, is_file: bool = False) -> None:
    """Raise before any work if an output folder, or a file, cannot be written; nothing is left behind.

    Raises InputError if a file is in the place of a folder, or a folder in that of the file, or nothing can be written there.
    """
    if is_file and out.is_dir():
        raise InputError("is a folder, but the output is a file; name a file with --out", file=out)
    folder = out.absolute().parent if is_file else out.absolute()
    nearest = next(path for path in (folder, *folder.parents) if os.path.lexists(path))
    if not nearest.is_dir():
        where = "" if nearest == out.absolute() else f"cannot be written to: {nearest} "
        raise InputError(f"{where}is a file, but the output needs a folder; {ELSEWHERE}", file=out)
    # The temporary folder of the run is beside the output folder.
    for place in {nearest, nearest if is_file or nearest != folder else folder.parent}:
        try:
            os.rmdir(tempfile.mkdtemp(prefix=f"{_prefix(out.name)}{os.getpid()}-", dir=place))
        except OSError as error:
            raise InputError(f"cannot be written to ({error.strerror}); {ELSEWHERE}", file=place) from error


def refuse_early(out: Path, names: Collection[str], protected: Iterable[Path] = ()) -> None:
    """Raise before the work, if the names of the files are known, what :func:`output_folder` would raise after it.

    Raises InputError if ``out`` cannot be written to, or has a file of one of the names that may not be replaced.
    """
    refuse_unusable(out)
    if out.is_dir():
        _refuse(out, dict.fromkeys(names, ""), _recorded(out), protected)


def written_by(out: Path, by: str) -> frozenset[str]:
    """Files of ``out`` that the command ``by`` wrote and that are unchanged; empty without a record."""
    try:
        recorded = _recorded(out)
        return frozenset(
            name for name, entry in recorded.items() if entry.by == by and _is_unchanged(out, name, entry)
        )
    except (InputError, OSError):
        return frozenset()


def digest(path: Path) -> str:
    """SHA-256 of a file, in hex."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _digests(folder: Path) -> dict[str, str]:
    """SHA-256 of every file in a folder, by its relative name."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): digest(path) for path in files}


def _is_unchanged(out: Path, name: str, entry: OutputEntry) -> bool:
    return (out / name).is_file() and digest(out / name) in entry.sha256


def _refuse(
    out: Path, written: Mapping[str, str], recorded: Mapping[str, OutputEntry], protected: Iterable[Path]
) -> None:
    """Raise if a file of ``written`` would replace one that must stay."""
    inputs = [path for path in protected if path.exists()]
    for name, new in written.items():
        target = out / name
        for folder in list(target.parents)[: len(PurePosixPath(name).parents) - 1]:
            if folder.exists() and not folder.is_dir():
                raise InputError(
                    f"is a file, but the output needs a folder of this name; move it away or {ELSEWHERE}",
                    file=folder,
                )
        if not os.path.lexists(target):
            continue
        if not target.is_file():
            raise InputError(
                f"is not a file, but the output writes a file of this name; move it away or {ELSEWHERE}",
                file=target,
            )
        reason = _reason_to_keep(target, new, recorded.get(name), inputs)
        if reason:
            raise InputError(reason, file=target)


def _reason_to_keep(target: Path, new: str, entry: OutputEntry | None, inputs: Iterable[Path]) -> str:
    """Why a file must not be replaced by one of the SHA-256 ``new``; "" if it may."""
    old = digest(target)
    if old == new:
        return ""
    if any(os.path.samefile(target, path) for path in inputs):
        return f"is an input of this run, and the output would replace it; {ELSEWHERE}"
    if entry is None:
        return (
            f"would be replaced, but no run of mffit is known to have written it; move it away or {ELSEWHERE}"
        )
    if old not in entry.sha256:
        return f"would be replaced, but it was changed since mffit wrote it; move it away or {ELSEWHERE}"
    return ""


def _stale(
    out: Path,
    by: str,
    written: Mapping[str, str],
    recorded: Mapping[str, OutputEntry],
    outdated: Collection[str],
) -> list[str]:
    """Unchanged files of an earlier run of this command that this run did not write again.

    All in the folders that this run wrote to; outside them only those called ``outdated``.
    """
    folders = {PurePosixPath(name).parent for name in written} - {PurePosixPath(".")}
    return [
        name
        for name, entry in recorded.items()
        if name not in written
        and (PurePosixPath(name).parent in folders or name in outdated)
        and entry.by == by
        and _is_unchanged(out, name, entry)
    ]


def _recorded(out: Path) -> dict[str, OutputEntry]:
    """Files that earlier runs wrote, by name relative to ``out``; a file called RECORD that is not a record is refused."""
    path = out / RECORD
    try:
        files = json.loads(path.read_text(encoding="utf-8"))["files"]
        parts = {name: text.split(":") for name, text in files.items()}
        return {name: OutputEntry(by, tuple(sha256)) for name, (by, *sha256) in parts.items()}
    except FileNotFoundError:
        return {}
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        raise InputError(
            "is not the record of written files that mffit keeps under this name; move it away", file=path
        ) from None


def _prefix(name: str) -> str:
    machine = re.sub(r"[^A-Za-z0-9]", "_", platform.node()) or "here"
    return f".{name}-{machine}-"


def _remove_litter(out: Path) -> None:
    """Remove temporary folders of ended processes of this machine."""
    prefix = _prefix(out.name)
    for path in out.parent.iterdir():
        found = re.fullmatch(r"(\d+)-\w{8}", path.name.removeprefix(prefix))
        if path.name.startswith(prefix) and found and path.is_dir() and not _alive(int(found[1])):
            shutil.rmtree(path, ignore_errors=True)


def _alive(pid: int) -> bool:
    """Whether the process runs; always true on Windows, where a signal to ask would end it."""
    if sys.platform == "win32":
        return True
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except (PermissionError, OverflowError):
        return True
    return True


def must_be_new(folder: Path, names: Iterable[str]) -> None:
    """Raise if the folder has a file of one of the names."""
    for name in names:
        if (folder / name).exists():
            raise InputError("is there already; move it away or name another folder", file=folder / name)


def new_files(folder: Path, contents: Mapping[str, str | bytes]) -> list[Path]:
    """Paths of new files of a folder, written with the given contents.

    Raises InputError if one of the files is there already, or the folder cannot be written to.
    """
    must_be_new(folder, contents)
    is_new = not folder.exists()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, content in contents.items():
            (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)
    except (FileExistsError, NotADirectoryError):
        raise InputError("is a file; name a folder", file=folder) from None
    except OSError as error:
        for name in contents:
            (folder / name).unlink(missing_ok=True)
        if is_new and folder.is_dir():
            folder.rmdir()
        raise InputError(
            f"cannot be written to ({error.strerror}); name another folder", file=folder
        ) from None
    return [folder / name for name in contents]


class ChangedMeanwhile(Exception):
    """A file has no longer the content that was to be replaced; ``now`` is the one it has."""

    def __init__(self, now: bytes) -> None:
        super().__init__()
        self.now = now


def save_over(path: Path, before: bytes, after: bytes) -> None:
    """Replace the content ``before`` of a user's own file in one step.

    A link stays one; permissions, owner and extended attributes stay. Where a new file could not have them, or the old one has
    other names (hard links), or the folder takes no new file, the old one is written over: not in one step if it is longer than
    a page of memory (4 kB), but :func:`finish_save` ends what a kill divides, unless the folder takes no file.

    Raises
    ------
    ChangedMeanwhile
        The file has another content, and keeps it. It is compared at the replacement, where no other process of mffit saves.
    InputError
        The file cannot be written.
    """
    try:
        path = path.resolve(strict=True)
        with _alone(path.parent), _new_like(path, after) as new:
            with path.open("r+b", buffering=0) as old:  # refuses a file that the user may not write
                if (now := old.read()) != before:
                    raise ChangedMeanwhile(now)
                if new is None:
                    with _journal(path, before, after):
                        _write_over(old, before, after)
            if new is not None:
                _put(new, path, before, after)
    except OSError as error:
        is_full = error.errno in DISK_FULL - {errno.EROFS}
        remedy = "free some space" if is_full else "check the permissions of file and folder"
        raise InputError(f"cannot be written ({error.strerror}); {remedy}", file=path) from None


def _write_over(old: io.FileIO, before: bytes, after: bytes) -> None:
    # In one call, which a kill divides between pages at most; what is too long is blank until it is cut off.
    longer = after.ljust(len(before), b"\n")
    if old.seek(0) + old.write(longer) < len(longer):
        old.seek(0)
        old.truncate(old.write(before))
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    old.truncate(len(after))


def finish_save(path: Path) -> None:
    """End a :func:`save_over` that a kill has divided, if the file holds the parts of both contents and nothing else."""
    path = path.resolve()
    journal = _journal_of(path)
    try:
        if sys.platform != "win32" and journal.lstat().st_uid != os.geteuid():
            return  # of another user, who may not say what is written here
        head, _, both = journal.read_bytes().partition(b"\n")
        with _alone(path.parent), path.open("r+b", buffering=0) as old:
            lengths, now = [int(n) for n in head.split()], old.read()
            before, after = both[: lengths[0]], both[lengths[0] :]
            longer = after.ljust(len(before), b"\n")
            ends = min(len(now), len(longer))
            same = next((k for k in range(ends) if now[k] != longer[k]), ends)
            if len(both) == sum(lengths) and now != before and now[same:] == before[same:]:
                _write_over(old, now, after)
        journal.unlink()
    except (OSError, ValueError, IndexError):
        return  # there is none, or it was not complete before anything was written


@contextmanager
def _journal(path: Path, before: bytes, after: bytes) -> Iterator[None]:
    """Within this block both contents of a file lie beside it, if its folder takes files, for :func:`finish_save`."""
    journal, ours = _journal_of(path), False
    try:
        with contextlib.suppress(PermissionError, FileExistsError), journal.open("xb") as stream:
            ours = True
            stream.write(b"%d %d\n%b%b" % (len(before), len(after), before, after))
        yield
    finally:
        if ours:
            journal.unlink(missing_ok=True)


def _journal_of(path: Path) -> Path:
    return path.with_name(f".{path.name}.saving")


def _put(new: str, path: Path, before: bytes, after: bytes) -> None:
    """Put a new file in the place of another; where the two can be exchanged, what comes out is compared once more."""
    expected, placed = before, after
    while _exchanged(new, path):
        came_out = Path(new).read_bytes()
        if came_out == expected:
            if placed != after:
                raise ChangedMeanwhile(placed)
            return
        expected, placed = placed, came_out  # saved by another program since: it goes back
    os.replace(new, path)


def _exchanged(new: str, path: Path) -> bool:
    """Whether two files exchanged their names in one step, which not every system can do."""
    names = [os.fsencode(name) for name in (new, path)]
    try:
        libc = ctypes.CDLL(None)
        if sys.platform == "linux":
            here, exchange = -100, 2
            return bool(libc.renameat2(here, names[0], here, names[1], exchange) == 0)
        return sys.platform == "darwin" and bool(libc.renamex_np(*names, 2) == 0)
    except (AttributeError, OSError, TypeError):
        return False


@contextmanager
def _new_like(path: Path, content: bytes) -> Iterator[str | None]:
    """A complete file beside ``path`` that may take its place; None if it cannot have its owner or all its names."""
    old, new, whole = path.stat(), "", False
    try:
        if old.st_nlink == 1:
            with contextlib.suppress(PermissionError):
                handle, new = tempfile.mkstemp(prefix=f".{path.name}-", dir=path.parent)
                with os.fdopen(handle, "wb") as stream:
                    stream.write(content)
                if sys.platform != "win32":
                    os.chown(new, old.st_uid, old.st_gid)
                shutil.copystat(path, new)
                os.utime(new)
                whole = True
        yield new if whole else None
    finally:
        if new:
            Path(new).unlink(missing_ok=True)


@contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Within this block, no other process of mffit is in its block for the same folder; no file is left there."""
    if sys.platform == "win32":
        import msvcrt

        name = f"mffit-{hashlib.sha256(os.fsencode(folder)).hexdigest()}.lock"
        with (Path(tempfile.gettempdir()) / name).open("wb") as lock:
            msvcrt.locking(lock.fileno(), msvcrt.LK_LOCK, 1)
            yield
        return
    import fcntl

    handle = os.open(folder, os.O_RDONLY)
    try:
        for _ in range(100):  # another user could hold it for ever; the comparison of contents is left then
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except OSError:  # held, or a network folder that knows no locks
                time.sleep(0.01)
        yield
    finally:
        os.close(handle)
