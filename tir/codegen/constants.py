"""Numbers of judgement of the generated code."""

from tir.constant import Count

VECTOR_LANES = Count(
    8,
    "-",
    "Conditions computed together: doubles of the widest common vector (AVX-512). Half on processors with narrower vectors, "
    "whose registers more would fill.",
    "tests/benchmarks/speed.py",
)
LONGEST_INLINED_EXPRESSION = Count(
    400, "-", "Longest expression in characters that is written inside another one."
)
DIVISION_TAKES = Count(
    4,
    "-",
    "A division or a root in a vector, in other operations one after the other; orders the instructions.",
)
