"""What the direct method remarks on the set-ups of a rig, as sentences."""

from __future__ import annotations

import math
from collections.abc import Sequence

from mffit.measured.result import SetupScatter
from tir import Quantity


def several_setups(names: Sequence[str]) -> str:
    return (
        f"The rig was set up {len(names)} times ({', '.join(names)}): each set-up has its own zeros of sideslip, camber and load "
        "cell, each as uncertain as declared."
    )


def one_setup_on_paths(name: str, paths: int) -> str:
    which = f"set-up {name}" if name else "one set-up"
    return (
        f"The {paths} paths of {which} share their zeros: the rig was not set up anew between them. If it was, give their sweeps "
        "setups of different names."
    )


def setup_without_zeros(name: str) -> str:
    return (
        f"set-up {name} has no points at zero sideslip and camber: its zeros are known only as declared in [rig], and it adds "
        "nothing to the turn-slip force; run zeros in every set-up"
    )


def sweeps_without_setup(files: Sequence[str]) -> str:
    return (
        f"{', '.join(files[:3])}{' and others' if len(files) > 3 else ''}: no setup is given, although other sweeps on this "
        "path give one; they count as a set-up of their own. Give setup in every [[sweep]]"
    )


def last_is_aligned(name: str) -> str:
    return f"the usual path was run in several set-ups; the correction is that of the last one, {name}"


def setup_misaligned(name: str, alpha_M: Quantity) -> str:
    angle, u = math.degrees(alpha_M.value), math.degrees(alpha_M.u)
    return (
        f"set-up {name}: the sideslip axis is misaligned, alpha_M = {angle:.3f} +- {u:.3f} deg; the fit corrects the angles of "
        "this set-up for it"
    )


def setup_scatter(found: SetupScatter) -> str:
    n = found.degrees_of_freedom
    said = (
        f"Repeated set-ups ({', '.join(found.setups)}): from one to the next the force at zero scatters by {found.between:.1f} N "
        f"(standard deviation, {n} degree{'s' * (n > 1)} of freedom), declared in [rig] are {found.declared:.1f} N. "
        "The larger one counts"
    )
    said += (
        f": the budget has a line of {found.excess:.1f} N beside the declared zeros." if found.excess else "."
    )
    if found.between_alpha is not None and found.declared_alpha is not None:
        said += (
            f" The sideslip zero scatters by {math.degrees(found.between_alpha):.3f} deg, declared "
            f"{math.degrees(found.declared_alpha):.3f} deg."
        )
    if found.within is not None and found.stated is not None:
        said += f" Within a set-up the zeros scatter by {found.within:.1f} N, stated {found.stated:.1f} N."
    return said
