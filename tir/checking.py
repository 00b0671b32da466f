"""Problems that a tyre would cause in a simulation: single values and physics over its ranges. Raises and repairs nothing."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from tir import constants
from tir.codegen.program import Switches, that_need
from tir.consumers import target_problems
from tir.envelope import RANGES, over_the_range
from tir.equations import normalise
from tir.equations.forces import Forces, State
from tir.errors import LEVELS, Problem, some
from tir.evaluate import DIVISORS
from tir.formula import OLD_KEYS
from tir.mode import BLOCK
from tir.parameters import BY_NAME, TABLE, TURN_SLIP
from tir.record import DISTRUSTED, TyreRecord
from tir.targets import FITTYPS, UNKNOWN_DIGIT, fittyps_text, known_target, use_mode_words
from tir.tyre import Tyre
from tir.unit_check import in_fitting_units
from tir.units import KINDS


@dataclass(frozen=True, slots=True)
class PlausibleRule:
    """A condition under which the value of a key is wrong, whatever the other values are."""

    keys: tuple[str, ...]
    broken: Callable[[float], bool]
    sentence: str  #: what the value looks like, or what to do
    level: str = "warning"
    amplitude: str = ""  #: the rule applies only if this key is not 0, because the value multiplies it


SINGLE = (
    PlausibleRule(
        ("NOMPRES", "INFLPRES"),
        lambda x: 0.0 < x < constants.PRESSURE_RANGE[0],
        "it looks like kPa or bar; write Pa",
    ),
    PlausibleRule(
        ("NOMPRES", "INFLPRES"),
        lambda x: x > constants.PRESSURE_RANGE[1],
        "no tyre holds that pressure; write Pa",
    ),
    PlausibleRule(
        ("ALPMIN", "ALPMAX", "CAMMIN", "CAMMAX"),
        lambda x: abs(x) > constants.LARGEST_ANGLE,
        "it looks like degrees; write radians",
        "error",
    ),
    PlausibleRule(
        ("WIDTH", "RIM_WIDTH"),
        lambda x: x > constants.LENGTH_RANGE[1],
        "it looks like millimetres or inches; write metres",
    ),
    PlausibleRule(
        tuple(row.name for row in TABLE if row.unit in ("kg", "kg m2")),
        lambda x: x < 0.0,
        "it must not be negative",
        "error",
    ),
    PlausibleRule(
        ("LONGITUDINAL_STIFFNESS", "LATERAL_STIFFNESS"),
        lambda x: x <= 0.0,
        "the relaxation length is divided by it; give its value",
    ),
    PlausibleRule(
        ("PDY1", "PDX1"),
        lambda x: x < 0.0,
        "the slope factor turns with it, so the curve is that of a positive one, but programs may take it for the friction; "
        "reverse its sign, and for PDY1 those of PDY2, RVY1-3 and QBZ10, for PDX1 that of PDX2",
    ),
)
"""Dimensions, limits and masses."""
SHAPES = (
    PlausibleRule(
        ("PKY2",),
        lambda x: x == 0.0,
        "the load is divided by it, so that the cornering stiffness is unknown; give its value",
        "error",
        "PKY1",
    ),
    *(
        PlausibleRule((name,), lambda x: x <= 0.0, f"the {what} must be positive", "error", amplitude)
        for name, what, amplitude in (
            ("PCX1", "shape factor", "PDX1"),
            ("PCY1", "shape factor", "PDY1"),
            ("QCZ1", "shape factor", "QDZ1"),
            ("QBZ1", "slope factor", "QDZ1"),
            ("LCX", "scale of a shape factor", "PDX1"),
            ("LCY", "scale of a shape factor", ""),
        )
    ),
)
"""Coefficients of the shape of the curves."""


def broken(tyre: TyreRecord, rules: Iterable[PlausibleRule]) -> Iterator[Problem]:
    """A problem for every key that breaks a rule."""
    for rule in rules:
        if rule.amplitude and tyre[rule.amplitude] == 0.0:
            continue
        for name in rule.keys:
            if rule.broken(tyre[name]):
                unit = BY_NAME[name].unit.replace("-", "")
                value = f"{tyre[name]:g} {unit}".strip()
                yield Problem(rule.level, f"{name} is {value}: {rule.sentence}", name)


LICENCE = (
    "turn slip in Siemens' solver needs the MF-Swift licence (Ansys' manual says so): with MF-Tyre alone take the file for turn "
    "slip off, NAME-normal.tir"
)
SIDES = ("LEFT", "RIGHT", "SYMMETRIC")


def check(tyre: Tyre, targets: str | Iterable[str] = ()) -> list[Problem]:
    """Problems of the tyre, the gravest first: "error" if it cannot be simulated sensibly, "warning" if it should be looked at.

    Parameters
    ----------
    tyre : if it was read from a file, the text of the file is checked too
    targets : name or names of the programs that will read the file, see :data:`tir.targets.TARGETS`

    Raises
    ------
    TirError
        If a target is unknown.
    """
    programs = [known_target(name) for name in ([targets] if isinstance(targets, str) else targets)]
    tyre, of_units = in_fitting_units(tyre)
    found = [
        *tyre.on_reading,
        *_dimensions(tyre),
        *broken(tyre, SINGLE),
        *_ranges(tyre),
        *_mode(tyre),
        *_old_keys(tyre),
        *_own_judgement(tyre),
    ]
    if "USE_MODE" in tyre.present and tyre.turn_slip and (not programs or any(p.siemens for p in programs)):
        found.append(_warning("USE_MODE", LICENCE))
    if not any(problem.level == "error" for problem in found):
        with np.errstate(all="ignore"):
            ranged = (_with_origin(problem, tyre) for problem in over_the_range(tyre))
            found += [*broken(tyre, SHAPES), *ranged, *_clamps(tyre), *_moments(tyre)]
            if tyre["VERTICAL_STIFFNESS"]:
                found += [*_radius(tyre), *_spin(tyre)]
    for target in programs:
        found += target_problems(tyre, target)
    found += of_units
    found = [_with_line(problem, tyre) for problem in found]
    return sorted(found, key=lambda problem: LEVELS.index(problem.level))


def _with_line(problem: Problem, tyre: Tyre) -> Problem:
    """The problem with the line of the file that holds its key, or its unit."""
    lines = () if problem.line is not None or tyre.document is None else tyre.document.entries
    for line in lines:
        if line.key == problem.name and (line.section == "UNITS") == (problem.name in KINDS):
            return replace(problem, sentence=f"line {line.number}: {problem.sentence}", line=line.number)
    return problem


def _with_origin(problem: Problem, tyre: Tyre) -> Problem:
    """The problem with the origin of its coefficient, where the file states it: it may not have been measured."""
    origin = tyre.status.get(problem.name)
    return replace(problem, sentence=f"{problem.sentence} ({problem.name}: {origin})") if origin else problem


def _error(name: str, sentence: str) -> Problem:
    return Problem("error", sentence, name)


def _warning(name: str, sentence: str) -> Problem:
    return Problem("warning", sentence, name)


def _dimensions(tyre: Tyre) -> Iterator[Problem]:
    R0 = tyre["UNLOADED_RADIUS"]
    smallest, largest = constants.LENGTH_RANGE
    if not smallest < R0 < largest:
        units = {"centimetres": 100.0, "millimetres": 1000.0}
        fits = [unit for unit, factor in units.items() if smallest < R0 / factor < largest]
        hint = f"it looks like {' or '.join(fits)}" if fits else "a radius in metres was expected"
        yield _error("UNLOADED_RADIUS", f"UNLOADED_RADIUS is {R0:g}: {hint}; correct it or [UNITS] LENGTH")
    if tyre["RIM_RADIUS"] >= R0:
        said = f"RIM_RADIUS {tyre['RIM_RADIUS']:g} is not smaller than UNLOADED_RADIUS {R0:g}"
        yield _warning("RIM_RADIUS", said)
    switches = Switches(tyre.turn_slip)
    for name in (*DIVISORS, "INFLPRES"):
        if tyre[name] == 0 and name in DIVISORS and not that_need(name, switches, Forces._fields):
            need = some(that_need(name, switches, State._fields))
            yield _warning(
                name,
                f"{name} is 0: no force needs it with turn slip off, but {need} and turn slip do; give its value",
            )
        elif tyre[name] <= 0:
            remedy = "reverse its sign" if tyre[name] < 0 else "give its value"
            yield _error(name, f"{name} is {tyre[name]:g}, but it must be positive; {remedy}")
    if 0.0 < tyre["VERTICAL_STIFFNESS"] * R0 < tyre["FNOMIN"]:
        yield _error(
            "VERTICAL_STIFFNESS",
            f"VERTICAL_STIFFNESS is {tyre['VERTICAL_STIFFNESS']:g} N/m: under FNOMIN the tyre would deflect by more than its "
            "radius; it looks like N/mm, write N/m",
        )
    scaled = [row.name for row in TABLE if row.scaling and tyre[row.name] != 1.0]
    if scaled:
        said = f"scaling factors differ from 1: {', '.join(scaled)}; fitted files have 1 throughout"
        yield _warning(scaled[0], said)
    if str(tyre["TYRESIDE"]).upper() not in SIDES:
        yield _warning("TYRESIDE", f"TYRESIDE is '{tyre['TYRESIDE']}': write one of {', '.join(SIDES)}")
    odd = [row.name for row in TABLE if row.odd and tyre[row.name]]
    if str(tyre["TYRESIDE"]).upper().startswith("SYM") and odd:
        yield _warning("TYRESIDE", f"TYRESIDE is symmetric, but the odd terms {', '.join(odd)} are not 0")


def _ranges(tyre: Tyre) -> Iterator[Problem]:
    for low, high in RANGES:
        if tyre[low] >= tyre[high]:
            at_fault = low if low in tyre.present else high
            yield _error(at_fault, f"{low} {tyre[low]:g} is not below {high} {tyre[high]:g}")
    if 0 < tyre["CAMMAX"] < constants.NARROW_CAMBER_RANGE and tyre["MC_CONTOUR_A"] > 0:
        yield _warning(
            "CAMMAX",
            f"CAMMAX is {np.degrees(tyre['CAMMAX']):.1f} deg on a motorcycle tyre: simulations limit camber to it silently",
        )
    low, high = sorted(("INFLPRES", "NOMPRES"), key=lambda name: float(tyre[name]))
    smallest, largest = constants.PRESSURE_RANGE
    if 0.0 < tyre[low] < smallest < tyre[high] or tyre[low] < largest < tyre[high]:
        yield _error(
            low,
            f"{high} {tyre[high]:g} Pa is {tyre[high] / tyre[low]:.3g} times {low} {tyre[low]:g} Pa: one is in another unit; "
            "write both in Pa",
        )
    stated = {"PRESMIN", "PRESMAX"} & tyre.present
    for name in ("INFLPRES", "NOMPRES"):
        if stated and not tyre["PRESMIN"] <= tyre[name] <= tyre["PRESMAX"]:
            yield _warning(
                name,
                f"{name} {tyre[name]:g} lies outside PRESMIN {tyre['PRESMIN']:g} to PRESMAX {tyre['PRESMAX']:g}: simulations "
                "limit the pressure to the range",
            )
    if tyre["FZMIN"] <= 1e3 * tyre["FNOMIN"] <= tyre["FZMAX"] and tyre["FNOMIN"] < tyre["FZMIN"]:
        yield _error("FNOMIN", f"FNOMIN is {tyre['FNOMIN']:g} N: it looks like kN; write newtons")
    elif not tyre["FZMIN"] <= tyre["FNOMIN"] <= tyre["FZMAX"]:
        yield _warning(
            "FZMAX",
            f"the nominal load {tyre['FNOMIN']:g} lies outside FZMIN {tyre['FZMIN']:g} to FZMAX {tyre['FZMAX']:g}",
        )
    if tyre["ALPMIN"] > 0 or tyre["CAMMIN"] > 0 or tyre["KPUMIN"] > 0:
        yield _error("ALPMIN", "the lower limits of slip and camber must not be positive")


def _clamps(tyre: Tyre) -> Iterator[Problem]:
    """Problems of ranges that vehicles exceed: simulations limit their inputs to the range."""
    Fz = float(tyre["FNOMIN"])
    alpha = np.linspace(0.0, 2.0 * constants.USUAL_SIDESLIP.rad, constants.POINTS_PER_CURVE)
    force = np.abs(tyre(Fz, alpha, turn_slip=False).Fy)
    peak = float(alpha[np.argmax(force)])
    if force.max() > 0.0 and tyre["ALPMAX"] < min(peak, constants.USUAL_SIDESLIP.rad):
        share = abs(tyre(Fz, float(tyre["ALPMAX"]), turn_slip=False).Fy) / float(force.max())
        yield _warning(
            "ALPMAX",
            f"simulations limit sideslip to ALPMAX, {np.degrees(tyre['ALPMAX']):.1f} deg, where the side force at nominal load "
            f"is {share:.0%} of its peak",
        )
    low, high = (share * tyre["FNOMIN"] for share in constants.LOADS_TO_REACH)
    if tyre["FZMAX"] < high:
        yield _warning(
            "FZMAX",
            f"simulations limit the load in the formulae to FZMAX, {tyre['FZMAX'] / tyre['FNOMIN']:.2f} times the nominal load",
        )
    if tyre["FZMIN"] > low:
        yield _warning(
            "FZMIN",
            f"below FZMIN, {tyre['FZMIN']:g} N, every simulation reduces forces and moments by a rule of its own",
        )


def _radius(tyre: Tyre) -> Iterator[Problem]:
    p = tyre.p
    ratio = float(tyre.state(float(p.FNOMIN)).Re) / p.UNLOADED_RADIUS
    smallest, largest = constants.EFFECTIVE_RADIUS_RANGE
    if not smallest < ratio < largest:
        said = f"the effective radius is {ratio:.2f} of the unloaded one: check BREFF, DREFF, FREFF, Q_RE0"
        yield _warning("BREFF", said)


def _mode(tyre: Tyre) -> Iterator[Problem]:
    """Contradictions between USE_MODE or FITTYP and the rest of the file."""
    mode, given = int(tyre["USE_MODE"]), "USE_MODE" in tyre.present
    turn_slip, road = tyre.turn_slip, mode // 100 % 10
    if tyre["USE_MODE"] != mode:
        said = f"USE_MODE is {tyre['USE_MODE']:g}, but only whole numbers are defined; write one"
        yield _warning("USE_MODE", said)
    elif UNKNOWN_DIGIT in use_mode_words(mode):
        yield _warning("USE_MODE", f"USE_MODE {mode} means {use_mode_words(mode)}: see the program's manual")
    if given and turn_slip and not any(row.name in tyre.present for row in BLOCK):
        yield _warning(
            "USE_MODE",
            f"USE_MODE {mode} asks for turn slip, but the file has no [{TURN_SLIP}]: a simulation estimates it",
        )
    round_section = tyre["MC_CONTOUR_A"] > 0
    if given and round_section != (road == 2) and road in (1, 2):
        tyre_is = "is" if round_section else "is not"
        yield _warning(
            "USE_MODE",
            f"USE_MODE {mode} means {use_mode_words(mode)}, but by MC_CONTOUR_A this {tyre_is} a motorcycle tyre",
        )
    if tyre["FITTYP"] not in FITTYPS:
        yield _error("FITTYP", f"FITTYP is {tyre['FITTYP']:g}, but only {fittyps_text()} are supported")
    if tyre["FITTYP"] in (60, 61):
        of_62 = [row for row in TABLE if row.files == "62" and row.name in tyre.present]
        newer = [row.name for row in of_62 if tyre[row.name] != row.default]
        if newer:
            said = f"FITTYP {tyre['FITTYP']:g} has no {', '.join(newer)}; programs ignore them"
            yield _warning("FITTYP", said)


def _old_keys(tyre: Tyre) -> Iterator[Problem]:
    old = [key for key in (name.partition(".")[2] for name in tyre.extra) if key in OLD_KEYS]
    if old:
        said = f"{', '.join(old)} are keys of MF 5.2, which MF 6 ignores: was an old file renamed?"
        yield _warning(old[0], said)


def _own_judgement(tyre: Tyre) -> Iterator[Problem]:
    if reasons := tyre.provenance.get(DISTRUSTED):
        yield _warning("", f"the file says of itself that it is not to be trusted: {reasons}")


def _spin(tyre: Tyre) -> Iterator[Problem]:
    p = tyre.p
    lowest = max(p.FZMIN, constants.LOWEST_SEARCHED_LOAD * p.FNOMIN)
    load = np.array([lowest, p.FZMAX])  # eps_gamma is linear between
    eps = normalise.camber_reduction(p, normalise.relative_load(p, load))
    if np.any(np.abs(eps - 1.0) < constants.EPS_GAMMA_NEAR_ONE) or np.ptp(np.sign(eps - 1.0)) > 0:
        said = "eps_gamma comes close to 1 within the load range; at 1 the turn-slip stiffness is infinite"
        yield _warning("PECP1", said)
    default = all(tyre[row.name] == row.default for row in BLOCK) and BLOCK[0].name in tyre.present
    if default and not _known_default(tyre, BLOCK[0].name):
        said = f"the {len(BLOCK)} turn-slip coefficients are the common defaults, not measurements"
        yield _warning(BLOCK[0].name, said)
    if p.MC_CONTOUR_A > 0.0 and (p.PECP1, p.PECP2) == (0.5, 0.0) and not _known_default(tyre, "PECP1"):
        said = "PECP1 is the common default 0.5, not a measurement: motorcycle tyres have about 0"
        yield _warning("PECP1", said)
    gamma = np.array([-1e-4, 1e-4])
    Fz = float(p.FNOMIN)
    with_spin, without = (float(np.diff(tyre(Fz, gamma=gamma, turn_slip=on).Fy)[0]) for on in (True, False))
    expected = without * p.UNLOADED_RADIUS / tyre.state(Fz).Re
    if without and not np.isclose(with_spin, expected, rtol=constants.NEGLIGIBLE_SHARE):
        yield _warning(
            "PHYP1",
            "the camber force with turn slip on differs from the one with turn slip off times R0/Re: check PHYP1-4",
        )


def _known_default(tyre: Tyre, name: str) -> bool:
    """Whether a file for turn slip off marks the coefficient as a default, as after an export."""
    return not tyre.turn_slip and tyre.status.get(name, "").startswith("default")


def _moments(tyre: Tyre) -> Iterator[Problem]:
    p = tyre.p
    first = any(tyre[f"QSX{i}"] for i in range(4, 12))
    second = any(tyre[f"QSX{i}"] for i in (12, 13, 14))
    if first and second:
        yield _warning(
            "QSX12",
            "QSX4-11 and QSX12-14 are both used, although they describe the same effect: set one group to 0",
        )
    step = np.array([-1e-3, 1e-3])
    if tyre["QDZ1"] and float(np.diff(tyre(float(p.FNOMIN), step, turn_slip=False).Mz)[0]) <= 0:
        said = "the aligning moment does not align at nominal load (dMz/dalpha should be positive in ISO-W)"
        yield _warning("QDZ1", said)
