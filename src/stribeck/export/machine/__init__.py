"""Whole machines: part ``machine`` of the targets c and fmu."""

TARGET = None  # a part of theirs
