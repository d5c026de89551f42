"""A whole machine for other tools: its C with its sampled controllers and the solver, and that as an FMU."""

TARGET = None  # a part of the targets c and fmu
