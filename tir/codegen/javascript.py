"""The model as JavaScript, for pages that evaluate tyres without Python."""

from tir.codegen.program import INPUTS, Switches, called, trace
from tir.codegen.source import COMMON, FUNCTIONS, SourceDialect, assignments
from tir.equations.forces import Forces

JAVASCRIPT = SourceDialect(
    {
        **COMMON,
        **{name: f"Math.{COMMON[name]}" for name in (*FUNCTIONS, "absolute")},
        "where": "({} ? {} : {})",
        "both": "({} && {})",
    },
    truth=("false", "true"),
    beyond=("Infinity", "NaN"),
    number="const {} = {};",
)


def javascript(
    outputs: tuple[str, ...] = Forces._fields,
    *,
    turn_slip: bool = True,
    star: bool = False,
    limits: bool = False,
) -> str:
    """The model, for any tyre, as one JavaScript expression.

    Its value is a function of the tyre's parameters (an object by name) that returns a function of
    :data:`~tir.codegen.program.INPUTS` in this order, named as in a call (ISO-W, SI, radians), which returns an object of the
    ``outputs``: fields of Forces and State, or RL, the loaded radius [m].
    """
    program = trace(Switches(turn_slip, star, limits), outputs)
    once, _ = assignments(program.per_tyre, program.constants, JAVASCRIPT)
    each, results = assignments(program.per_point, program.outputs.values(), JAVASCRIPT)
    given = ", ".join(program.parameters)
    found = ", ".join(f"{name}: {text}" for name, text in zip(program.outputs, results, strict=True))
    return "\n".join(
        [
            "values => {",
            f"  const {{{given}}} = values;",
            *(f"  {line}" for line in once),
            f"  return ({', '.join(map(called, INPUTS))}) => {{",
            *(f"    {line}" for line in each),
            f"    return {{{found}}};",
            "  };",
            "}",
        ]
    )
