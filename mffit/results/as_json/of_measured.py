"""JSON keys of the direct measurement: ``spin.json``, and the ``spin`` part of ``result.json``.

SI units, ISO signs, standard uncertainties (k = 1). ``spin.json`` also has ``made`` and the judgement; ``result.json`` has
these at its top level.
"""

from __future__ import annotations

from mffit.measured import KEYS, Alignment, Drift, LoadResult, Measured, SetupResult, SetupScatter
from mffit.measured.uncertain import Expanded
from mffit.results.values import keys, with_u

keys(
    LoadResult,
    f"load_N {' '.join(f'±{key}={name}' for name, key in KEYS.items())} "
    "epsilon_gamma_secant=epsilon_secant epsilon_gamma_secant_bias=secant_bias epsilon_gamma_slope=epsilon_slope "
    "epsilon_gamma_moment=epsilon_moment u_epsilon_gamma_moment ±epsilon_gamma_debiased=epsilon_debiased "
    "±alpha_M_deg ±alpha_0_deg=misalignment ±ply_steer_deg ±conicity_N F_forward_N F_backward_N",
    u_epsilon_gamma_moment=lambda _: None,
)
NO_LOAD = {"load_N": None, **{key: None for name in KEYS.values() for key in with_u(name, None)}}
"""The numbers at the nominal load if nothing was measured there."""

keys(
    Measured,
    "**judged **at_nominal epsilon_gamma_model ±epsilon_gamma_debiased pecp1 pecp2 u_pecp2 budget budgets "
    "expanded=nominal.expanded ±camber_skew_deg misaligned=axis_off coverage_factor setups setup_scatter drift notes "
    "per_load [made]",
    judged=lambda found: (
        {}
        if found.made is None
        else {"trusted": found.trusted, "reasons": found.reasons, "warnings": found.warnings}
    ),
    at_nominal=lambda found: found.nominal or NO_LOAD,
    coverage_factor=lambda _: 1,
    setups=lambda found: () if found.nominal is None else found.nominal.setups,
)
keys(Drift, "scatter chance least most apart")
keys(Expanded, "U_epsilon_gamma=U coverage_factor=k coverage_probability=probability effective_dof=dof")
keys(
    SetupResult,
    "setup=name path_centre path_radius_m ±F_phit_N ±C_phit_Nm ±epsilon_gamma ±alpha_M_deg misaligned",
    path_centre=lambda row: "left" if row.phi_t < 0.0 else "right",
    path_radius_m=lambda row: abs(1.0 / row.phi_t),
)
keys(SetupScatter, "load_N setups between_N degrees_of_freedom declared_N chance excess_N")
keys(Alignment, "correction_deg u_correction_deg=u_deg u_axis_deg aligned steps warnings")
