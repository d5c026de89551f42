"""The version, for what the modules write; pyproject.toml and ``stribeck.__version__`` take it from here."""

__version__ = "0.1.0"
