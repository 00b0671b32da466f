"""A tyre as a function of CasADi, with its exact derivatives, from the same equations. Imports casadi on first use."""

from collections.abc import Sequence
from typing import Any, Unpack

from tir.codegen.library import operations_of, run
from tir.codegen.program import called
from tir.equations.forces import Forces
from tir.errors import TirError
from tir.exporting import exported
from tir.mode import SwitchOptions
from tir.record import TyreRecord


def casadi_function(
    tyre: TyreRecord,
    *,
    name: str | None = None,
    outputs: tuple[str, ...] = Forces._fields,
    tunable: Sequence[str] = (),
    **switches: Unpack[SwitchOptions],
) -> Any:
    """The tyre as a ``casadi.Function`` of Fz, alpha, gamma, kappa, phi_t, Vx, p (ISO-W, SI, radians).

    An input that a call by name omits has the start value of an FMU: FNOMIN, LONGVL, INFLPRES, the factors of the file, else 0.

    Parameters
    ----------
    tyre : its values become constants
    name : name of the function; default ``tyre_turn_slip`` with turn slip, else ``tyre``
    outputs : fields of Forces and State, one output each, in this order
    tunable : scaling factors, and ``T_degC`` if the file has temperature terms, that become further inputs, in this order
    switches : ``turn_slip``: whether spin acts, default: if the units digit of the file's USE_MODE is 5; ``star``, ``limits``:
        as in a call of the tyre

    Raises
    ------
    TirError
        If casadi is not installed (``pip install casadi``), a value by which the equations divide is 0, a name cannot be turned,
        or an output is unknown.
    """
    try:
        import casadi
    except ImportError:
        raise TirError("casadi_function needs casadi, which is not installed: pip install casadi") from None
    made = exported(tyre, outputs, tunable, **switches)
    program = made.program(outputs)
    starts = made.starts
    inputs = {key: casadi.SX.sym(called(key)) for key in starts}
    results = run(program, operations_of(casadi, casadi.if_else, both=casadi.logic_and), inputs)
    options: dict[str, Any] = {
        "allow_duplicate_io_names": True,  # Fz is an input, and an output within the limits
        "default_in": [*starts.values()],
    }
    name = name or ("tyre_turn_slip" if made.switches.turn_slip else "tyre")
    given = [*map(called, inputs)]
    return casadi.Function(name, [*inputs.values()], [*map(casadi.SX, results)], given, [*outputs], options)
