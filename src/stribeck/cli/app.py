"""The commands and their options."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from stribeck.cli.shared import (
    ControllerName,
    ExportContact,
    ExportOut,
    ExportPart,
    ExportScenario,
    ExportStep,
    ExportTarget,
    Json,
    Out,
    ScenarioFile,
    Set,
    Trust,
    Undetermined,
    app,
)  # fmt: skip

__all__ = ["app"]


@app.command(epilog="Example: stribeck run my_rig.toml --set law.k_v=1e7 --out first")
def run(
    scenario: ScenarioFile,
    out: Out = None,
    set_: Set = None,
    trust: Trust = False,
    json: Json = False,
    keep_c: Annotated[
        Path | None, typer.Option("--keep-c", metavar="FILE", help="Write the generated C here, to read or debug.")
    ] = None,
    _undetermined: Undetermined = False,
) -> int:
    """Simulate one scenario; without --out, print the summary and write nothing."""
    from stribeck.cli import run as command

    return command.run(scenario, out, set_ or [], json, keep_c, trust)


@app.command(epilog="Example: stribeck show machine.toml --out machine.svg")
def show(
    machine: Annotated[Path, typer.Argument(metavar="MACHINE.toml", help="A machine file (schema = 2).")],
    out: Annotated[Path | None, typer.Option("--out", metavar="FILE.svg", help="Draw it here, as a picture.")] = None,
    set_: Set = None,
    trust: Trust = False,
    json: Json = False,
) -> int:
    """Draw a machine as a schematic: bodies, what is between them and what acts on them, with their numbers."""
    from stribeck.cli import schematic as command

    return command.draw(machine, out, set_ or [], json, trust)


@app.command(epilog="Example: stribeck compare my_rig.toml --law lugre --law lugre_majorant:k_v=1e6")
def compare(
    scenario: ScenarioFile,
    law: Annotated[
        list[str],
        typer.Option("--law", metavar="NAME[:KEY=VALUE,...]", help="A law to compare; the first is the reference."),
    ],
    contact: Annotated[
        str | None, typer.Option("--contact", metavar="NAME", help="Of a machine, whose law is replaced.")
    ] = None,
    out: Out = None,
    set_: Set = None,
    trust: Trust = False,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:
    """Simulate one scenario under several laws and show where they deviate."""
    from stribeck.cli import compare as command

    return command.compare(scenario, law, out, set_ or [], json, trust, contact)


@app.command(epilog="Example: stribeck sweep my_rig.toml --vary law.k_v=1e6:1e8:5:log --out grid")
def sweep(
    scenario: ScenarioFile,
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder for the parts; made if need be.")],
    vary: Annotated[
        list[str] | None,
        typer.Option("--vary", metavar="PATH=FIRST:LAST:COUNT[:log]", help="A range of a number; may be repeated."),
    ] = None,
    samples: Annotated[
        int | None, typer.Option("--samples", metavar="N", help="N random points of the ranges, not their grid.")
    ] = None,
    seed: Annotated[int, typer.Option("--seed", metavar="S", help="What the random points are drawn by.", min=0)] = 0,
    summary: Annotated[bool, typer.Option("--summary", help="One row a lane, not its trajectory.")] = False,
    as_csv: Annotated[bool, typer.Option("--csv", help="Write CSV in the place of Parquet.")] = False,
    set_: Set = None,
    threads: Annotated[
        int | None, typer.Option("--threads", metavar="N", help="Threads; all of the machine's unless given.", min=1)
    ] = None,
    trust: Trust = False,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:
    """Simulate one scenario over ranges of its numbers; run again after a stop, it goes on where it was."""
    from stribeck.cli import sweep as command

    return command.sweep(scenario, vary or [], samples, seed, summary, as_csv, out, set_ or [], threads, json, trust)


@app.command(epilog="Example: stribeck laws lugre_majorant")
def laws(
    law: Annotated[
        list[str] | None, typer.Argument(metavar="[LAW]...", help="Only these; FILE.py:NAME is one too.")
    ] = None,
    json: Json = False,
    test: Annotated[bool, typer.Option("--test", help="Test numerically all that the laws claim.")] = False,
    sets: Annotated[
        bool, typer.Option("--sets", help="List the parameter sets, and the laws that are passive with each.")
    ] = False,
) -> int:
    """List the laws: equation, constants, units, source, what each guarantees."""
    from stribeck.cli import laws as command

    return command.laws(law or [], json, test, sets)


@app.command(epilog="Example: stribeck advise lugre_sobczyk --parameters canudas1995 --creep 1e-6")
def advise(
    law: Annotated[str, typer.Argument(metavar="LAW", help="A bristle law with k_v.")],
    parameters: Annotated[
        str | None, typer.Option("--parameters", metavar="NAME or FILE", help="The machine's parameters.")
    ] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Another constant, such as z_ba=7e-6.")
    ] = None,
    creep: Annotated[float | None, typer.Option(help="Tolerated creep in m/s under a held load.")] = None,
    share: Annotated[float, typer.Option(help="That load, and presliding's, as a share of F_s.")] = 0.95,
    steady_error: Annotated[float | None, typer.Option(help="Tolerated relative error of friction at --speed.")] = None,
    speed: Annotated[float | None, typer.Option(help="That speed, m/s.")] = None,
    presliding_error: Annotated[
        float | None, typer.Option(help="Tolerated error of the presliding position, relative to its peak.")
    ] = None,
    force_rate: Annotated[float | None, typer.Option(help="The force's rate in presliding, N/s.")] = None,
    position_error: Annotated[
        float | None, typer.Option(help="Tolerated error of the position in --scenario, m.")
    ] = None,
    scenario: Annotated[Path | None, typer.Option(metavar="SCENARIO.toml", help="That scenario.")] = None,
    sample_time: Annotated[
        float | None, typer.Option(help="Step of the target, s: explicit Euler is to be stable with it.")
    ] = None,
    v_max: Annotated[float | None, typer.Option(help="Largest speed that matters, m/s; 100 v_s unless given.")] = None,
    mass: Annotated[float | None, typer.Option(help="Mass of the body, kg.")] = None,
    level: Annotated[
        str | None,
        typer.Option(metavar="LOW:HIGH", help="The largest v_d that keeps it passive while F_c and F_s vary so."),
    ] = None,
    trust: Trust = False,
    out: Out = None,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:
    """Which k_v? The smallest that meets what you tolerate, what it costs, and the same for the majorant law."""
    from stribeck.cli import advise as command

    tolerated = {
        "creep": creep, "share": share, "steady_error": steady_error, "speed": speed, "presliding_error": presliding_error,
        "force_rate": force_rate, "position_error": position_error, "scenario": scenario, "sample_time": sample_time,
        "v_max": v_max, "mass": mass, "level": level,
    }  # fmt: skip
    return command.advise(law, parameters, set_ or [], tolerated, out, json, trust)


@app.command(epilog="Example: stribeck check lugre_sobczyk --parameters canudas1995 --set k_v=1e7")
def check(
    law: Annotated[str | None, typer.Argument(metavar="LAW", help="A law; FILE.py:NAME is one too.")] = None,
    parameters: Annotated[
        str | None, typer.Option("--parameters", metavar="NAME or FILE", help="The machine's parameters.")
    ] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Another constant, such as k_v=1e7.")
    ] = None,
    v_max: Annotated[
        float | None, typer.Option("--v-max", metavar="V", help="Passivity is asked for |v| <= V, m/s.")
    ] = None,
    every: Annotated[bool, typer.Option("--all", help="Every law with the parameters.")] = False,
    margins: Annotated[
        bool, typer.Option("--margins", help="How far each constant can move before passivity changes.")
    ] = False,
    verify: Annotated[
        bool, typer.Option("--verify", help="Check each proof by other code, and replay each counterexample.")
    ] = False,
    certificate: Annotated[
        Path | None, typer.Option("--certificate", metavar="FILE", help="Write the proofs here, for others to check.")
    ] = None,
    level: Annotated[
        str | None,
        typer.Option(
            "--level", metavar="LOW:HIGH", help="F_c and F_s vary in any way between LOW and HIGH times theirs."
        ),
    ] = None,
    scenario: Annotated[
        Path | None,
        typer.Option(
            "--scenario", metavar="FILE", help="Each contact of this machine, and what follows for the whole."
        ),
    ] = None,
    force: Annotated[
        list[str] | None,
        typer.Option("--force", metavar="NAME=MAX", help="With --scenario: the force of this link stays within +-MAX."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Folder for a page, and for counterexamples as scenarios to run."),
    ] = None,
    trust: Trust = False,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:
    """Does this law with these parameters have each property? A proof, or a counterexample that 'run' replays."""
    if scenario is not None:
        from stribeck.cli import check_machine

        alien = {"LAW": law, "--parameters": parameters, "--all": every, "--margins": margins, "--level": level}
        return check_machine.check(
            scenario, set_ or [], v_max, force or [], json, trust, verify, out, certificate, alien
        )  # fmt: skip
    from stribeck.cli import check as command

    if force:
        command.refuse_force(force)
    return command.check(law, parameters, set_ or [], v_max, json, every, margins, verify, out, certificate, level)


@app.command(epilog="Example: stribeck new my_rig")
def new(
    name: Annotated[
        str, typer.Argument(metavar="[NAME]", help="A name for it, or that of a built-in example.")
    ] = "my_rig",
    out: Annotated[Path | None, typer.Option("--out", metavar="FILE", help="Where to; NAME.toml unless given.")] = None,
    examples: Annotated[bool, typer.Option("--list", help="List the built-in examples.")] = False,
) -> int:
    """Write a commented scenario file to start from."""
    from stribeck.cli import new as command

    return command.new(name, out, examples)


@app.command(epilog="Example: stribeck paper --out report")
def paper(
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder for the report.")] = Path("stribeck-report"),
    json: Json = False,
) -> int:
    """Simulate the phenomena of the paper and leave one page with the plots."""
    from stribeck.cli import paper as command

    return command.paper(out, json)


@app.command(epilog="Example: stribeck export lugre --parameters canudas1995 --target c --out firmware")
def export(
    target: ExportTarget,
    out: ExportOut,
    law: Annotated[
        str | None,
        typer.Argument(
            metavar="LAW",
            help="The law, the scenario's unless given; FILE.py:NAME is one too. Or a scenario: MACHINE.toml.",
        ),
    ] = None,
    parameters: Annotated[
        str | None, typer.Option("--parameters", metavar="SET", help="A built-in set of parameters, or a TOML file.")
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="A constant, such as k_v=1e7 (cascade: drive.K_D=80)."),
    ] = None,
    part: ExportPart = None,
    scenario: ExportScenario = None,
    contact: ExportContact = None,
    controller: ControllerName = None,
    step: ExportStep = None,
    self_test: Annotated[bool, typer.Option("--self-test", help="With a program that checks the C.")] = False,
    fmi: Annotated[int, typer.Option("--fmi", metavar="VERSION", help="Of an FMU: 3 or 2.")] = 3,
    trust: Trust = False,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:
    """Write a law or a compensator for another tool: C, FMU, Modelica, MuJoCo, Structured Text, a table."""
    from stribeck.cli import export as command

    return command.export(
        law,
        target,
        out,
        parameters,
        set_ or [],
        part,
        scenario,
        contact,
        step,
        self_test,
        fmi,
        json,
        trust,
        controller,
    )


@app.command(epilog="Example: stribeck gains servo.toml --out gains")
def gains(
    scenario: ScenarioFile,
    v_max: Annotated[
        float | None,
        typer.Option("--v-max", metavar="V", help="Speeds to prove it for, m/s; twice those met unless given."),
    ] = None,
    set_: Set = None,
    trust: Trust = False,
    out: Out = None,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:
    """Show whether a servo's Lyapunov function decreases: conditions on the gains, a proof, and the simulation.

    Of a machine: whether its loop is quiet, creeps, hunts or grows with the gains that it has, as 'stribeck design' says.
    """
    from stribeck.cli import gains as command

    return command.gains(scenario, v_max, set_ or [], out, json, trust)


@app.command(epilog="Example: stribeck explore my_rig.toml --out my_rig.html")
def explore(
    what: Annotated[
        str | None,
        typer.Argument(
            metavar="[SCENARIO.toml | LAW]", help="A scenario file, or a law in the built-in stick-slip run."
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE.html", help="The page; NAME.html unless given.")
    ] = None,
    law: Annotated[
        list[str] | None,
        typer.Option("--law", metavar="NAME", help="Offer this law beside the scenario's own; every law unless given."),
    ] = None,
    report: Annotated[
        Path | None, typer.Option("--report", metavar="DIR", help="Add the page to a run's or fit's folder.")
    ] = None,
    set_: Set = None,
    trust: Trust = False,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:
    """Write a page that simulates the scenario in a browser while its numbers are turned; it needs no network."""
    from stribeck.cli import explore as command

    return command.explore(what, out, law, report, set_ or [], trust, json)


@app.command(epilog="Example: stribeck design machine.toml --vary controllers.axis.K_p=10:1000 --out design")
def design(
    scenario: ScenarioFile,
    vary: Annotated[
        list[str] | None,
        typer.Option("--vary", metavar="PATH=LOW:HIGH", help="Find where the verdict changes; may be repeated."),
    ] = None,
    map_: Annotated[
        list[str] | None,
        typer.Option("--map", metavar="PATH=LOW:HIGH", help="Given twice: the verdict over two numbers, as a picture."),
    ] = None,
    tune: Annotated[
        str | None, typer.Option("--tune", metavar="K_p,K_v", help="Search gains of the controller, or paths.")
    ] = None,
    uncertainty: Annotated[
        Path | None,
        typer.Option(
            "--uncertainty", metavar="parameters.toml", help="Intervals of the friction, of a fit; else 10 % both ways."
        ),
    ] = None,
    controller: Annotated[str | None, typer.Option("--controller", metavar="NAME", help="Which, of several.")] = None,
    compensations: Annotated[
        bool, typer.Option("--compensations/--no-compensations", help="Compare what may be done against friction.")
    ] = True,
    seed: Annotated[int, typer.Option("--seed", metavar="N", help="Of the samples and of the search.")] = 0,
    set_: Set = None,
    trust: Trust = False,
    out: Out = None,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:
    """Will this axis hunt? Verdict, boundaries, errors, and what may be done against its friction."""
    from stribeck.cli import design as command

    options = {
        "vary": vary or [], "tune": tune.split(",") if tune else [], "uncertainty_file": uncertainty, "controller": controller,
        "compensations": compensations, "seed": seed, "map": map_ or [],
    }  # fmt: skip
    return command.run(scenario, set_ or [], options, out, json, trust)


@app.command(epilog="Example: stribeck hunting machine.toml")
def hunting(
    scenario: ScenarioFile,
    controller: ControllerName = None,
    set_: Set = None,
    trust: Trust = False,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:
    """Will this loop hunt? By simulation, and by describing functions as a second opinion."""
    from stribeck.cli import design as command

    return command.hunt(scenario, set_ or [], controller, json, trust)


@app.command(epilog="Example: stribeck doctor --json")
def doctor(json: Json = False) -> int:
    """Show compiler, cache and versions, and run a self-test."""
    from stribeck.cli import doctor as command

    return command.doctor(json)


from stribeck.cli import exchange as exchange  # noqa: E402
from stribeck.cli import measured as measured  # noqa: E402  (its commands stand behind these)
from stribeck.cli import parameters as parameters  # noqa: E402
