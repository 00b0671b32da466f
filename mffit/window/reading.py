"""Recordings are read in a separate process, which can be stopped: the content of a file is not known beforehand."""

import multiprocessing
import signal
import threading
import time
from collections.abc import Sequence
from multiprocessing.pool import Pool
from pathlib import Path
from typing import Any

from mffit.errors import InputError
from mffit.sweeps.extras import TIME_TO_READ
from mffit.window import constants
from mffit.window.recordings_folder import RecordingsFolder


class ReadingProcess:
    """A process that reads recordings, begun at the first use and again after a stop."""

    def __init__(self) -> None:
        self._pool: Pool | None = None
        self._lock = threading.Lock()

    def ask(self, folder: RecordingsFolder, what: str, *given: Any) -> Any:
        """What the method ``what`` of a folder returns.

        Raises InputError as the method, or if it was stopped or takes longer than any recording.
        """
        with self._lock:
            if self._pool is None:  # a forked copy of a process with threads may hang
                ignored = signal.SIGINT, signal.SIG_IGN
                self._pool = multiprocessing.get_context("spawn").Pool(1, signal.signal, ignored)
            pool, end = self._pool, time.monotonic() + TIME_TO_READ
        found = pool.apply_async(_found, (folder.folder, folder.project, what, given))
        while self._pool is pool:
            try:
                return found.get(float(constants.LOOK_AGAIN))
            except multiprocessing.TimeoutError:
                if time.monotonic() > end:
                    self.stop()
        raise InputError(
            "reading was stopped; move a recording that takes too long out of the folder, and load this page again",
            file=folder.folder,
        )

    def stop(self) -> None:
        """End what is under way."""
        pool, self._pool = self._pool, None
        if pool is not None:
            pool.terminate()


def _found(folder: Path, project: Path | None, what: str, given: Sequence[Any]) -> Any:
    return getattr(RecordingsFolder(folder, project), what)(*given)
