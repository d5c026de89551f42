"""The way to python-control by the name that the documentation gave it first."""

from stribeck.export.python.python_control import response

__all__ = ["response"]
