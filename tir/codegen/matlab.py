"""A tyre as one vectorised MATLAB function, from the same equations; Octave runs it too."""

import re
import textwrap
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import NamedTuple, Unpack

from tir.codegen.graph import CONSTANT, INPUT, level
from tir.codegen.program import INPUTS, ORDER, Program, called
from tir.codegen.replay import allocated
from tir.codegen.source import COMMON, COMPARISONS, SourceDialect, assignments, name_of
from tir.equations.forces import Forces
from tir.errors import TirError
from tir.exporting import INPUT_TEXTS, OUTPUT_TEXTS, STATES, ExportedTyre, exported, refuse_name
from tir.mode import SwitchOptions
from tir.record import TyreRecord

MORE = {
    "mu_x": "longitudinal friction coefficient [-]",
    "mu_y": "lateral friction coefficient [-]",
    "residual_torque": "residual torque, part of Mz [Nm]",
}
"""States in MFeval's columns, in addition to those of other exports."""
STATE_TEXTS = {name: OUTPUT_TEXTS[name] for name in STATES} | MORE
COLUMNS = (
    "r.Fx", "r.Fy", "r.Fz", "r.Mx", "r.My", "r.Mz", "in(:, 2)", "in(:, 3)", "in(:, 4)", "in(:, 5)", "in(:, 6)", "p",
    "s.Re", "", "", "s.trail", "s.mu_x", "s.mu_y", "s.omega", "", "", "s.residual_torque", "abs(s.K_xk) ./ s.sigma_x",
    "abs(s.K_ya) ./ s.sigma_y", "", "s.K_ya", "s.sigma_x", "s.sigma_y", "", "s.K_xk",
)  # fmt: skip
"""MFeval's outputs in their order; empty where the model does not compute one."""
KEYWORDS = {
    "break", "case", "catch", "classdef", "continue", "else", "elseif", "end", "for", "function", "global", "if", "otherwise",
    "parfor", "persistent", "return", "spmd", "switch", "try", "while",
}  # fmt: skip
CALLED = {
    "abs", "acos", "atan", "cos", "double", "error", "exp", "nan", "nargin", "numel", "power", "sin", "size", "sqrt", "struct",
    "tan", "zeros",
}  # fmt: skip
"""Functions that the code calls: a file of that name would replace them."""
CONSTANTS = {"ans", "eps", "false", "i", "inf", "j", "pi", "true"}
"""What a file of that name would replace in other code of the user."""
LONGEST_NAME = 63 - len("_mfeval")
"""MATLAB cuts names after 63 characters, also that of the second function."""
GIVEN = ", ".join(map(called, ORDER))
"""Arguments of the function but for the last one, tuning."""
MATLAB = SourceDialect(
    {
        **COMMON,
        "multiply": "({} .* {})",
        "divide": "({} ./ {})",
        "both": "({} & {})",
        "power": "power({}, {})",
        "where": "choose({}, {}, {})",
        "either": "({2} - {1} .* {0})",
    },
    truth=("false", "true"),
    number="{} = {};",
    beyond=("Inf", "NaN"),
)


PRAGMA = ("", "%#codegen")
"""Marker for MATLAB's code generation; it follows the help text, which Octave would not find behind it."""
VARIABLE = re.compile(r"\bv\d+\b")


class MatlabCode(NamedTuple):
    """Text of two MATLAB functions."""

    function: str  #: ``<name>.m``
    mfeval: str  #: ``<name>_mfeval.m``, the same with the columns of MFeval


def export_matlab(
    tyre: TyreRecord,
    *,
    name: str = "tyre",
    origin: str = "",
    **switches: Unpack[SwitchOptions],
) -> MatlabCode:
    """The tyre as a MATLAB function of arrays: ``[r, s, tuning] = name(Fz, kappa, alpha, gamma, phi_t, Vx, p, tuning)``.

    ``r`` is a structure of the forces and moments (ISO-W, SI, radians), ``s`` of stiffnesses, relaxation lengths, radii and
    friction, ``tuning`` of the scaling factors. Inputs are scalars or arrays whose sizes expand to one another; those left out at
    the end are 0, or LONGVL, INFLPRES and the factors of the file. Needs MATLAB R2016b, for code generation R2021b, or Octave.

    Parameters
    ----------
    tyre : its values become constants of the code
    name : of the function and its file
    origin : a line for the help text, such as the name of the property file
    switches : ``turn_slip``: whether spin acts, default: if the units digit of the file's USE_MODE is 5; ``star``, ``limits``:
        as in a call of the tyre

    Returns
    -------
    MatlabCode
        The function, and a second one with the columns of MFeval that calls it.

    Raises
    ------
    TirError
        If the name is invalid, taken or too long in MATLAB, or a value by which the equations divide is 0.
    """
    refuse_name(name, "MATLAB", taken)
    if len(name) > LONGEST_NAME:
        raise TirError(
            f"{name!r} is longer than the {LONGEST_NAME} characters that MATLAB leaves: use a shorter name"
        )
    outputs = (*Forces._fields, *STATE_TEXTS)
    made = exported(tyre, outputs, **switches)
    one_line = " ".join(origin.encode("ascii", "replace").decode().split())
    usual = {"Vx": MATLAB.literal(float(tyre["LONGVL"])), "pressure": MATLAB.literal(float(tyre["INFLPRES"]))}
    turn_slip, star, limits = made.switches
    use = (2 - limits) * 100 + (1 + star) * 10 + 1 + turn_slip
    about = [*made.opening, *filter(None, [one_line])]
    function = [*_help(name, made, about), *_entry(name, made, usual), *_evaluation(made.program(outputs))]
    return MatlabCode(_text(function), _mfeval(name, about[2:], use, usual["pressure"]))


def _help(name: str, made: ExportedTyre, about: Sequence[str]) -> list[str]:
    """The head of the function, and its help text."""
    texts = {
        "": {called(key): INPUT_TEXTS[key] for key in ORDER},
        "r.": {key: OUTPUT_TEXTS[key] for key in Forces._fields},
        "s.": STATE_TEXTS,
        "tuning.": {one.name: one.description for one in made.turned},
    }
    return [
        f"function [r, s, tuning] = {name}({GIVEN}, tuning)",
        f"%{name}  Forces and moments of a tyre.",
        f"%   [r, s, tuning] = {name}({GIVEN}, tuning)",
        *(f"%   {line}" for line in about),
        "%",
        "%   Inputs are scalars or arrays whose sizes expand to one another. Those left out at the end are 0; Vx, p and",
        f"%   tuning are then as in the file. Another factor: [~, ~, t] = {name}(1000); t.LMUY = 0.8; then give t last.",
        *(f"%   {start + key:<18}{text}" for start, rows in texts.items() for key, text in rows.items()),
        *PRAGMA,
    ]


def _entry(name: str, made: ExportedTyre, usual: Mapping[str, str]) -> list[str]:
    """The body of the function: what is left out is completed, and sizes are made equal."""
    factors = {one.name: MATLAB.literal(one.start) for one in made.turned}
    return [
        f"file = {_struct(factors)};",
        *(
            f"if nargin < {i}, {called(key)} = {usual.get(key, '0')}; end"
            for i, key in enumerate(ORDER[1:], start=2)
        ),
        f"if nargin < {len(ORDER) + 1}, tuning = file; end",
        "both = [file, tuning]; %#ok<NASGU> a field that is missing, or that the file does not have, ends here",
        f"if numel([{', '.join(f'tuning.{key}' for key in factors)}]) ~= {len(factors)}",
        f"    error('{name}:tuning', 'a factor in tuning is not a scalar');",
        "end",
        f"z = zeros(size({GIVEN.replace(', ', ' + ')}));",
        f"[r, s] = evaluate({', '.join(f'double({called(key)}) + z' for key in INPUTS)}, tuning);",
        "end",
        "",
    ]


def _evaluation(program: Program) -> list[str]:
    """The functions behind the entry."""
    return [
        f"function [r, s] = evaluate({', '.join(map(called, INPUTS))}, tuning)",
        *_body(program),
        "end",
        "",
        "function r = choose(c, a, b)",
        "% a where c is true, else b",
        "r = b + zeros(size(c));",
        "if numel(a) == 1, r(c) = a; else, r(c) = a(c); end",
        "end",
    ]


def taken(name: str) -> bool:
    """Whether MATLAB has the word or the code calls such a function. Some file systems ignore case."""
    return name.lower() in KEYWORDS | CALLED | CONSTANTS


def _body(program: Program) -> list[str]:
    """Lines that compute both structures from inputs of one size."""
    for node in program.per_point:
        chosen, a, b = node.arguments if node.operation == "where" else (None, None, None)
        if level(a) == level(b) == CONSTANT and chosen is not None and a == -b:
            node.operation, node.arguments = "either", (chosen, b - a, b)  # much faster than a call
    once, _ = assignments(program.per_tyre, program.constants, MATLAB)
    each, results = assignments(program.per_point, program.outputs.values(), MATLAB)
    flags = {name_of(node) for node in program.per_point if node.operation in COMPARISONS}
    constants = {name_of(node) for node in program.constants}
    each, results = _reusing(each, results, flags, constants)
    sized = [
        text if level(x) == INPUT else f"{text} + zeros(size(Fz))"
        for x, text in zip(program.outputs.values(), results, strict=True)
    ]
    found = dict(zip(program.outputs, sized, strict=True))
    return [
        *(f"{key} = tuning.{key};" for key in program.parameters),
        *once,
        *each,
        f"r = {_struct({key: found[key] for key in Forces._fields})};",
        f"s = {_struct({key: found[key] for key in STATE_TEXTS})};",
    ]


def _struct(fields: Mapping[str, str]) -> str:
    return f"struct({', '.join(f'{key!r}, {text}' for key, text in fields.items())})"


def _reusing(
    lines: Sequence[str], results: Sequence[str], flags: Collection[str], constants: Collection[str]
) -> tuple[list[str], list[str]]:
    """The lines with few variables, each used again after its last reading: a million conditions then fit into memory.

    ``flags`` hold truth values and never share a variable with numbers; ``constants`` keep their names.
    """
    targets, expressions = zip(*(line.split(" = ", 1) for line in lines), strict=True)
    kept = frozenset([*constants, *VARIABLE.findall(" ".join(results))])
    place: dict[str, int] = {}
    used = [sorted({*VARIABLE.findall(text)}) for text in expressions]
    allocated(targets, used, kept, place, flags.__contains__)

    def renamed(text: str) -> str:
        return VARIABLE.sub(
            lambda found: found[0] if found[0] in constants else f"x{place[found[0]] + 1}", text
        )

    return [*map(renamed, lines)], [*map(renamed, results)]


def _mfeval(name: str, about: Sequence[str], use: int, pressure: str) -> str:
    """The function with MFeval's columns, for scripts that call MFeval."""
    missing = ", ".join(str(i) for i, column in enumerate(COLUMNS, start=1) if not column)
    return _text(
        [
            f"function out = {name}_mfeval(in, useMode)",
            f"%{name}_mfeval  The tyre of {name}.m with the columns of MFeval.",
            f"%   out = {name}_mfeval([Fz kappa alpha gamma phit Vx P omega], {use}) has the 30 columns of MFeval 4; rows are",
            "%   conditions. P and omega may be left out. omega is not used: the speed of rotation follows from kappa and Vx.",
            f"%   Columns {missing} are NaN, because {name}.m does not compute them: deflection, contact",
            "%   length and width, loaded radius, vertical stiffness, instantaneous cornering stiffness. Columns 7 to 12 are",
            "%   the inputs as given.",
            f"%   useMode may be left out; only {use} is accepted, because turn slip and limits are fixed in {name}.m.",
            *(f"%   {line}" for line in about),
            *PRAGMA,
            f"if nargin > 1 && useMode ~= {use}",
            f"    error('{name}:useMode', ['this tyre was exported for useMode {use}. For another one, mffit export ', ...",
            "        'matlab FILE.tir: its first digit is 1 with --limits, else 2; its last is 2 with --turn-slip, 1 ', ...",
            "        'with --no-turn-slip; for 2 in the middle, tir.export_matlab(tyre, star=True)']);",
            "end",
            f"p = {pressure} + zeros(size(in, 1), 1);",
            "if size(in, 2) > 6, p = in(:, 7); end",
            "none = NaN(size(in, 1), 1);",
            f"[r, s] = {name}(in(:, 1), in(:, 2), in(:, 3), in(:, 4), in(:, 5), in(:, 6), p);",
            f"out = [{', '.join(column or 'none' for column in COLUMNS)}];",
            "end",
        ]
    )


def _text(lines: Iterable[str]) -> str:
    """The lines of a file, long statements continued."""
    wrapper = textwrap.TextWrapper(120, break_long_words=False, break_on_hyphens=False)
    broken = (line if line.startswith("%") else " ...\n    ".join(wrapper.wrap(line)) for line in lines)
    return "\n".join([*broken, ""])
