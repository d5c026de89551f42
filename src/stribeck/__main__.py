"""``python -m stribeck`` is the command ``stribeck``."""

from stribeck.cli import main

if __name__ == "__main__":
    main()
