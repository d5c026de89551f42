"""``stribeck sweep``."""

from __future__ import annotations

import sys
from pathlib import Path
from time import perf_counter

from stribeck.arrays import Array
from stribeck.cli import show
from stribeck.errors import InputError, left_out
from stribeck.sweeps.job import Sweep, check_cluster
from stribeck.sweeps.places import Store
from stribeck.sweeps.ranges import Range, lanes_of


def sweep(
    path: Path,
    vary: list[str],
    samples: int | None,
    seed: int,
    summary: bool,
    as_csv: bool,
    out: str,
    assignments: list[str],
    threads: int | None,
    json: bool,
    trust: bool,
    on: str | None = None,
    device: str = "cpu",
) -> int:
    """Simulate every lane, in parts; go on where an earlier run stopped."""
    if out.startswith("memory:"):
        raise InputError(f"--out: {out}: is gone when the command ends: must be a folder, or a URL of what stays")
    scenario = show.load(path, assignments, trust)
    check_cluster(on, threads, device)
    job = Sweep(scenario, _lanes(vary, samples, seed), out, summary, as_csv, device)
    if not isinstance(job.place, Store):
        show.check_folder(job.place.folder)
    elif reason := job.place.trouble():
        raise InputError(f"--out: {out}: {reason}")
    started, there = perf_counter(), job.parts - len(job.missing())
    with show.rate(f"{scenario.name}: {len(job.lanes)} lanes", "lanes") as tell:
        failed = job.run(threads, tell, on)
    where = str(job.place)
    files = [f"{where}/_manifest.json", *(str(job.path(i)) for i in range(job.parts))]
    seconds = perf_counter() - started
    report: dict[str, object] = {
        "status": "failed" if failed == len(job.lanes) else "done",
        "scenario": scenario.name,
        "lanes": len(job.lanes),
        "failed": failed,
        "parts": job.parts,
        "parts_found": there,
        "seconds": seconds,
    }
    with left_out("the page"):
        from stribeck.sweeps.page import write_sweep_page

        files += write_sweep_page(job, show.command_line())
    if json:
        show.print_json({**report, "files": files})
    else:
        found = f", {there} of them there already" if there else ""
        print(f"{scenario.name}: {len(job.lanes)} lanes in {job.parts} parts{found}, {seconds:.1f} s")
        print(f"  wrote {where}/_manifest.json and {where}/part-*.{'csv' if as_csv else 'parquet'}")
        if len(files) > 1 + job.parts:
            print(f"  wrote {files[-1]}")
    if failed:
        print(f"stribeck: {failed} of {len(job.lanes)} lanes failed; the column 'reason' says why", file=sys.stderr)
    return 1 if report["status"] == "failed" else 0


def _lanes(vary: list[str], samples: int | None, seed: int) -> dict[str, Array]:
    """The values of every lane.

    Raises:
        InputError: one line for each problem.
    """
    problems, ranges = [], []
    for text in vary:
        try:
            ranges.append(Range.parse(text, drawn=samples is not None))
        except InputError as error:
            problems += error.problems
    if samples is None and seed:
        problems.append(f"--seed {seed}: goes with --samples, which is not given")
    if problems:
        raise InputError(problems)
    return lanes_of(ranges, samples, seed)
