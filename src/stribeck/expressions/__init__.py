"""Equations as plain functions: the operations they use, the graph they become, and code from it."""
