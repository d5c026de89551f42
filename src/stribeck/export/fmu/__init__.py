"""Functional mock-up units."""

from stribeck.export.request import Target

TARGET = Target(
    "fmu", "fmu.archive", "an FMU for FMI 2.0 and 3.0",
    ("law", "body", "machine", "controller", "compensator"), folder=False, loads=True,
)  # fmt: skip
