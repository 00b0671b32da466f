"""Straight-line code made from the equations: for Python floats, numpy, the processor, C and others.

The equations are run once on :class:`~tir.codegen.graph.Node` numbers, which note every elementary operation; what they
noted is written down again in another language. No formula stands here.
"""
