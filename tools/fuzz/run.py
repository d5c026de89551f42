"""The attack, kept: ``make fuzz``, or ``python tools/fuzz/run.py --seed 7 --mutations 3000 --machines 300 ...``."""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent.parent)]


def main() -> None:
    """Print how everything ended and each fault; the exit status is 1 where there is one."""
    import kills
    import machines
    import mutations
    import parameters

    campaigns = {
        "mutations": (mutations, 3000), "kills": (kills, 60), "parameters": (parameters, 300), "machines": (machines, 300),
    }  # fmt: skip
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--seed", type=int, default=1)
    for name, (_, count) in campaigns.items():
        parser.add_argument(f"--{name}", type=int, default=count, help=f"how many; {count} unless given")
    options = parser.parse_args()
    os.environ.setdefault("STRIBECK_CACHE", tempfile.mkdtemp(prefix="stribeck-fuzz-"))
    wrong: list[str] = []
    for name, (module, _) in campaigns.items():
        ended, faults = module.campaign(options.seed, getattr(options, name))
        print(f"{name}: {getattr(options, name)}: " + ", ".join(f"{n} {what}" for what, n in sorted(ended.items())))
        wrong += faults
    print("\n".join(wrong) or "no fault found")
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
