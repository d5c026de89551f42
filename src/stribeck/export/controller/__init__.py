"""A machine's controller, or what it does against friction, for its target: C99, FMU, a table, and a plugin of MuJoCo."""
