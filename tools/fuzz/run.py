"""The attack, kept: ``make fuzz``, or ``python tools/fuzz/run.py --seed 7 --mutations 3000 --machines 300 ...``."""

from __future__ import annotations

import argparse
import os
import resource
import signal
import sys
import tempfile
from collections import Counter
from pathlib import Path
from types import ModuleType

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent.parent)]


def main() -> None:
    """Print how everything ended and each fault; the exit status is 1 where there is one."""
    import kills
    import machines
    import mutations
    import parameters

    campaigns = {
        "kills": (kills, 60), "parameters": (parameters, 300), "machines": (machines, 300), "mutations": (mutations, 3000),
    }  # fmt: skip
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", choices=campaigns, action="append", help="this part, and none that is not named")
    for name, (_, count) in campaigns.items():
        parser.add_argument(f"--{name}", type=int, default=count, help=f"how many; {count} unless given")
    options = parser.parse_args()
    os.environ.setdefault("STRIBECK_CACHE", tempfile.mkdtemp(prefix="stribeck-fuzz-"))
    wrong: list[str] = []
    for number in (signal.SIGINT, signal.SIGTERM):  # a shell's background job ignores Ctrl-C
        signal.signal(number, signal.default_int_handler)
    try:
        for name in options.only or campaigns:
            part(name, campaigns[name][0], options.seed, getattr(options, name), wrong)
    except KeyboardInterrupt:
        sys.exit(130)
    finally:
        print("\n".join(wrong) or "no fault found")
    sys.exit(bool(wrong))


def part(name: str, module: ModuleType, seed: int, count: int, wrong: list[str]) -> None:
    """Run a part, and print how it ended; of one that Ctrl-C stops, what it came to."""
    ended, began = Counter[str](), _processor()
    try:
        module.campaign(seed, count, ended, wrong)
    finally:
        done = sum(ended.values())
        told = ", ".join(f"{n} {what}" for what, n in sorted(ended.items()))
        print(f"{name}: {done} of {count}, {_processor() - began:.0f} s of processor time: {told}", flush=True)


def _processor() -> float:
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in used)


if __name__ == "__main__":
    main()
