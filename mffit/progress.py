"""Progress messages of long runs, and the share of a build that is done."""

from __future__ import annotations

from collections.abc import Callable

from mffit.constants import SHARES_OF_A_BUILD

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


def silent(sentence: str) -> None:
    """Progress that is not shown."""


def remaining(sentence: str, seconds: float) -> tuple[float | None, float | None]:
    """Share of a build that is done when a step begins, and the time that it still takes [s].

    Parameters
    ----------
    sentence : of the step; both are None for one that is no step of a build
    seconds : since the build began [s]; the time left is None until the fit, the longest step, has shown how fast it is
    """
    at = next((k for k, step in enumerate(STEPS) if sentence.startswith(step)), None)
    if at is None:
        return None, None
    done = sum(SHARES_OF_A_BUILD[:at])
    return done, seconds * (1.0 - done) / done if at > STEPS.index(FITTING) else None
