"""The goals of a plan: numbers whose uncertainty should decrease."""

from collections.abc import Collection
from dataclasses import dataclass

from mffit.as_json import keys
from mffit.errors import InputError, meant
from mffit.fit.relaxation import DIRECTIONS
from mffit.quantities import CHANNELS, DIRECT
from mffit.rig import SIMULATED
from tir.parameters import BY_NAME

EPSILON, JOINT, BANDS, FILE, ROAD = "eps_gamma", "eps_gamma:joint", "bands", "file", "road"
GOALS = (EPSILON, JOINT, BANDS, f"{BANDS}:Mz", FILE, ROAD)
"""Goals as the user writes them; the name of a coefficient is a goal too."""


@dataclass(frozen=True, slots=True)
class Goal:
    """The number whose uncertainty should decrease."""

    kind: str  #: EPSILON (direct method), JOINT, BANDS, FILE, ROAD or "coefficient"
    name: str = ""  #: name of the coefficient, or channel of the bands
    unit: str = "-"

    @property
    def label(self) -> str:
        """Name of the uncertainty in tables and JSON, in ASCII."""
        epsilon = DIRECT["epsilon_gamma"].ascii
        return {
            EPSILON: f"u({epsilon}) by the direct method",
            JOINT: f"u({epsilon}) by the joint fit",
            BANDS: f"95 % band of {self.name}, rms",
            FILE: "95 % band of the file over its largest forces, rms",
            ROAD: "95 % band of the road over its largest forces, rms",
        }.get(self.kind, f"u({self.name})")


keys(Goal, "kind name label unit")


def read_goal(text: str, *, on_disc: bool, held: Collection[str] = ()) -> Goal:
    """A goal from its text: ``eps_gamma``, ``bands``, ``file``, ``road`` or a coefficient's name.

    Raises InputError if the goal is unknown, needs a disc, needs recordings of steps, or is a coefficient ``held`` by hand.
    """
    if text in held or (text == JOINT and "PECP1" in held):
        text = "PECP1" if text == JOINT else text
        raise InputError(
            f"[coefficients] holds {text}, so that no run makes it more certain; choose another goal, or free it"
        )
    kind, _, rest = text.partition(":")
    if any(text in direction.names for direction in DIRECTIONS):
        raise InputError(
            f"{text} follows from recordings of steps, which a plan does not propose; `mffit build` says which one is missing"
        )
    if text in (FILE, ROAD):
        return Goal(text)
    if kind == EPSILON and rest in ("", "direct", "joint"):
        if not on_disc:
            raise InputError(
                f'"{text}" needs a disc, because there is no turn slip on a straight path; choose bands or a coefficient'
            )
        return Goal(JOINT if rest == "joint" else EPSILON)
    if kind == BANDS and (rest or "Fy") in SIMULATED:
        channel = rest or "Fy"
        return Goal(BANDS, channel, CHANNELS[channel].unit)
    if text in BY_NAME and BY_NAME[text].stage:
        return Goal("coefficient", text, BY_NAME[text].unit)
    if text == "PECP1":
        return read_goal(EPSILON, on_disc=on_disc)
    known = [*GOALS, *(row for row in BY_NAME if BY_NAME[row].stage)]
    near = meant(text, known)
    hint = f"; did you mean {near}?" if near else f": write {', '.join(GOALS)} or a coefficient's name"
    raise InputError(f'"{text}" is neither a goal of a plan nor a coefficient that its runs inform{hint}')
