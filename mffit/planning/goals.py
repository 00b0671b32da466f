"""The goals of a plan: numbers whose uncertainty is to fall."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from mffit.effects import CATALOG, Effect
from mffit.errors import InputError, meant
from mffit.fit.relaxation import DIRECTIONS
from mffit.quantities import CHANNELS, DIRECT
from mffit.rig import SIMULATED
from mffit.rig_errors import UNITS
from tir.parameters import BY_NAME

EPSILON, JOINT, BANDS, TIE, FILE = "eps_gamma", "eps_gamma:joint", "bands", "tie", "file"
GOALS = (EPSILON, JOINT, BANDS, f"{BANDS}:Mz", f"{TIE}:EFFECT", FILE)
"""How goals are written; the name of a coefficient is a goal too."""


@dataclass(frozen=True, slots=True)
class Goal:
    """The number whose uncertainty is to fall."""

    kind: str  #: EPSILON (direct method), JOINT, BANDS, TIE, FILE or "coefficient"
    name: str = ""  #: of the coefficient, the channel of the bands, or the effect
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
            TIE: f"u of {self._tied} with its rival effects free",
        }.get(self.kind, f"u({self.name})")

    @property
    def _tied(self) -> str:
        """The effect's name, with the coefficient in whose unit u is given."""
        effect = next((e for e in CATALOG if e.id == self.name), None)
        if effect is None:
            return self.name
        number = effect.free[0].name
        return f"{effect.name} ({number})" if number in BY_NAME else effect.name


def read_goal(text: str, *, on_disc: bool, held: Collection[str] = ()) -> Goal:
    """A goal from its text: ``eps_gamma``, ``bands``, ``tie:ply-steer`` or a coefficient's name.

    An InputError says that the goal is not known, needs a disc, or is a coefficient that is ``held`` by hand.
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
    if text == FILE:
        return Goal(FILE)
    if kind == EPSILON and rest in ("", "direct", "joint"):
        if not on_disc:
            raise InputError(
                f'"{text}" needs a disc, because there is no turn slip on a straight path; choose bands or a coefficient'
            )
        return Goal(JOINT if rest == "joint" else EPSILON)
    if kind == BANDS and (rest or "Fy") in SIMULATED:
        channel = rest or "Fy"
        return Goal(BANDS, channel, CHANNELS[channel].unit)
    if kind == TIE:
        effect = effect_named(rest)
        number = effect.free[0].name
        return Goal(TIE, effect.id, UNITS[number] if number in UNITS else BY_NAME[number].unit)
    if text in BY_NAME and BY_NAME[text].stage:
        return Goal("coefficient", text, BY_NAME[text].unit)
    if text == "PECP1":
        return read_goal(EPSILON, on_disc=on_disc)
    known = [*GOALS, *(row for row in BY_NAME if BY_NAME[row].stage)]
    near = meant(text, known)
    hint = f"; did you mean {near}?" if near else f": write {', '.join(GOALS)} or a coefficient's name"
    raise InputError(f'"{text}" is neither a goal of a plan nor a coefficient that its runs inform{hint}')


def effect_named(text: str) -> Effect:
    """The effect with this id, hyphens optional; it must have one number and possible rivals."""
    tied = [e for e in CATALOG if e.confusable_with and len(e.free) == 1 and e.kind != "environment"]

    def plain(word: str) -> str:
        return word.replace("-", "").replace("_", "").lower()

    for effect in tied:
        if plain(effect.id) == plain(text):
            return effect
    raise InputError(
        f'"{text}" is not an effect that can be tied; known are {", ".join(effect.id for effect in tied)}'
    )
