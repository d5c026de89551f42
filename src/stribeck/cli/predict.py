"""``stribeck predict`` and ``stribeck validate``: a fitted model, or a scenario, against a measured record."""

from __future__ import annotations

from pathlib import Path

from stribeck.cli import show
from stribeck.identify import api as fitting
from stribeck.identify import predict as predicting
from stribeck.identify.data.prepare import Preparation
from stribeck.identify.data.read import ColumnNames
from stribeck.report.cells import percent
from stribeck.report.quantities import human


def predict(
    data: list[Path], folder: Path, columns: ColumnNames, cutoff: float | None, out: Path | None, json: bool,
    trust: bool = False,
) -> int:  # fmt: skip
    """Read the record as the fit's was read, predict its force, print the errors."""
    model = predicting.load(folder, trust)
    if out is not None:
        show.check_folder(out)
    simulated = model.method != "static" and fitting.is_simulated([model.law], None)
    names = {**model.columns, **columns.names}
    units = {**{n: u for n, u in model.units.items() if n in names.values()}, **columns.units}
    gain = columns.force_gain if columns.force_gain is not None else model.force_gain
    how = Preparation(cutoff if cutoff is not None else model.cutoff, None, simulated, model.published, True)
    with show.progress("predict"):
        log = fitting.log_of(data, ColumnNames(names, units, gain), how)
        found = predicting.predict(model, log)
    summary = {**found.to_json(), "data": {"files": [str(p) for p in data], "rows": len(log)}}
    files: list[str] = []
    outside = found.beyond.told() if found.beyond else ""
    notes = [*([outside] if outside else []), *log.quality]
    if out is not None:
        from stribeck.identify.report import overlay

        traces = {
            "force": ("N", found.traces.measured, found.traces.fitted),
            "friction": ("N", found.friction.measured, found.friction.fitted),
        }
        rows = [[name, percent(x, 3)] for name, x in _errors(found).items()]
        introduction = [
            f"The predicted force is off by {percent(found.force_error, 3)}. "
            f"{model.law}, {model.method}, fitted to another record ({folder}), on {len(log)} rows of this one.",
            *([f"{outside[:1].upper()}{outside[1:]}."] if outside else []),
        ]
        figures = overlay.figure("prediction", log.time, traces, ("measured", "predicted"))
        title = f"{model.law} on {', '.join(p.name for p in data)}"
        command = show.command_line()
        files = [overlay.write_overlay(out, "prediction.html", title, introduction, rows, figures, command)]
    if json:
        show.print_json({**summary, "files": files})
        return 0
    print(f"{model.law}, {model.method}: {len(log)} rows, {found.rest:.0%} at rest")
    for name, x in _errors(found).items():
        print(f"  {name:44}{percent(x, 3):>10}")
    for text in notes:
        print(f"  note: {text}")
    for file in files:
        print(f"  wrote {file}")
    return 0


def _errors(found: predicting.Predicted) -> dict[str, float | None]:
    band = {} if found.band_error is None else {"the same in the fit's band": found.band_error}
    own = "the fit's own, on its record" + (", in its band" if band else "")
    return {
        "error of the force, every row in motion": found.force_error,
        **band,
        own: found.model.known.get("relative_force_error"),
        "the fit's, on parts left out of its record": found.model.known.get("cross_validated_error"),
        "error against friction alone": found.friction_error,
        "error of the force, rows at rest too": found.all_rows_error,
        **_parts(found),
        **{f"{name}, fitted to the same record": x for name, x in found.others.items()},
    }


def _parts(found: predicting.Predicted) -> dict[str, float | None]:
    """The error beyond what was fitted, and within it."""
    if not found.beyond or not found.beyond.rows:
        return {}
    return {
        "error of the force, beyond what was fitted": found.beyond.error,
        "error of the force, within it": found.beyond.within,
    }


def validate(
    scenario: Path, data: Path, columns: ColumnNames, assignments: list[str], out: Path | None, json: bool, trust: bool
) -> int:
    """Simulate the scenario, compare with the record, print the errors."""
    from stribeck.identify import validate as validating

    if out is not None:
        show.check_folder(out)
    loaded = show.load(scenario, assignments, trust)
    with show.progress("validate"):
        found = validating.validate(loaded, data, columns.names, columns.units, columns.force_gain)
    summary = {**found.to_json(), "scenario": loaded.name, "data": str(data)}
    files: list[str] = []
    if out is not None:
        from stribeck.identify.report import overlay

        rows = [
            [name, f"{human(e['rms'], e['unit'])}, {percent(e['relative'], 3)}"] for name, e in found.errors.items()
        ]
        figures = overlay.figure("validation", found.time, found.traces, ("measured", "simulated"))
        off = [
            f"{name} by {human(e['rms'], e['unit'])} (rms), at most {human(e['largest'], e['unit'])}"
            for name, e in found.errors.items()
        ]
        introduction = [
            f"Off: {'; '.join(off)}. {len(found.time)} rows of {data.name} beside the scenario {loaded.name}."
        ]
        command = show.command_line()
        title = f"{loaded.name} against {data.name}"
        files = [overlay.write_overlay(out, "validation.html", title, introduction, rows, figures, command)]
    if json:
        show.print_json({**summary, "files": files})
    else:
        print(f"{loaded.name} against {data.name}: {found.status}, {len(found.time)} rows")
        for name, e in found.errors.items():
            rms, largest = (human(e[each], e["unit"]) for each in ("rms", "largest"))
            print(f"  {name:10} rms {rms}, largest {largest}, relative {percent(e['relative'], 3)}")
        for file in files:
            print(f"  wrote {file}")
    if found.status != "done":
        show.failed(loaded.name, found.reason)
        return 1
    return 0
