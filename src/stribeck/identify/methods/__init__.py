"""Methods of fits: static laws by their columns, other laws by simulation."""
