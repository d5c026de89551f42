"""Sweeps: many runs of one scenario into a folder or an object store, here or on a cluster."""
