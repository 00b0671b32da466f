"""Progress messages of long runs, and the share of a build or a diagnosis that is done."""

import math
import time
from collections.abc import Callable

from mffit.constants import SHARES_OF_A_BUILD, SHARES_OF_A_DIAGNOSIS

Progress = Callable[[str], None]
"""Called with a short sentence at the beginning of every step."""

READING = "reading sweeps"
MEASURING = "measuring the camber reduction factor"
FITTING = "fitting tyre and rig"
FITTING_AGAIN = "fitting again with"
PREDICTING = "predicting each sweep from the others"
DERIVING = "deriving the property files"
JUDGING = "judging what the fit leaves"
WRITING = "writing the"
STEPS = (READING, MEASURING, FITTING, FITTING_AGAIN, PREDICTING, DERIVING, JUDGING, WRITING)
"""How the sentences of a build begin, in their order."""
COMPARING = "comparing simulation and measurement"
FITTING_ALL = "fitting all effects at once"
NOISE = "estimating the noise of the readings"
CHOOSING = "choosing effects"
WEIGHING = "weighing them against structure without a name"
CHOOSING_AGAIN = "choosing again"
WEIGHING_AGAIN = "weighing again"
SIZING = "estimating sizes and coefficients"
LEAVING_OUT = "checking on left-out sweeps"
CONTESTING = "trying all effects in the place of each"
CORRECTING = "correcting model and readings"
WRITING_DIAGNOSIS = "writing the diagnosis"
STEPS_OF_A_DIAGNOSIS = (
    *(READING, COMPARING, FITTING_ALL, NOISE, CHOOSING, WEIGHING, CHOOSING_AGAIN, WEIGHING_AGAIN),
    *(SIZING, LEAVING_OUT, CONTESTING, CORRECTING, WRITING_DIAGNOSIS),
)
"""Those of a diagnosis."""
RUNS = ((STEPS_OF_A_DIAGNOSIS, SHARES_OF_A_DIAGNOSIS), (STEPS, SHARES_OF_A_BUILD))
"""Steps of every kind of run, and their shares."""


def silent(sentence: str) -> None:
    """Progress that is not shown."""


def remaining(
    sentence: str, seconds: float, since: float = 0.0, *, writes: bool = True
) -> tuple[float | None, float | None]:
    """Share of a build or a diagnosis that is done in a step, and the time that it still takes [s].

    Parameters
    ----------
    sentence : of the step; both are None for a sentence outside their steps
    seconds : from the beginning of the run to that of the step [s]
    since : from the beginning of the step [s]: the share grows as fast as it did before, up to that of the next step; the time
        left is None until the longest step has shown how fast it is
    writes : whether the run ends with the step of writing
    """
    found = [
        (shares, k) for steps, shares in RUNS for k, step in enumerate(steps) if sentence.startswith(step)
    ]
    if not found:
        return None, None
    shares, at = found[0]
    whole = 1.0 if writes else 1.0 - shares[-1]
    done, own = sum(shares[:at]) / whole, shares[at] / whole
    if not done or not seconds:
        return done, None
    usual = done / seconds
    left = (1.0 - done) / usual - since if at > shares.index(max(shares)) else None
    return done + min(own, usual * since), left


class ShownStep:
    """A step of a run that has begun, as text with the progress of the run."""

    def __init__(self, sentence: str, begun: float, *, writes: bool = True) -> None:
        """``begun`` is when the run began, as ``time.monotonic`` has it."""
        self.sentence, self.writes = sentence, writes
        self.at = time.monotonic()
        self.seconds = self.at - begun

    def text(self, grain: int = 1) -> str:
        """The sentence behind the share done and the time left, both in steps of ``grain`` percent and seconds."""
        since = time.monotonic() - self.at
        done, left = remaining(self.sentence, self.seconds, since, writes=self.writes)
        if not done:
            return self.sentence
        said = f"{min(100 - grain, grain * math.floor(100.0 * done / grain + 1e-9))} % done"
        if left is not None:
            said += f", about {grain * max(1, round(left / grain))} s left"
        return f"{said}: {self.sentence}"

    def __rich__(self) -> str:
        return self.text()
