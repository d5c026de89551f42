"""Whole machines: part ``machine`` of the targets c and fmu, and the target python."""

from stribeck.export.request import Target

TARGET = Target("python", "machine.python", "a Python program that SciPy runs", ("machine",), folder=False)
