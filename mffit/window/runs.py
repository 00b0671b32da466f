"""The runs that a window starts, each in a process of its own, so that it can be stopped."""

import contextlib
import multiprocessing
import os
import signal
import threading
import time
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, NamedTuple

from mffit.errors import InputError
from mffit.progress import Progress, ShownStep
from mffit.results.campaign import Arrival
from mffit.window import constants
from tir.errors import TirError

BEGUN = "reading the project"
"""First progress of every run."""


class RunOutcome(NamedTuple):
    """How a run ended."""

    state: str  #: done, refused, failed or stopped
    sentence: str = ""
    data: dict[str, Any] | None = None  #: of the page, if the run was a fit


def out_of(path: Path) -> Path:
    """The folder of the results, as on the command line."""
    return path.parent / "out"


PAGES = {
    "build": ("Report", "report.html"),
    "diagnose": ("Diagnosis", "diagnosis/diagnosis.html"),
    "plan": ("Plan", "plan/plan.html"),
    "compare": ("Comparison with the base file", "comparison/compare.html"),
}
"""By run, the title of the page that it writes and its place in the folder of the results."""
RUNS = ("fit", *PAGES)
"""What can be run: a build that writes nothing, and the commands of these names."""


def carry_out(kind: str, path: Path, progress: Progress) -> dict[str, Any] | None:
    """Run it in this process; returns what the page shows of a fit or a build."""
    from mffit import config, pipeline, viewer
    from mffit.pipeline.inputs import read_points
    from mffit.report import text
    from mffit.report.verdict import judgement, verdict

    out = out_of(path)
    match kind:
        case "fit" | "build":
            written = out if kind == "build" else None
            built = pipeline.build(path, written, progress=progress)
            return viewer.project_data(built, verdict=verdict(built), judgement=judgement(built))
        case "points":
            settings = config.load(path)
            return viewer.readings_data(settings, read_points(settings))
        case "diagnose":
            pipeline.diagnose(path, out=out / "diagnosis", progress=progress)
        case "plan":
            pipeline.plan(path, out=out / "plan", progress=progress)
        case "compare":
            base = config.load(path).tyre.base
            if base is None:
                raise InputError("names no base file to compare with; add base under [tyre]", file=path)
            pipeline.compare(path.parent / base, out, out=out / "comparison", progress=progress)
        case "watch":
            arrivals: dict[str, Arrival] = {}
            for last in pipeline.watch(path, once=True):
                arrivals |= {one.file: one for one in last.changed}
            refused = [text.arrival_line(one) for one in arrivals.values() if one.state == "refused"]
            unlisted = [one.file for one in arrivals.values() if one.sweep]
            return {"lines": [*text.campaign_lines(last), *refused], "unlisted": unlisted}
    return None


class Run:
    """A run in its process, of what tyre.toml has ``stated``; ``outcome`` is None until it ends."""

    def __init__(self, kind: str, path: Path, stated: Any = None) -> None:
        self.kind, self.stated = kind, stated
        self._begun_at = time.monotonic()
        self._step = ShownStep("starting", self._begun_at)
        self.outcome: RunOutcome | None = None
        self._stopped = self._begun = False
        context = multiprocessing.get_context("spawn")  # a forked copy of a process with threads may hang
        receiver, sender = context.Pipe(duplex=False)
        self._process = context.Process(target=_work, args=(kind, path, sender), daemon=True)
        self._process.start()
        sender.close()
        threading.Thread(target=self._listen, args=(receiver,), daemon=True).start()

    @property
    def sentence(self) -> str:
        """What it does, and how far it is, in steps that do not make every window draw itself too often."""
        return self._step.text(grain=5)

    def stop(self) -> None:
        """End the run; its temporary files go. A process that has not begun is loading the program and has none."""
        self._stopped = True
        if not self._begun or os.name == "nt" or self._process.pid is None:
            self._process.terminate()
        else:
            with contextlib.suppress(ProcessLookupError):
                os.kill(self._process.pid, signal.SIGINT)
        self._process.join(constants.TIME_TO_STOP)
        if self._process.is_alive():
            self._process.kill()

    def _listen(self, receiver: Connection) -> None:
        """Take what the process sends until it ends."""
        outcome = None
        with contextlib.suppress(EOFError, OSError):
            while outcome is None:
                kind, content = receiver.recv()
                self._begun = True
                if kind == "progress":
                    self._step = ShownStep(content, self._begun_at, writes=self.kind in PAGES)
                else:
                    outcome = content
        receiver.close()
        self._process.join()
        if outcome is None:
            outcome = RunOutcome(
                "failed", "the process of this run ended early, perhaps for lack of memory; run it again"
            )
        self.outcome = RunOutcome("stopped") if self._stopped and outcome.state != "done" else outcome


def _work(kind: str, path: Path, sender: Connection) -> None:
    """In the process: run, and send progress and outcome."""
    try:
        try:
            sender.send(("progress", BEGUN))
            data = carry_out(kind, path, lambda sentence: sender.send(("progress", sentence)))
            outcome = RunOutcome("done", data=data)
        except (InputError, TirError) as error:
            outcome = RunOutcome("refused", str(error))
        except KeyboardInterrupt:
            outcome = RunOutcome("stopped")
        except Exception as error:  # the window must say it, whatever it is
            outcome = RunOutcome("failed", f"{type(error).__name__}: {error}; this is a bug in mffit")
            sender.send(("outcome", outcome))
            raise
        sender.send(("outcome", outcome))
    except (KeyboardInterrupt, BrokenPipeError):
        return  # the window has ended
