"""Builds in processes of their own, on this machine or on a Dask cluster."""

import contextlib
import multiprocessing
import os
import signal
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnContext, SpawnProcess
from pathlib import Path
from typing import cast

from mffit.errors import InputError
from mffit.results import BuildOutcome

START_METHOD = "forkserver" if "forkserver" in multiprocessing.get_all_start_methods() else "spawn"
"""Workers are copies of a process without threads, which has imported what a build needs; copies with threads may hang."""


@dataclass(frozen=True, slots=True)
class Job:
    """One tyre to build."""

    source: Path
    name: str
    out: Path
    ensemble: int = 0
    with_report: bool = True


BuildOne = Callable[[Job], BuildOutcome]
"""Builds one tyre; raises nothing but KeyboardInterrupt."""
Outcomes = Generator[BuildOutcome, None, None]


def in_processes(wanted: Sequence[Job], jobs: int, build_one: BuildOne) -> Outcomes:
    """Outcomes of builds as they finish, each in a process of its own, ``jobs`` of them at a time."""
    context = cast(SpawnContext, multiprocessing.get_context(START_METHOD))  # all contexts make processes
    if START_METHOD == "forkserver":
        context.set_forkserver_preload(["mffit.pipeline.many"])
    left = list(reversed(wanted))
    running: dict[Connection, tuple[Job, SpawnProcess]] = {}
    try:
        while left or running:
            while left and len(running) < jobs:
                receiver, sender = context.Pipe(duplex=False)
                process = context.Process(target=_in_process, args=(build_one, left[-1], sender))
                process.start()
                sender.close()
                running[receiver] = (left.pop(), process)
            ready = wait(list(running))
            for ended in [receiver for receiver in running if receiver in ready]:
                job, process = running.pop(ended)
                try:
                    outcome = ended.recv()
                except EOFError:  # it was killed
                    outcome = _lost(job)
                process.join()
                yield outcome
    finally:
        for _, process in running.values():
            _interrupt(process.pid)
        for _, process in running.values():
            process.join()


def on_cluster(wanted: Sequence[Job], address: str, build_one: BuildOne) -> Outcomes:
    """Outcomes of builds on a Dask cluster, which repeats the builds of workers that died.

    Raises InputError if Dask is not installed, or no scheduler answers.
    """
    try:
        from distributed import Client, as_completed
    except ImportError:
        raise InputError("--dask needs the package distributed: pip install 'mffit[dask]'") from None
    try:
        client = Client(address, timeout=10)
    except (OSError, ValueError, TypeError) as error:
        raise InputError(
            f"no Dask scheduler answers at {address} ({type(error).__name__}): start one with `dask scheduler`, "
            "or correct --dask"
        ) from None
    with client:
        jobs = {
            client.submit(build_one, replace(job, source=job.source.absolute()), pure=False): job
            for job in wanted
        }
        for future in as_completed(jobs):
            job = jobs[future]
            found = future.result() if future.status == "finished" else _lost(job)
            yield replace(found, source=job.source)


def _in_process(build_one: BuildOne, job: Job, sender: Connection) -> None:
    """Build in this process; an interrupted build removes its temporary files without a message."""
    with contextlib.suppress(KeyboardInterrupt):
        sender.send(build_one(job))


def _lost(job: Job) -> BuildOutcome:
    """The outcome of a job whose process ended."""
    sentence = "its process ended early, perhaps for lack of memory; build it again alone"
    return BuildOutcome(job.source, job.name, job.out, "failed", sentence)


def _interrupt(pid: int | None) -> None:
    """Send a worker the signal of Ctrl-C, which may have reached only this process."""
    if pid is not None:
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, signal.SIGTERM if os.name == "nt" else signal.SIGINT)
