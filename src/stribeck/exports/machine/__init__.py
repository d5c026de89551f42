"""Whole machines: part ``machine`` of the targets c and fmu."""
