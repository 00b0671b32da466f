"""Straight-line code made from the equations: for Python floats, numpy, the processor, C and others.

The equations run once on :class:`~tir.codegen.graph.Node` numbers, which record every elementary operation. The recorded
operations are then written in another language. This package contains no formula.
"""
