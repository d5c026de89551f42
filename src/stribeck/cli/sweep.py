"""``stribeck sweep``."""

from __future__ import annotations

import sys
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from stribeck.cli.options import ADVANCED, Json, ScenarioOptions, command, flag, output_path, setting
from stribeck.cli.output import output_folder, tell
from stribeck.cli.progress import progress
from stribeck.errors import InputError, check_all

if TYPE_CHECKING:
    from stribeck.arrays import Array


@command("sweep", "stribeck sweep my_rig.toml --vary law.k_v=1e6:1e8:5:log --out grid")
def sweep(
    source: ScenarioOptions,
    out: Annotated[Path, setting("--out", "DIR", "Folder for the results; created if missing.", parser=output_path)],
    vary: Annotated[
        list[str] | None, setting("--vary", "PATH=FIRST:LAST:COUNT[:log]", "Parameter and its range; may be repeated.")
    ] = None,
    samples: Annotated[
        int | None, setting("--samples", "N", "Draw N random points of the ranges instead of their grid.")
    ] = None,
    seed: Annotated[int, setting("--seed", "S", "Seed of the random points.", min=0)] = 0,
    summary: Annotated[bool, flag("--summary", "Write one row for each simulation instead of its trajectory.")] = False,
    threads: Annotated[
        int | None, setting("--threads", "N", "Number of threads; all cores unless given.", ADVANCED, min=1)
    ] = None,
    json: Json = False,
) -> int:
    """Simulate a scenario over ranges of its parameters. The same command continues after an interruption."""
    from time import perf_counter

    from stribeck.simulation.ensemble import inaccurate_lanes
    from stribeck.sweeps.job import Sweep

    lanes = cache(partial(_lanes, vary or [], samples=samples, seed=seed))
    loaded = source.load(lanes)
    job = Sweep(loaded, lanes(), out=out, summary=summary)
    started = perf_counter()
    with output_folder(out), progress(f"{loaded.name}: {len(job.lanes)} lanes") as tell_share:

        def rated(share: float, count: float) -> None:
            tell_share(share, f"{count / max(perf_counter() - started, 1e-9):.0f} lanes/s")

        job.run(threads=threads, progress=rated)
    seconds = perf_counter() - started
    all_failed = job.failed == len(job.lanes)
    data = {
        "status": "failed" if all_failed else "done", "scenario": loaded.name, "lanes": len(job.lanes),
        "failed": job.failed, "inaccurate": job.inaccurate, "parts": job.parts, "parts_found": job.found, "seconds": seconds,
    }  # fmt: skip
    shown = [str(out / name) for name in ("_manifest.json", "part-*.parquet")]
    tell(lambda: job.document(seconds), data if json else None, job.files if json else shown)
    if job.failed:
        print(f"stribeck: {job.failed} of {len(job.lanes)} lanes failed; the column 'reason' says why", file=sys.stderr)
    if text := inaccurate_lanes(job.inaccurate, len(job.lanes)):
        print(f"stribeck: {text}", file=sys.stderr)
    return 1 if all_failed else 0


def _lanes(vary: list[str], *, samples: int | None, seed: int) -> dict[str, Array]:
    """The values of every lane.

    Raises:
        InputError: one line for each problem.
    """
    from stribeck.sweeps.ranges import Range, lanes_of

    def seeded() -> None:
        if samples is None and seed:
            raise InputError(f"--seed {seed}: goes with --samples, which is not given")

    ranges: list[Range] = []
    reads = (partial(Range.parse, text, drawn=samples is not None) for text in vary)
    check_all(*(lambda read=read: ranges.append(read()) for read in reads), seeded)
    return lanes_of(ranges, samples=samples, seed=seed)
