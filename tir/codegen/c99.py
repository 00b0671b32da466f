"""A tyre as one self-contained C99 header and source, from the same equations."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple, Unpack

from tir.codegen.lag import LAG_INPUTS, LAG_TEXTS, LAGGING, lag_programs
from tir.codegen.program import INPUTS, Program, called
from tir.codegen.source import COMMON, SourceDialect, assignments
from tir.equations.forces import Forces
from tir.exporting import INPUT_TEXTS, OUTPUT_TEXTS, STATES, ExportedTyre, exported, refuse_name
from tir.mode import SwitchOptions
from tir.record import TyreRecord

WORDS = {
    "auto", "break", "case", "char", "const", "continue", "default", "do", "double", "else", "enum",
    "extern", "float", "for", "goto", "if", "inline", "int", "long", "register", "restrict", "return",
    "short", "signed", "sizeof", "static", "struct", "switch", "typedef", "union", "unsigned", "void",
    "volatile", "while",
}  # fmt: skip
HEADERS = {
    "assert", "complex", "ctype", "errno", "fenv", "float", "inttypes", "iso646", "limits", "locale",
    "math", "setjmp", "signal", "stdalign", "stdarg", "stdatomic", "stdbool", "stddef", "stdint", "stdio",
    "stdlib", "stdnoreturn", "string", "tgmath", "threads", "time", "uchar", "wchar", "wctype",
}  # fmt: skip
"""Headers of the standard library: a file of the same name next to the source would be included instead."""
C = SourceDialect(
    {
        **COMMON,
        "where": "({} ? {} : {})",
        "both": "({} && {})",
        "absolute": "fabs({})",
    },
    truth=("0", "1"),
    beyond=("INFINITY", "NAN"),
    number="const double {} = {};",
    flag="const int {} = {};",
    inline=False,
)


KINDS = {"forces": ("evaluate", Forces._fields), "state": ("evaluate_state", STATES)}
"""Functions of the operating condition and the fields of their records, by the name of the record."""

IN_VECTORS = """\
#if defined(__x86_64__) && defined(__GLIBC__) && !defined(__clang__) && !defined(__cplusplus)
#if __GLIBC_PREREQ(2, 35)
/* Its functions of vectors, in libmvec, and what gcc needs to use them; values of single conditions stay. */
#define IN_VECTORS __attribute__((flatten))
#define VECTOR __attribute__((__simd__("notinbranch"), __const__))
__attribute__((__const__)) extern double sqrt(double);
VECTOR extern double sin(double);
VECTOR extern double cos(double);
VECTOR extern double tan(double);
VECTOR extern double atan(double);
VECTOR extern double acos(double);
VECTOR extern double exp(double);
VECTOR extern double pow(double, double);
#endif
#endif
"""
"""With it gcc -O3 computes the loop of many conditions in vectors; any other compiler computes one after the other."""


class Code(NamedTuple):
    """Text of a C module."""

    header: str  #: ``<name>.h``
    source: str  #: ``<name>.c``


def export_c(
    tyre: TyreRecord,
    *,
    name: str = "tyre",
    tunable: bool = False,
    lag: bool = False,
    **switches: Unpack[SwitchOptions],
) -> Code:
    """The tyre as C99: one function of the operating condition, no allocation, no state, doubles only.

    Parameters
    ----------
    tyre : its values become constants of the code
    name : name of the files, and prefix of the names inside
    tunable : also ``<name>_evaluate_tuned`` and ``<name>_evaluate_state_tuned``, whose first argument points to a
        ``<name>_tuning`` of the scaling factors, and of the temperature if the file has terms for it; ``<name>_as_in_file()``
        returns their values in the file
    lag : also the lag of the contact, see :mod:`tir.transient`, with the same tuning: ``<name>_step`` returns the
        deflection after a step of time, ``<name>_contact`` forces and states of a deflection
    switches : ``turn_slip``: whether spin acts, default: if the units digit of the file's USE_MODE is 5; ``star``, ``limits``:
        as in a call of the tyre

    Returns
    -------
    Code
        Header and source. ``<name>_evaluate(Fz, alpha, gamma, kappa, phi_t, Vx, p)`` returns the forces in ISO-W,
        ``<name>_evaluate_state`` stiffnesses, relaxation lengths and radii, as structures; ``<name>_evaluate_many`` fills arrays.

    Raises
    ------
    TirError
        If the name is invalid or reserved in C, a value is not finite, or a value by which the equations divide is 0.
    """
    refuse_name(name, "C", taken)
    outputs = [field for _, fields in KINDS.values() for field in fields]
    made = exported(tyre, outputs, **switches)
    text = _Text(name, *_openings(name, made))
    for kind, (_, fields) in KINDS.items():
        text.record(kind, {field: OUTPUT_TEXTS[field] for field in fields})
    for kind, (function, fields) in KINDS.items():
        text.function(function, kind, made.program(fields, tuned=False), INPUTS)
    _add_many(text)
    if tunable or lag:
        _add_tuning(text, made)
    if lag:
        _add_lag(text, lag_programs(made.parameters, made.switches, STATES))
    end = ["#ifdef __cplusplus", "}", "#endif", "#endif", ""]
    return Code("\n".join([*text.header, *end]), "\n".join(text.source))


class _Text(NamedTuple):
    """Lines of header and source; every name begins with that of the tyre."""

    name: str
    header: list[str]
    source: list[str]

    def record(self, kind: str, texts: Mapping[str, str]) -> None:
        """Declare a structure of doubles, with what each is."""
        self.header.append("typedef struct {")
        self.header.extend(f"    double {field}; /* {text} */" for field, text in texts.items())
        self.header.extend([f"}} {self.name}_{kind};", ""])

    def function(
        self, function: str, kind: str, program: Program, inputs: Sequence[str], *, tuned: bool = False
    ) -> None:
        """Declare and define a function that returns a record."""
        function = f"{self.name}_{function}"
        given = [f"const {self.name}_tuning *tuning"] * tuned + [f"double {called(x)}" for x in inputs]
        head = f"{self.name}_{kind} {function}({', '.join(given)})"
        lines, results = assignments((*program.per_tyre, *program.per_point), program.outputs.values(), C)
        used = {node.name for node in program.per_point if node.operation == "symbol"}
        self.header.append(f"{head};")
        self.source.extend(
            [
                head,
                "{",
                *(f"    (void){called(x)};" for x in inputs if x not in used),
                *(["    (void)tuning;"] if tuned and not program.parameters else []),
                *(f"    const double {x} = tuning->{x};" for x in program.parameters),
                *(f"    {line}" for line in lines),
                f"    {self.name}_{kind} out;",
                *(f"    out.{field} = {text};" for field, text in zip(program.outputs, results, strict=True)),
                "    return out;",
                "}",
                "",
            ]
        )


def _add_many(text: _Text) -> None:
    """The function that computes the forces of many conditions."""
    inputs, forces = [*map(called, INPUTS)], [f"{force}_out" for force in Forces._fields]
    arrays = [*(f"const double *{x}" for x in inputs), *(f"double *{x}" for x in forces)]
    head = f"void {text.name}_evaluate_many(size_t n, {', '.join(arrays)})"
    text.header.extend(
        ["", "/* Of n conditions; no array of results may overlap another. */", f"{head};", ""]
    )
    text.source.extend(
        [
            "#ifdef IN_VECTORS",
            "IN_VECTORS",
            "#endif",
            head,
            "{",
            "#ifdef IN_VECTORS",
            "#pragma GCC ivdep",
            "#endif",
            "    for (size_t i = 0; i < n; i++) {",
            f"        const {text.name}_forces out = {text.name}_evaluate({', '.join(f'{x}[i]' for x in inputs)});",
            *(f"        {x}[i] = out.{field};" for x, field in zip(forces, Forces._fields, strict=True)),
            "    }",
            "}",
            "",
        ]
    )


def _add_tuning(text: _Text, made: ExportedTyre) -> None:
    """The tunable numbers, their values in the file, and the functions that take them."""
    text.record("tuning", {one.name: one.description for one in made.turned})
    head = f"{text.name}_tuning {text.name}_as_in_file(void)"
    text.header.append(f"{head};")
    starts = ", ".join(C.literal(one.start) for one in made.turned)
    text.source.extend([head, "{", f"    {text.name}_tuning out = {{{starts}}};", "    return out;", "}", ""])
    for kind, (function, fields) in KINDS.items():
        text.function(f"{function}_tuned", kind, made.program(fields), INPUTS, tuned=True)
    text.header.append("")


def _add_lag(text: _Text, programs: tuple[Program, Program]) -> None:
    """The deflection after a step, and forces and states of a deflection."""
    texts = {**OUTPUT_TEXTS, **LAG_TEXTS}
    functions = (("step", "deflection", ("dt",)), ("contact", "deflected", ()))
    for (_, kind, _), program in zip(functions, programs, strict=True):
        text.record(kind, {field: texts[field] for field in program.outputs})
    text.header.extend(
        [
            f"/* {text.name}_step: the deflection after a step of dt [s] >= 0, from u and v before it; zero at rest.",
            f"   {text.name}_contact: forces and states with these u and v.",
            *(f"   {called(key):<9}{LAG_TEXTS[key]}" for key in LAG_INPUTS if key in LAG_TEXTS),
            "*/",
        ]
    )
    for (function, kind, first), program in zip(functions, programs, strict=True):
        inputs = (*first, *LAGGING, *LAG_INPUTS)
        text.function(function, kind, program, inputs, tuned=True)
    text.header.append("")


def taken(name: str) -> bool:
    """Whether C or its library uses the name. Some file systems ignore case, so Math.h would replace math.h."""
    return name in WORDS or name.lower() in HEADERS


def _openings(name: str, made: ExportedTyre) -> tuple[list[str], list[str]]:
    """First lines of header and source."""
    guard = f"{name.upper()}_H"
    first, second = made.opening
    header = [
        f"/* {first}",
        f"   {second}",
        "",
        *(f"   {called(key):<9}{INPUT_TEXTS[key]}" for key in INPUTS),
        "*/",
        f"#ifndef {guard}",
        f"#define {guard}",
        "#include <stddef.h>",
        "#ifdef __cplusplus",
        'extern "C" {',
        "#endif",
        "",
    ]
    source = [
        "/* Generated by tir; do not edit. C99, needs the mathematics library (-lm). */",
        f'#include "{name}.h"',
        "#include <math.h>",
        "",
        IN_VECTORS,
    ]
    return header, source
