"""Where the project's shared inputs lie, when they are there at all."""

from pathlib import Path

SHARED = Path(__file__).parent.parent.parent / "shared"
