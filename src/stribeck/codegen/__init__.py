"""A system of equations -> straight-line C: the only place that writes code for the simulator."""

from stribeck.codegen.source import SAME, parameter_names, source, with_columns

__all__ = ["SAME", "parameter_names", "source", "with_columns"]
