"""``stribeck run``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from stribeck.cli import show
from stribeck.simulation import c_source, simulate

if TYPE_CHECKING:
    from stribeck.simulation import Solution


def run(path: Path, out: Path | None, assignments: list[str], json: bool, keep_c: Path | None, trust: bool) -> int:
    """Simulate, write what was asked for, print the summary."""
    scenario = show.load(path, assignments, trust)
    if keep_c is not None and (out is None or keep_c.absolute().parent != out.absolute()):
        show.check_file("--keep-c", keep_c, path)
    if out is not None:
        show.check_folder(out)
    with show.progress(scenario.name) as tell:
        solution = simulate(scenario, tell)
    summary, files = solution.summary(), list[str]()
    if keep_c is not None:
        from stribeck.files import write_text

        write_text(keep_c, c_source(scenario))
        files.append(str(keep_c))
    if out is not None:
        from stribeck.report.run import write_run

        files += write_run(solution, out, {**summary, "files": files}, show.command_line())
    if json:
        show.print_json({**summary, "files": files})
    else:
        _print(solution, files)
    if solution.status != "done":
        show.failed(scenario.name, solution.reason)
        return 1
    return 0


def _print(solution: Solution, files: list[str]) -> None:
    from stribeck.report.quantities import prefixed

    scenario, stats = solution.scenario, solution.stats
    print(f"{scenario.name}: {solution.status}, {scenario.subject}, {len(solution.t)} rows of {scenario.rows}")
    milliseconds = 1e3 * stats["seconds"]
    print(f"  {stats['accepted']} steps ({stats['rejected']} rejected) in {milliseconds:.1f} ms, {stats['solver']}")
    named = scenario.system.by_element
    if not named:
        slips, sticks = len(solution.events["slip"]), len(solution.events["stick"])
        print(f"  |v| rises through v_s {slips} times (slip), falls through it {sticks} times (stick)")
    for element, events in solution.events.items() if named else ():
        told = ", ".join(f"{kind} {len(times)}" for kind, times in events.items() if len(times))
        print(f"  {element}: {told or 'no events'}")
    width = max(8, *(len(column.name) for column in solution.columns))
    print(f"  {'':{width}}{'peak':>16}{'final':>16}")
    peaks, final = solution.peaks, solution.final
    for column in solution.columns:
        factor, unit = prefixed(column.unit, peaks[column.name])
        last = final.get(column.name, float("nan"))
        print(f"  {column.name:{width}}{peaks[column.name] / factor:16.8g}{last / factor:16.8g} {unit}")
    for file in files:
        print(f"  wrote {file}")
