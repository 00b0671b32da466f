"""The MF-6.2 steady-state equations, each written once.

Plain functions of ``(p, inputs)``: ``p`` is any object with the file's parameter names as attributes, the inputs are
scalars or arrays that broadcast. Only the elementary functions of :mod:`tir.equations.elementary` are called, so complex
numbers pass through (complex-step derivatives) and the functions can be compiled from outside.

Equation numbers: ``4.E..`` is Pacejka, Tire and Vehicle Dynamics, 3rd ed.; ``A..`` is the appendix of Besselink,
Schmeitz and Pacejka, Vehicle System Dynamics 48 (2010), 337-352. Where public sources disagree the choice and its reason
are in docs/equations.md. Axes and signs: see :mod:`tir.conventions`.
"""
