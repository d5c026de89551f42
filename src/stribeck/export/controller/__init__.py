"""A machine's controller, or what it does against friction, for its target: C99, Structured Text, FMU and what hosts them."""
