"""Machines: bodies, and elements between them, as one system of equations (docs/reference/machines.md)."""
