"""``stribeck sweep``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from stribeck.cli.shared import Backend, Json, ScenarioFile, Set, Trust, Undetermined, app, written_to
from stribeck.errors import InputError

if TYPE_CHECKING:
    from stribeck.arrays import Array


@app.command(epilog="Example: stribeck sweep my_rig.toml --vary law.k_v=1e6:1e8:5:log --out grid")
def sweep(
    scenario: ScenarioFile,
    out: Annotated[
        str,
        typer.Option(
            "--out", metavar="DIR", parser=written_to, help="Folder for the results, or a URL that fsspec knows."
        ),
    ],
    vary: Annotated[
        list[str] | None,
        typer.Option("--vary", metavar="PATH=FIRST:LAST:COUNT[:log]", help="Range of a number; may be repeated."),
    ] = None,
    samples: Annotated[
        int | None,
        typer.Option("--samples", metavar="N", help="Draw N random points of the ranges instead of their grid."),
    ] = None,
    seed: Annotated[int, typer.Option("--seed", metavar="S", help="Seed of the random points.", min=0)] = 0,
    summary: Annotated[
        bool, typer.Option("--summary", help="Write one row for each simulation instead of its trajectory.")
    ] = False,
    cluster: Annotated[
        str | None,
        typer.Option("--cluster", metavar="HOST:PORT", help="Dask scheduler whose workers run the simulations."),
    ] = None,
    threads: Annotated[
        int | None,
        typer.Option(
            "--threads",
            metavar="N",
            help="Number of threads; all cores unless given.",
            min=1,
            rich_help_panel="Advanced",
        ),
    ] = None,
    set_: Set = None,
    trust: Trust = False,
    json: Json = False,
    _backend: Backend = None,
    _undetermined: Undetermined = False,
) -> int:
    """Simulate a scenario over ranges of its numbers; the same command continues after an interruption."""
    import sys
    from time import perf_counter

    from stribeck.cli import show
    from stribeck.sweeps.job import Sweep, check_cluster
    from stribeck.sweeps.places import Folder

    if out.startswith("memory:"):
        raise InputError(f"--out: {out}: is gone when the command ends: must be a folder, or a URL of what stays")
    loaded = show.load(scenario, set_ or [], trust)
    check_cluster(cluster, threads)
    job = Sweep(loaded, _lanes(vary or [], samples, seed), out, summary)
    if isinstance(job.place, Folder):
        show.check_folder(job.place.folder)
    started = perf_counter()
    with show.rate(f"{loaded.name}: {len(job.lanes)} lanes", "lanes") as tell:
        job.run(threads, tell, cluster)
    seconds = perf_counter() - started
    status = "failed" if job.failed == len(job.lanes) else "done"
    if json:
        show.print_json({
            "status": status, "scenario": loaded.name, "lanes": len(job.lanes), "failed": job.failed, "parts": job.parts,
            "parts_found": job.found, "seconds": seconds, "files": job.files,
        })  # fmt: skip
    else:
        found = f", {job.found} of them there already" if job.found else ""
        print(f"{loaded.name}: {len(job.lanes)} lanes in {job.parts} parts{found}, {seconds:.1f} s")
        print(f"  wrote {job.place.path('_manifest.json')} and {job.place.path('part-*.parquet')}")
    if job.failed:
        print(f"stribeck: {job.failed} of {len(job.lanes)} lanes failed; the column 'reason' says why", file=sys.stderr)
    return 1 if status == "failed" else 0


def _lanes(vary: list[str], samples: int | None, seed: int) -> dict[str, Array]:
    """The values of every lane.

    Raises:
        InputError: one line for each problem.
    """
    from stribeck.sweeps.ranges import Range, lanes_of

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
