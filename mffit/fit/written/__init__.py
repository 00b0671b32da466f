"""The files that leave: with turn slip, without it, their ranges and what the one misses of the other."""
