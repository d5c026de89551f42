"""C99 for firmware."""

from stribeck.export.request import Target

TARGET = Target(
    "c",
    "c.c99",
    "C99 for a drive's firmware",
    ("law", "body", "observer", "machine", "controller", "compensator"),
    self_test=True,
    loads=True,
)
