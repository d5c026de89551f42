"""A machine's controller, or its friction compensation, as equations of one sample."""
