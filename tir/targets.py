"""The programs for which a property file can be written, and what differs in the file for each."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from tir import calls
from tir.constants import NEGLIGIBLE_SHARE, SIDESLIP_BEYOND_PEAK, SLIP_BEYOND_PEAK, SMALL_TURN_SLIP
from tir.equations.normalise import OperatingCondition, Switches
from tir.errors import TirError, listed
from tir.mode import asks_for_turn_slip
from tir.parameters import TABLE
from tir.record import TyreRecord

ADAMS = tuple(row.name for row in TABLE if row.files == "adams")
ONLY_62 = tuple(row.name for row in TABLE if row.files == "62")


@dataclass(frozen=True, slots=True)
class TargetRule:
    """A program's own treatment of some values, found in its public source or manual."""

    name: str  #: the key at fault
    concerns: Callable[[TyreRecord], Any]  #: if this is words, they are ``{said}`` in the sentence
    sentence: str  #: ``{value}`` is that of the key
    level: str = "warning"


@dataclass(frozen=True, slots=True)
class Target:
    """A program that reads property files."""

    name: str
    program: str  #: description in a few words
    fittyps: tuple[int, ...]  #: versions that it reads; the first is written
    without: tuple[str, ...] = ()  #: keys that are left out
    values: Mapping[str, Any] = field(default_factory=dict)  #: fixed values of keys of the table
    more: Mapping[str, str] = field(default_factory=dict)  #: additional keys in [MODEL], with their text
    turn_slip: bool = True  #: whether it can compute turn slip
    complete: bool = False  #: whether it needs every key
    si: bool = False  #: whether it ignores [UNITS] and takes every number as SI
    positions: bool = False  #: whether it reads values by line number instead of by key
    dollar_only: bool = False  #: whether only a dollar sign starts a comment
    refusal: str = ""  #: reason if no file can be written for it
    rules: tuple[TargetRule, ...] = ()
    siemens: bool = False  #: whether it runs Siemens' solver, MF-Tyre/MF-Swift
    known: str = "documentation"  #: how the profile is known: one of :data:`KNOWN`
    verified: str = ""  #: what that rests on, if it is not the program's source


CHRONO_HOLDS = 0.5 * math.pi - 0.01
"""Largest B x of a curve in Chrono's PAC2002: beyond this slip its pure forces stay constant."""


def beyond_the_peak_in_chrono(tyre: TyreRecord) -> dict[str, float]:
    """Share by which Chrono's pure Fx and Fy exceed those of the formula beyond the peak; upright, at nominal load and pressure.

    At SLIP_BEYOND_PEAK of longitudinal slip, and at SIDESLIP_BEYOND_PEAK. A force that the tyre does not have is left out.
    """
    Fz, off = float(tyre["FNOMIN"]), Switches(False)
    state = calls.state(tyre, _straight(tyre), off)
    shares = {}
    for channel, shape, friction, stiffness, shift, slip in (
        ("Fx", "PCX1", state.mu_x, state.K_xk, 0.0, float(SLIP_BEYOND_PEAK)),
        ("Fy", "PCY1", state.mu_y, state.K_ya, float(state.S_Hy), SIDESLIP_BEYOND_PEAK.rad),
    ):
        scale = tyre["LCX" if channel == "Fx" else "LCY"]
        per_slip = abs(float(stiffness)) / abs(float(tyre[shape] * scale * friction) * Fz or math.inf)
        held = min(slip, CHRONO_HOLDS / per_slip - shift) if per_slip else slip
        over = "kappa" if channel == "Fx" else "alpha"
        forces = (calls.forces(tyre, _straight(tyre, **{over: x}), off) for x in (slip, held))
        by_formula, by_program = (float(getattr(force, channel)) for force in forces)
        if by_formula:
            shares[channel] = by_program / by_formula - 1.0
    return shares


def chrono_in_words(tyre: TyreRecord) -> str:
    """The forces of :func:`beyond_the_peak_in_chrono` that differ, for a sentence; empty if none does."""
    places = {"Fx": f"slip {SLIP_BEYOND_PEAK:g}", "Fy": f"{SIDESLIP_BEYOND_PEAK:g} deg of sideslip"}
    shares = beyond_the_peak_in_chrono(tyre)
    return " and ".join(
        f"{channel} by {100.0 * share:+.0f} % at {places[channel]}"
        for channel, share in shares.items()
        if abs(share) > float(NEGLIGIBLE_SHARE)
    )


def spin_without_moment_in_mbsim(tyre: TyreRecord) -> float:
    """Total spin over turn slip below which MBSim's Mz is NaN, about, at nominal load; 1 if it is NaN upright on gentle curves.

    Its moment takes the arc cosine of the moment at 90 deg over that of spin (4.E102), which exceeds 1 where the spin of camber
    cancels most of the path's. The latter moment grows with the spin, the former with the turn slip.
    """
    state = calls.state(tyre, _straight(tyre, phi_t=float(SMALL_TURN_SLIP)), Switches(True))
    return math.cos(0.5 * math.pi * float(state.zeta7))


def mbsim_in_words(tyre: TyreRecord) -> str:
    """Where MBSim's Mz is NaN, for a sentence."""
    share = spin_without_moment_in_mbsim(tyre)
    if share >= 1.0:
        return "on every gentle curve"
    return (
        f"wherever the total spin is within about {share:.2g} of the turn slip, as where a leaning wheel runs nearly straight: "
        f"within {share / 5.0:.2g} 1/m on a circle of 5 m"
    )


def _straight(tyre: TyreRecord, **changes: float) -> OperatingCondition:
    """The upright wheel at the nominal condition of its file, with changes."""
    nominal = OperatingCondition(float(tyre["FNOMIN"]), Vx=tyre["LONGVL"], pressure=tyre["NOMPRES"])
    return nominal._replace(**changes)


def _if_turn_slip(then: str) -> TargetRule:
    sentence = f"USE_MODE asks for turn slip, {then}"
    return TargetRule("USE_MODE", lambda tyre: asks_for_turn_slip(tyre.values), sentence)


KNOWN = ("source read", "documentation", "assumed")
OF_SIMSCAPE = (
    _if_turn_slip("which is an option of the block: switch it on there, or use the file for turn slip off"),
    TargetRule(
        "MC_CONTOUR_A",
        lambda p: p["MC_CONTOUR_A"] > 0.0,
        "by MC_CONTOUR_A this is a motorcycle tyre, but the block is meant for tyres with a square cross-section: it takes the "
        "sine of camber in Fy and lets the trail act on camber thrust too, so Mz is wrong where the tyre leans",
    ),
)
OF_MBSIM = (
    TargetRule(
        "MC_CONTOUR_B",
        lambda p: p["MC_CONTOUR_B"] == 0.0,
        "MC_CONTOUR_B is 0, by which its motorcycle kinematics divides, so every force is NaN there: write the contour, or leave "
        "motorcycleKinematics off",
    ),
    TargetRule(
        "LFZO",
        lambda p: p["LFZO"] != 1.0,
        "it multiplies the nominal load by LFZO again at every evaluation, so the forces drift: write 1",
        "error",
    ),
    TargetRule(
        "USE_MODE",
        lambda p: asks_for_turn_slip(p.values) and mbsim_in_words(p),
        "USE_MODE asks for turn slip, with which its Mz is NaN {said}, and at no spin at all; its trail acts on the force of "
        "spin too: use the file for turn slip off, or expect another Mz on curves",
    ),
    TargetRule(
        "QDRP2",
        lambda p: p["QDRP2"] != 0.0 and asks_for_turn_slip(p.values),
        "it has no QDRP2, so the turn-slip moment differs; set it to 0 before the fit, or expect another Mz on curves",
    ),
)
OF_MFEVAL = (
    _if_turn_slip(
        "with which it reverses camber thrust: use the file for turn slip off, and a mode of mfeval "
        "that ends in 1"
    ),
)
OF_TYREDYN = (
    _if_turn_slip("with which it reverses camber thrust and gives NaN in Mz: use the file for turn slip off"),
)
OF_TEASIT = (
    TargetRule(
        "MC_CONTOUR_A",
        lambda p: p["MC_CONTOUR_A"] > 0.0,
        "by MC_CONTOUR_A this is a motorcycle tyre, but it takes the sine of camber, so the forces differ where the tyre leans",
    ),
)
READ_BY_CHRONO = ("PAC2002", "MF_05")
OF_CHRONO = (
    TargetRule(
        "PROPERTY_FILE_FORMAT",
        lambda p: "PROPERTY_FILE_FORMAT" not in p.present,
        "the file has no PROPERTY_FILE_FORMAT, so it is read without a message, its coefficients as those of PAC2002",
    ),
    TargetRule(
        "PROPERTY_FILE_FORMAT",
        lambda p: "PROPERTY_FILE_FORMAT" in p.present and p["PROPERTY_FILE_FORMAT"] not in READ_BY_CHRONO,
        "it stops at PROPERTY_FILE_FORMAT '{value}', as only 'PAC2002' and 'MF_05' are known to it",
    ),
    TargetRule(
        "USE_MODE",
        lambda p: p["USE_MODE"] not in (1.0, 2.0, 3.0, 4.0),
        "USE_MODE {value:g} is none of 1 to 4, with which alone it computes Fx and Fy: the tyre would have no grip at all",
    ),
    TargetRule(
        "LKY",
        lambda p: p["LKY"] != 1.0 or p["LMUY"] != 1.0,
        "it multiplies the cornering stiffness by LMUY instead of LKY: write 1 for both, and the product into PKY1",
    ),
    TargetRule(
        "",
        chrono_in_words,
        f"it holds the product of slope factor and slip at {CHRONO_HOLDS:.2f}, so that nothing falls off far behind the peak: a "
        "PAC2002 file of this tyre differs in {said}",
    ),
)
ASSUMED = "no public manual was found that names its keys, so this is the file for MF-Tyre/MF-Swift itself"


def _host(name: str, program: str, verified: str = ASSUMED, **more: Any) -> Target:
    """A program that has MF-Tyre/MF-Swift built in."""
    return Target(
        name,
        f"{program} with MF-Tyre/MF-Swift",
        (62, 61, 60),
        tuple(key for key in ADAMS if key not in more.get("values", ())),
        siemens=True,
        known="assumed" if "assumed" in verified or verified == ASSUMED else "documentation",
        verified=f"{verified}; nothing was run",
        **more,
    )


HOSTS = (
    _host("carsim", "CarSim and BikeSim"),
    _host("simpack", "Simpack"),
    _host("vigrade", "VI-CarRealTime and VI-BikeRealTime"),
    _host(
        "motionview",
        "MotionView and MotionSolve",
        "its public manual names MF-Tyre/MF-Swift and lets [MODEL] select it; take PROPERTY_FILE_FORMAT and FUNCTION_NAME from "
        "the sample file of the installation",
    ),
    _host(
        "ansysmotion",
        "Ansys Motion",
        "its public manual lists MF-Tyre and MF-Swift and their PROPERTY_FILE_FORMAT",
        values={"PROPERTY_FILE_FORMAT": "MF"},
        rules=(_if_turn_slip("for which PROPERTY_FILE_FORMAT has to be 'SWIFT'"),),
    ),
    _host("asm", "dSPACE ASM"),
    _host(
        "carmaker-mftyre",
        "CarMaker",
        "its public forum says that an info file names the model and the property file; that this file is the one for "
        "MF-Tyre/MF-Swift itself is assumed",
    ),
)
TARGETS: dict[str, Target] = {
    target.name: target
    for target in (
        Target("mftyre", "MF-Tyre/MF-Swift 6.2 and what has it built in", (62, 61, 60), ADAMS, siemens=True),
        Target("mf61", "programs that read MF 6.1 but not 6.2", (61, 60), (*ADAMS, *ONLY_62)),
        Target(
            "adams",
            "MF-Tyre/MF-Swift 6.2 in Adams",
            (62, 61, 60),
            ("USER_SUB_ID",),
            {"PROPERTY_FILE_FORMAT": "USER", "N_TIRE_STATES": 5.0},
            {"FUNCTION_NAME": "'TNO_DelftTyre_Adams_interface::TYR815'"},
            siemens=True,
            verified="public copies of the manual of MF-Tyre/MF-Swift; nothing was run",
        ),
        Target(
            "carmaker",
            "CarMaker's own MF 6.1",
            (61,),
            (*ADAMS, *ONLY_62),
            turn_slip=False,
            complete=True,
            si=True,
            verified="its public forum says that it has MF 5.2 and 6.1 of its own and stops where QSY3 or QSY4 is missing; that "
            "it computes no turn slip and ignores [UNITS] is assumed; nothing was run",
        ),
        Target(
            "simscape",
            "the Magic Formula blocks of MathWorks",
            (62,),
            complete=True,
            si=True,
            rules=OF_SIMSCAPE,
            verified="the public pages of the blocks; nothing was run",
        ),
        Target(
            "recurdyn",
            "RecurDyn with MF-Tyre",
            (62, 61, 60),
            ADAMS,
            more={"VENDER_TIRE_TYPE": ""},
            siemens=True,
            verified="its public manual; nothing was run",
        ),
        Target(
            "mbsim",
            "MBSim's MagicFormula62",
            (62,),
            ADAMS,
            complete=True,
            si=True,
            positions=True,
            rules=OF_MBSIM,
            known="source read",
        ),
        *HOSTS,
        Target(
            "mfeval",
            "MFeval and its relatives",
            (62, 61, 60),
            ADAMS,
            si=True,
            dollar_only=True,
            rules=OF_MFEVAL,
            known="source read",
        ),
        Target(
            "teasit",
            "the Magic Formula Tyre Library and Tool for MATLAB by teasit",
            (61,),
            (*ADAMS, *ONLY_62),
            turn_slip=False,
            si=True,
            dollar_only=True,
            rules=OF_TEASIT,
            known="source read",
        ),
        Target(
            "tyredyn",
            "TyreDyn",
            (62, 61),
            ADAMS,
            complete=True,
            si=True,
            dollar_only=True,
            rules=OF_TYREDYN,
            known="source read",
        ),
        *(
            Target(
                name,
                "PAC2002",
                (),
                refusal=(
                    "computes PAC2002, another formula with other coefficients than MF 6.2: it would take a renamed file for "
                    "another tyre without any message. mffit convert FILE.tir --to pac2002 fits one to the forces of this tyre"
                ),
                rules=rules,
                known=known,
            )
            for name, rules, known in (("chrono", OF_CHRONO, "source read"), ("pac2002", (), "documentation"))
        ),
        Target(
            "adams-motorcycle",
            "PAC MC, the motorcycle model of Adams",
            (),
            refusal=(
                "computes PAC_MC, another formula with other coefficients than MF 6.2, and no public text was found that has all "
                "its equations. Use MF-Tyre/MF-Swift in Adams with the file for adams, or, within 15 deg of camber, PAC2002 by "
                "mffit convert FILE.tir --to pac2002"
            ),
        ),
    )
}
DEFAULT = "mftyre"
FITTYPS = tuple(sorted({version for target in TARGETS.values() for version in target.fittyps}))
"""Versions of the Magic Formula that ``tir`` reads."""


def fittyps_text() -> str:
    """:data:`FITTYPS` in words: "60, 61 and 62"."""
    return listed([str(version) for version in FITTYPS])


def target_of(name: str) -> Target:
    """The program of this name. Raises TirError if the name is unknown, or the program cannot use an MF 6.2 tyre."""
    target = known_target(name)
    if target.refusal:
        raise TirError(f"no file can be written for {name}: it {target.refusal}")
    return target


def known_target(name: str) -> Target:
    """The program of this name, whether or not it can use an MF 6.2 tyre; raises as :func:`target_of`."""
    if name not in TARGETS:
        raise TirError(f"{name} is an unknown program: use one of {', '.join(TARGETS)}")
    return TARGETS[name]


DIGITS: Mapping[int, Sequence[str]] = {
    100: (
        "road contact by default",
        "smooth road",
        "smooth road, round cross-section",
        "moving road",
        "2D road",
        "3D road",
    ),
    10: ("steady state", "linear relaxation", "nonlinear relaxation", "rigid ring"),
    1: (
        "Fz only",
        "Fx and My only",
        "Fy, Mx and Mz only",
        "slips apart",
        "combined slip",
        "combined and turn slip",
    ),
}
"""Words for the digits of USE_MODE, by the place of the digit."""
UNKNOWN_DIGIT = "unknown digit"


def use_mode_words(mode: float) -> str:
    """Meaning of a USE_MODE for MF-Tyre/MF-Swift, digit by digit; the thousands are ignored."""
    digits = ((abs(int(mode)) // place % 10, words) for place, words in DIGITS.items())
    return ", ".join(words[k] if k < len(words) else UNKNOWN_DIGIT for k, words in digits)


def vendor(mode: float) -> str:
    """RecurDyn's name of the model: turn slip and the rigid ring belong to MF-Swift."""
    number = abs(int(mode))
    return "'TNO-SWIFT'" if number % 10 == 5 or number // 10 % 10 == 3 else "'TNO-MF'"
