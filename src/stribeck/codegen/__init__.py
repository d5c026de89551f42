"""A system of equations -> straight-line C: the only place that writes code for the simulator."""

from stribeck.codegen.source import source

__all__ = ["source"]
