"""The page: a scenario's numbers, laws as WebAssembly, charts and script in one file that needs no network."""

from __future__ import annotations

import ctypes
import gzip
import re
from base64 import b64encode
from collections.abc import Callable, Iterable, Mapping
from html import escape
from importlib import resources
from pathlib import Path

from stribeck.constants import show
from stribeck.errors import InputError, arg, needed, printable, unbroken
from stribeck.explorer.appendix import CLAIMS, appendix, columns, machine_appendix, relations
from stribeck.explorer.figures import Chart, figures, panels
from stribeck.explorer.machine import (
    machine_data,
    machine_law,
    machine_panels,
    machine_sections,
    path_of_constant,
    structure,
)
from stribeck.explorer.measured import measured
from stribeck.explorer.numbers import MOST_POINTS, beside_law, of_law
from stribeck.explorer.variants import measured_whole, subject, variants
from stribeck.expressions.pretty import name as symbol_name
from stribeck.files import trouble, write_text
from stribeck.laws.render import Equation, condition, equations
from stribeck.mouth.page import in_script
from stribeck.scenario import Scenario
from stribeck.simulation.native import EVENT_ROOM
from stribeck.simulation.wasm import System, run_struct, with_functions
from stribeck.version import __version__
from stribeck.waveforms import PointsSignal


def explore(
    what: Scenario | str | Path | Mapping[str, object] | None = None, out: str | Path | None = None,
    law: Iterable[str] | None = None, *, command: str = "", progress: Callable[[float], None] | None = None,
) -> Path:  # fmt: skip
    """Write one HTML file with sliders that simulates a scenario in the browser.

    Args:
        what: a scenario or a machine's scenario, its file or its tables; or a law's name for the built-in stick-slip run.
        out: the file; NAME.html unless given.
        law: names of the laws offered beside its own; all of the package unless given.
        command: the command that makes the page, for its foot.
        progress: called with the share of built modules, 0 to 1.

    Returns:
        The file.

    Raises:
        MissingExtra: if bokeh is not installed.
        InputError: if the scenario is not valid, a law is unknown, or a law cannot use the scenario's numbers.
    """
    scenario = subject(what)
    name = re.sub(r"[^\w.-]+", "_", scenario.name).strip("._")
    out = Path(out or f"{name or 'explore'}.html")
    if text := trouble(out, parents=False):
        raise InputError(f"{arg('out')}: {show(str(out))}: {text}")
    library = _library()
    if measured_whole(scenario):
        data, shown, sections = _machine(scenario, law), machine_panels(scenario), machine_sections(scenario)
    else:
        data, shown, sections = _under_laws(scenario, law, progress), panels(scenario), _SECTIONS
    write_text(out, _fill(scenario, data, shown, sections, library, command))
    return out


def _under_laws(
    scenario: Scenario, laws: Iterable[str] | None, progress: Callable[[float], None] | None
) -> dict[str, object]:
    """The data of a single body's page: the scenario under each law."""
    scenarios = variants(scenario, laws)
    modules = []
    for each in scenarios.values():
        modules.append(with_functions(each.system, appendix(each)))
        if progress is not None:
            progress(len(modules) / len(scenarios))
    return {
        "scenario": _tables(scenario),
        "law": scenario.law.name,
        "laws": {name: _law(each, module) for (name, each), module in zip(scenarios.items(), modules, strict=True)},
        "numbers": [n.as_data() for n in beside_law(scenario)],
        "claims": CLAIMS,
        "signal": _signal(scenario),
        "machine": None,
    }


def _machine(scenario: Scenario, laws: Iterable[str] | None) -> dict[str, object]:
    if laws:
        what = "a machine" if not scenario.elements.unnamed else "a servo, or a drive that follows a curve,"
        raise InputError(f"{arg('law')}: {', '.join(laws)}: {what} keeps the laws of its file")
    measured_machine, machine = measured(scenario), scenario.system
    module = with_functions(machine, machine_appendix(machine))
    return {
        "scenario": _plain(measured_machine.scenario.data),
        "law": "machine",
        "laws": {"machine": {**machine_law(scenario), "wasm": _compressed(module.module), "shape": shape(module)}},
        "numbers": [n.as_data() for n in measured_machine.numbers],
        "claims": [],
        "signal": None,
        "machine": machine_data(measured_machine),
    }


_SECTIONS = [
    ("loop-v", "Friction against velocity"),
    ("loop-y", "Friction against position"),
    ("curve", "Steady curve"),
    ("energy", "Energy balance"),
]


def _fill(
    scenario: Scenario, own: Mapping[str, object], shown: dict[str, Chart], sections: Iterable[tuple[str, str]],
    library: str, command: str,
) -> str:  # fmt: skip
    """The page's text with the data in it: the scenario's ``own``, and what every page has."""
    data = {
        "name": scenario.name, "version": __version__, "command": command, **own, "watched": scenario.system.watched,
        "layout": layout(), "eventRoom": EVENT_ROOM,
        "panels": {name: panel.as_data() for name, panel in shown.items()}, "figures": figures(shown),
    }  # fmt: skip
    charts = [
        f'<section aria-labelledby="h-{n}"><h2 id="h-{n}">{escape(title)}</h2><div id="{n}" class="chart"></div></section>'
        for n, title in sections
    ]
    parts = {
        "sections": "\n".join(charts),
        "title": escape(printable(scenario.name)),
        "style": _asset("page.css"),
        "data": in_script(data),
        "solver": _asset("solver.js"),
        "script": "\n".join(map(_asset, ("quick.js", "panels.js", "live.js", "keys.js", "machine.js", "explore.js"))),
        "charts": library,
        "foot": escape(command),
        "version": __version__,
    }
    # one pass: filled-in text is not searched for fields again
    return re.sub(r"\{\{ (\w+) \}\}", lambda field: parts[field[1]], _asset("page.html"))


def _law(scenario: Scenario, module: System) -> dict[str, object]:
    law, system = scenario.law, scenario.system
    kind, form = type(law), law.form
    conditions = {}
    for name in CLAIMS:
        claim = getattr(kind.claims, name)
        stated = condition(claim, kind, form) if callable(claim) else None
        if isinstance(stated, Equation):
            conditions[name] = stated.text
    (path,) = scenario.elements.laws
    needs = [
        {"key": each.key, "allowed": each.allowed, "path": path_of_constant(scenario, path, each.key)}
        for each in relations(kind)
    ]
    return {
        "name": law.name,
        "about": unbroken(f"{kind.__doc__ or ''} {kind.source}"),
        "table": _plain(law.to_dict()),
        "numbers": [{**n.as_data(), "symbol": symbol_name(n.name, latex=False)} for n in of_law(scenario)],
        **structure(system, columns(system)),
        "relations": needs,
        "conditions": conditions,
        "equations": [printable(each.text) for each in equations(kind, form)],
        "speed": float(law.scales(law.p).speed),
        "wasm": _compressed(module.module),
        "shape": shape(module),
    }


def shape(system: System) -> dict[str, object]:
    """The runtime's description of the system before a solution (runtime/any.c), and the address of free memory."""
    return {"numbers": system.shape, "end": system.end}


def layout() -> dict[str, tuple[int, str]]:
    """The fields of the struct Run in the memory of a module: each one's offset and kind."""
    kind = run_struct()
    fields = {name: (getattr(kind, name).offset, _word(of)) for name, of, *_ in kind._fields_}
    return {**fields, "_size": (ctypes.sizeof(kind), "size")}


def _word(kind: object) -> str:
    if kind is ctypes.c_double:
        return "double"
    return "integer" if kind is ctypes.c_int64 else "pointer"


def _signal(scenario: Scenario) -> dict[str, object]:
    signal = scenario.signal
    data: dict[str, object] = {"kind": signal.kind, "smooth": signal.smooth}
    if isinstance(signal, PointsSignal):
        scale = float(scenario.data["drive"]["signal"].get("scale", 1.0))
        data |= {"t": signal.t.tolist(), "value": signal.value.tolist(), "scale": scale}
    return data


def _tables(scenario: Scenario) -> object:
    """The file's tables without the law and a long signal, which are passed separately."""
    tables = {k: v for k, v in scenario.data.items() if k != "law"}
    signal = scenario.signal
    if isinstance(signal, PointsSignal) and len(signal.t) > MOST_POINTS:
        drive = tables["drive"]
        tables["drive"] = {**drive, "signal": {k: v for k, v in drive["signal"].items() if k not in ("t", "value")}}
    return _plain(tables)


def _plain(value: object) -> object:
    """Tables for JSON; values of other types as text."""
    if isinstance(value, Mapping):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    return value if isinstance(value, bool | int | float | str) else str(value)


def _library() -> str:
    """The script of the charts' library, from its package."""
    with needed("an explorer"):
        import bokeh

    script = Path(str(bokeh.__file__)).parent / "server" / "static" / "js" / "bokeh.min.js"
    return _compressed(script.read_bytes())


def _compressed(content: bytes) -> str:
    return b64encode(gzip.compress(content, 9, mtime=0)).decode("ascii")


def _asset(name: str) -> str:
    return resources.files("stribeck.explorer").joinpath("assets", name).read_text(encoding="utf-8")
