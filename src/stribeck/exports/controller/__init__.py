"""A machine's controller, or what it does against friction, as equations of one sample."""
