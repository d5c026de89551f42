"""Compute every figure of the paper: ``python -m examples.paper [--out DIR]`` from the repository's root."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from examples.paper import report
from stribeck.cli.output import output_folder
from stribeck.cli.progress import progress
from stribeck.errors import StribeckError


def main() -> int:
    """Write the report and print which file to open; 0 done, 1 a simulation failed, 2 bad input."""
    parser = argparse.ArgumentParser(prog="python -m examples.paper", description=main.__doc__)
    parser.add_argument("--out", type=Path, default=Path("stribeck-report"), help="folder for the report")
    out: Path = parser.parse_args().out
    try:
        with output_folder(out), progress("report") as tell:
            summary = report.write(out, tell)
    except StribeckError as error:
        print(error, file=sys.stderr)
        return 2 if isinstance(error, ValueError) else 1
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 130
    print(f"open {summary['files'][0]}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
