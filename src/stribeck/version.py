"""The version of the package, also for pyproject.toml and ``stribeck.__version__``."""

__version__ = "0.1.0"
