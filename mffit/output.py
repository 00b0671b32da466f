"""Output folders that are written completely or not at all, and never over files that mffit did not write."""

from __future__ import annotations

import contextlib
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
BEYOND_ANY_END = 1 << 30
"""Place of the lock of a file [bytes]."""


class OutputEntry(NamedTuple):
    """A written file in the record; ``by:sha256`` in JSON."""

    by: str  #: the command that wrote it
    sha256: tuple[str, ...]  #: two while a run replaces the file: that of the old one and that of the new one


@contextmanager
def output_folder(
    out: Path, *, by: str = "mffit", protected: Iterable[Path] = (), outdated: Collection[str] = ()
) -> Iterator[Path]:
    """A temporary folder next to ``out`` whose files move to ``out`` only if the block succeeds.

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
    """A new folder next to ``out``; folders that killed runs left are removed."""
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
    files = sorted(path for path in temporary.rglob("*") if path.is_file())
    written = {path.relative_to(temporary).as_posix(): digest(path) for path in files}
    recorded = _recorded(out)
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
    # The temporary folder of the run is next to the output folder.
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
    """Raise if the folder has something of one of the names."""
    for name in names:
        if os.path.lexists(folder / name):
            raise InputError(
                "is there already; move it away, or choose another name or folder", file=folder / name
            )


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
    """Write a user's own file anew where it lies, so that its links, owner, permissions and attributes stay.

    Windows of mffit save one after the other. Where the disk does not take the new content, the old one stays.

    Raises
    ------
    ChangedMeanwhile
        The file has another content than ``before``, and keeps it: it is compared just before it is written, and a file that
        another program puts in its place meanwhile stays.
    InputError
        The file cannot be written.
    """
    try:
        with path.open("r+b", buffering=0) as file:
            _lock(file.fileno())
            file.seek(0)
            if (now := file.read()) != before:
                raise ChangedMeanwhile(now)
            _write_over(file, before, after)
            if not os.path.samestat(os.fstat(file.fileno()), path.stat()):
                raise ChangedMeanwhile(path.read_bytes())
    except OSError as error:
        is_full = error.errno in DISK_FULL - {errno.EROFS}
        remedy = "free some space" if is_full else "check the permissions of file and folder"
        raise InputError(f"cannot be written ({error.strerror}); {remedy}", file=path) from None


def _write_over(file: io.FileIO, before: bytes, after: bytes) -> None:
    """Write in one call; what is too long is blank until it is cut off."""
    longer = after.ljust(len(before), b"\n")
    if file.seek(0) + file.write(longer) < len(longer):
        file.seek(0)
        file.truncate(file.write(before))
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    file.truncate(len(after))


def _lock(handle: int) -> None:
    """Wait until no other process of mffit writes the open file; it is free again when it is closed."""
    if sys.platform == "win32":
        import msvcrt

        os.lseek(handle, BEYOND_ANY_END, os.SEEK_SET)  # others may not read what is locked
        msvcrt.locking(handle, msvcrt.LK_LOCK, 1)
        return
    import fcntl

    with contextlib.suppress(OSError):  # a network folder that knows no locks
        fcntl.flock(handle, fcntl.LOCK_EX)
