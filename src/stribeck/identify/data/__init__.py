"""Measured logs: reading, units, quality, filters."""
