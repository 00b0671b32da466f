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
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from typing import NamedTuple

from mffit.errors import InputError

RECORD = ".mffit.json"
"""The record: the files that mffit wrote to a folder, each with its SHA-256 and the command."""

ABOUT = "Written by mffit: it replaces the files listed here, while they are unchanged, and no others."

DISK_FULL = frozenset({errno.ENOSPC, errno.EROFS, errno.EDQUOT, errno.EFBIG})
"""Errors of a full or read-only disk."""

BUILT = "result.json"
"""A file that every build writes."""
ELSEWHERE = "name another folder with --out"
BEYOND_ANY_END = 1 << 30
"""Place of the lock of a file [bytes]."""


def folder_of_build(folder: str | Path) -> Path:
    """The folder of a build; of a project's folder, ``out`` in it, where a build writes if no other is named."""
    folder = Path(folder)
    inside = folder / "out"
    return inside if (inside / BUILT).is_file() and not (folder / BUILT).exists() else folder


class OutputEntry(NamedTuple):
    """A written file in the record; ``by:sha256`` in JSON."""

    by: str  #: the command that wrote it
    sha256: tuple[str, ...]  #: two while a run replaces the file: that of the old one and that of the new one


class Project(NamedTuple):
    """The project whose results a folder holds."""

    name: str  #: of its tyre
    file: str = ""  #: its ``tyre.toml``, in a record relative to the folder; "" for content without a file

    def seen_from(self, folder: Path) -> Project:
        """The same project with its file relative to a folder."""
        return self._replace(file=seen_from(folder, Path(self.file)) if self.file else "")

    def is_other(self, recorded: Project, folder: Path) -> bool:
        """Whether a folder's record is of another project; one whose file was moved or renamed is known by its tyre."""
        if not recorded.name or (self.file and self.file == recorded.file):
            return False
        both = self.file and recorded.file and (folder / recorded.file).is_file()
        return bool(both) or self.name != recorded.name


UNKNOWN = Project("")
"""The project of a folder without a record of one."""


class _Record(NamedTuple):
    """What a folder's record holds."""

    files: Mapping[str, OutputEntry]  #: by name relative to the folder
    project: Project = UNKNOWN


@contextmanager
def output_folder(
    out: Path,
    *,
    by: str = "mffit",
    of: Project = UNKNOWN,
    protected: Iterable[Path] = (),
) -> Iterator[Path]:
    """A temporary folder next to ``out`` whose files move to ``out`` only if the block succeeds.

    ``by`` is the command that writes; only files of the same command are ever removed. ``protected`` are files that the run
    reads.

    A file in ``out`` is replaced only if an earlier run wrote it and it is unchanged since (by the record), or if the new
    content is the same. A file that the run reads is never replaced by other content, nor removed.

    A folder holds the results of one project: with ``of``, the folder of another one is refused, and unchanged files that an
    earlier run of the command wrote, and this one does not, are removed. Without ``of`` they are removed only from the folders
    within ``out`` that the run writes to. All other files stay.

    An interrupted or failed run leaves ``out`` unchanged. A killed run leaves its temporary folder, whose name has machine and
    process; the next run to the same place removes it. If the run was killed while its finished files were moving, the record
    knows the old and the new files, and the next run may replace both.

    Raises InputError if ``out`` cannot be written to, or a file there may not be replaced; ``out`` is then unchanged.
    """
    temporary = _temporary_folder(out)
    try:
        yield temporary
        _publish(temporary, out, _Run(by, of.seen_from(out), tuple(protected)))
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


class _Run(NamedTuple):
    """A run that writes to a folder; see :func:`output_folder`."""

    by: str
    of: Project  #: seen from the folder
    protected: Sequence[Path]


def _publish(temporary: Path, out: Path, run: _Run) -> None:
    """Move the finished files to their places, or raise and leave the output as it was."""
    files = sorted(path for path in temporary.rglob("*") if path.is_file())
    written = {path.relative_to(temporary).as_posix(): digest(path) for path in files}
    recorded = _recorded(out)
    _refuse(out, written, recorded, run)
    stale = _stale(out, run, written, recorded)
    project = run.of if run.of.name else recorded.project
    kept = {
        name: entry for name, entry in recorded.files.items() if name not in stale and (out / name).is_file()
    }
    new = {name: OutputEntry(run.by, (sha256,)) for name, sha256 in written.items()}
    both = {
        name: OutputEntry(run.by, (*entry.sha256, *(kept[name].sha256 if name in kept else ())))
        for name, entry in new.items()
    }
    try:
        out.mkdir(exist_ok=True)
        _record(temporary, out, _Record({**recorded.files, **both}, project))
        for name in written:
            (out / name).parent.mkdir(exist_ok=True)
            os.replace(temporary / name, out / name)
        for name in stale:
            (out / name).unlink(missing_ok=True)
        _record(temporary, out, _Record(kept | new, project))
    except OSError as error:
        raise InputError(
            f"cannot be written to ({error.strerror}: {error.filename}); close the program that uses it or {ELSEWHERE}",
            file=out,
        ) from error


def _record(temporary: Path, out: Path, record: _Record) -> None:
    """Replace the record of a folder."""
    files = {name: ":".join((entry.by, *entry.sha256)) for name, entry in sorted(record.files.items())}
    content = {"about": ABOUT, "project": record.project._asdict(), "files": files}
    text = json.dumps(content, indent=2, ensure_ascii=False) + "\n"
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


def refuse_early(
    out: Path, names: Collection[str], protected: Iterable[Path] = (), of: Project = UNKNOWN
) -> None:
    """Raise before the work, if the names of the files are known, what :func:`output_folder` would raise after it.

    Raises InputError if ``out`` cannot be written to, is of another project, or has a file of one of the names that may not be
    replaced.
    """
    refuse_unusable(out)
    if out.is_dir():
        run = _Run("", of.seen_from(out), tuple(protected))
        _refuse(out, dict.fromkeys(names, ""), _recorded(out), run)


def seen_from(folder: Path, file: Path) -> str:
    """Path of a file relative to a folder, with slashes; absolute on another drive."""
    try:
        return Path(os.path.relpath(file.resolve(), folder.resolve())).as_posix()
    except ValueError:
        return file.resolve().as_posix()


def written_by(out: Path, by: str) -> frozenset[str]:
    """Files of ``out`` that the command ``by`` wrote and that are unchanged; empty without a record."""
    try:
        recorded = _recorded(out)
        return frozenset(
            name
            for name, entry in recorded.files.items()
            if entry.by == by and _is_unchanged(out, name, entry)
        )
    except (InputError, OSError):
        return frozenset()


def digest(path: Path) -> str:
    """SHA-256 of a file, in hex."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _is_unchanged(out: Path, name: str, entry: OutputEntry) -> bool:
    return (out / name).is_file() and digest(out / name) in entry.sha256


def _refuse(out: Path, written: Mapping[str, str], recorded: _Record, run: _Run) -> None:
    """Raise if the folder is of another project, or a file of ``written`` would replace one that must stay."""
    other = recorded.project
    if run.of.name and run.of.is_other(other, out):
        of_file = f" ({other.file})" if other.file else ""
        raise InputError(f"holds results of {other.name}{of_file}; {ELSEWHERE}, or remove it", file=out)
    inputs = [path for path in run.protected if path.exists()]
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
        reason = _reason_to_keep(target, new, recorded.files.get(name), inputs)
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


def _stale(out: Path, run: _Run, written: Mapping[str, str], recorded: _Record) -> list[str]:
    """Unchanged files of an earlier run of this command that this run neither wrote again nor reads.

    All if both are of one project; else those in the folders that this run wrote to.
    """
    together = bool(run.of.name and recorded.project.name)
    folders = {PurePosixPath(name).parent for name in written} - {PurePosixPath(".")}
    inputs = {path.resolve() for path in run.protected}
    return [
        name
        for name, entry in recorded.files.items()
        if name not in written
        and (together or PurePosixPath(name).parent in folders)
        and entry.by == run.by
        and _is_unchanged(out, name, entry)
        and (out / name).resolve() not in inputs
    ]


def _recorded(out: Path) -> _Record:
    """The record of ``out``, empty without one; a file called RECORD that is not a record is refused."""
    path = out / RECORD
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        parts = {name: text.split(":") for name, text in content["files"].items()}
        files = {name: OutputEntry(by, tuple(sha256)) for name, (by, *sha256) in parts.items()}
        return _Record(files, Project(**content.get("project", UNKNOWN._asdict())))
    except FileNotFoundError:
        return _Record({})
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
