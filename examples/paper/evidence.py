"""Why a law has a property, or has it not: energy drawn, deflection without bound, drift, creep."""

from __future__ import annotations

from collections.abc import Mapping
from math import pi, tan

import numpy as np

from examples.paper.common import BRISTLES, STEEPNESSES, Chapter, Done, Printed, Variant, finish, solve
from examples.paper.statements import passivity_cycle
from stribeck import laws
from stribeck.laws.terms import g
from stribeck.mouth import plots
from stribeck.mouth.cells import human
from stribeck.properties.cycles import integrate
from stribeck.properties.steepness import creep_under
from stribeck.scenario import Scenario

_SHARE = 0.95
Numbers = Mapping[str, object]


def chapter(done: Done) -> Chapter:
    """Four figures, each with its formula."""
    cycle, cycling = energy()
    drift, dithered = dither()
    speeds, creeping = creep()
    text = (
        "Why the laws differ in what they guarantee, each figure with its formula. A smooth |v| has a price: where it is too "
        "small (v S_0), z has no bound; where that is mended by a smaller drive (S_0^2 v), energy can be drawn; where it is a "
        "majorant (m), the bristles leak at rest and a held body creeps, as it does under S_0^2 v. Only an elastic range (z_ba) "
        "keeps a body in place.",
    )
    numbers = {"cycle": cycle, "drift": drift, "creep": speeds}
    figures = [cycling, unbounded(), dithered, creeping]
    return Chapter("evidence", "Why: energy, bound, drift and creep", text, (), figures, numbers)


def energy() -> tuple[Numbers, Printed]:
    """What lugre_sobczyk gives back when its bristles are unwound slowly, and the cycle that is replayed."""
    k_v, charged = 1e6, 1e-6
    law = laws.law("lugre_sobczyk", "canudas1995", k_v=k_v)
    e = np.geomspace(1e-3, 30, 60)
    result = np.array([integrate(law, -x / k_v, charged, 0.0) for x in e])
    cycle = passivity_cycle(k_v)
    limit = pi / 2 * law.p.sigma_0 * g(law.p, 0.0) * charged / e
    with plots.style():
        built, axes = plots.figure([["energy", "time"]], 3.2)
        axis = axes["energy"]
        plots.line(axis, 1, e / k_v, -1e9 * result[:, 1], "drawn by unwinding at this speed")
        plots.line(axis, 2, e / k_v, 1e9 * limit, "pi sigma_0 g z/(2 e), e = k_v |v|")
        axis.axhline(1e9 * cycle["put_in"], color=plots.GRAY, linewidth=1.0, label="put in by charging")
        axis.plot([1 / k_v], [1e9 * cycle["drawn_out"]], "o", color=plots.COLORS[0], markersize=5, label="replayed")
        plots.line(axes["time"], 1, e / k_v, result[:, 0], "time")
        axes["time"].plot([1 / k_v], [cycle["time"]], "o", color=plots.COLORS[0], markersize=5)
        for panel, name in (("energy", "energy (nJ)"), ("time", "time (s)")):
            plots.logarithmic(axes[panel])
            axes[panel].set(xlabel="speed of unwinding (m/s)", ylabel=name)
        plots.legend(built, axis)
        figure = finish(
            built, "evidence_energy",
            f"lugre_sobczyk, Table 1, k_v = {k_v:.0e} s/m, charged to z = 1 µm at {10 / k_v:.0e} m/s and unwound to z = 0. The "
            "slower, the more it gives back, like 1/e, and the longer it takes, like 1/e^2; no store can pay for it. The cycle "
            f"marked takes {cycle['time']:.2g} s and draws {1e9 * (cycle['drawn_out'] - cycle['put_in']):.0f} nJ in all.",
        )  # fmt: skip
    return cycle, figure


def unbounded() -> Printed:
    """z of lugre_arctan at slow speeds: in the limit, and on the way there."""
    law = laws.law("lugre_arctan", "canudas1995", k_v=1e6)
    Z, v, distance = float(law.z_bound(law.p)), np.geomspace(1e-10, 1e-3, 200), 1e-3
    with plots.style():
        built, axes = plots.figure([["limit", "way"]], 3.2)
        for i, k_v in enumerate(STEEPNESSES, start=1):
            label = f"k_v = 1e{round(np.log10(k_v))} s/m"
            plots.line(axes["limit"], i, v, law.replace(k_v=k_v).steady_deflection(v) / Z, label)
        for i, speed in enumerate((1e-6, 1e-7, 1e-8), start=1):
            run = solve(
                Scenario(
                    name="slow", law={"name": law.name, "k_v": 1e6, "parameters": "canudas1995"},
                    drive={"kind": "velocity", "signal": {"kind": "points", "t": [0.0, 1.0], "value": [speed, speed]}},
                    solve={"t_end": distance / speed}, output={"step": distance / speed / 400},
                )
            )  # fmt: skip
            plots.line(axes["way"], i, 1e3 * run["y"], run["z"] / Z, human(speed, "m/s"))
        for axis in axes.values():
            axis.axhline(1.0, color=plots.GRAY, linewidth=1.0, label="Z = F_s/sigma_0")
        plots.logarithmic(axes["limit"])
        plots.logarithmic(axes["way"], x=False)
        axes["limit"].set(xlabel="constant v (m/s)", ylabel="z/Z", title="limit, g pi/(2 arctan(k_v v))")
        axes["limit"].legend()
        axes["way"].set(xlabel="distance (mm)", ylabel="z/Z", ylim=(0.01, 200), title="on the way, k_v = 1e6 s/m")
        axes["way"].legend(title="constant v", loc="lower right")
        return finish(
            built, "evidence_unbounded",
            "The first smooth law unwinds its bristles by v S_0(v) <= |v|, which is too little. At a constant slow speed, z "
            "grows within a fraction of a millimeter to any multiple of the bound that the other laws keep.",
        )  # fmt: skip


def _load(variants: Mapping[str, Variant], signal: Numbers) -> dict[str, float]:
    """How far each law lets the body move from t = 1 s to 17 s under a load of period 1 s or a part of it, m."""
    moved = {}
    for label, (law, constants) in variants.items():
        y = solve(
            Scenario(
                name="dithered_load", law={"name": law, "parameters": "canudas1995", **constants}, plant={"mass": 1.0},
                drive={"kind": "force", "signal": signal}, solve={"t_end": 17.0}, output={"step": 1.0},
            ),
            label,
        )["y"]  # fmt: skip
        moved[label] = float(y[17] - y[1])
    return moved


def dither() -> tuple[dict[str, dict[str, float]], Printed]:
    """How far every law drifts under two loads that stay below F_s, and the picture."""
    teeth = [(second + part, force) for second in range(18) for part, force in ((0.0, 0.0), (0.95, 0.55))]
    loads: dict[str, Numbers] = {
        "0.4 ± 0.25 N at 5 Hz": {"kind": "sine", "offset": 0.4, "amplitude": 0.25, "frequency": 5.0},
        "0 to 0.55 N, 1 Hz sawtooth": {"kind": "points", "t": [t for t, _ in teeth], "value": [x for _, x in teeth]},
    }
    moved = {title: _load(BRISTLES, signal) for title, signal in loads.items()}
    floor = 1e-16  # m: what is smaller is rounding
    with plots.style():
        built, axes = plots.figure([["drift"]], 2.9)
        axis, rows = axes["drift"], np.arange(len(BRISTLES))[::-1]
        for (i, (title, result)), mark in zip(enumerate(moved.items(), start=1), "os", strict=True):
            far, fill = np.maximum(np.abs(list(result.values())), floor), "none" if i > 1 else "full"
            axis.plot(far, rows, mark, color=plots.COLORS[i], label=title, markersize=6, fillstyle=fill)
        plots.logarithmic(axis, y=False)
        axis.set(xlabel="moved in 16 s (m); at the left edge: nothing but rounding", xlim=(0.5 * floor, 1e-2))
        axis.set_yticks(rows, list(BRISTLES))
        plots.legend(built, axis)
        figure = finish(
            built, "evidence_dither",
            "Loads below sigma_0 z_ba = 0.7 N and far below F_s = 1.5 N. Every law whose bristles relax while z is small walks "
            "away; the elasto-plastic law and its majorant version stay. The smooth elasto-plastic law of the paper's Remark 1 "
            "walks under the sawtooth, whose slow part winds its bristles less than the body moves.",
        )  # fmt: skip
    return moved, figure


def creep() -> tuple[Numbers, Printed]:
    """Creep under 0.95 F_s held against k_v: from the steady state, and simulated."""
    variants: dict[str, tuple[str, dict[str, float | str | None]]] = {
        "lugre_sobczyk": ("lugre_sobczyk", {}),
        **{f"lugre_majorant, {word}": ("lugre_majorant", {"smooth_abs": word}) for word in ("sqrt", "atan", "compact")},
    }
    k_v = np.geomspace(3e5, 3e8, 13)
    simulated: dict[str, dict[str, float]] = {}
    with plots.style():
        built, axes = plots.figure([["creep"]], 3.3)
        axis = axes["creep"]
        for i, (label, (name, own)) in enumerate(variants.items(), start=1):
            law = laws.law(name, "canudas1995", k_v=1.0, **own)
            plots.line(axis, i, k_v, [1e6 * creep_under(law.replace(k_v=k), _SHARE * law.p.F_s) for k in k_v], label)
            simulated[label] = {f"{k:.0e}": _held(name, {**own, "k_v": k}) for k in STEEPNESSES}
            dots = [1e6 * v for v in simulated[label].values()]
            axis.plot(STEEPNESSES, dots, "o", color=plots.COLORS[i], markersize=4)
        plots.logarithmic(axis)
        axis.set(xlabel="k_v (s/m)", ylabel="creep (µm/s)")
        plots.legend(built, axis)
        figure = finish(
            built, "evidence_creep",
            f"Creep under {_SHARE:g} F_s held (Table 1): from the steady state (lines) and simulated for 100 s (dots). Each law "
            f"creeps like 1/k_v: lugre_sobczyk at tan(pi F/(2 F_s))/k_v = {tan(_SHARE * pi / 2):.1f}/k_v, the majorants "
            "where v/m(v) = F/F_s: 3.04/k_v (sqrt), 1.47/k_v (arctan), 0.59/k_v (compact). lugre and lugre_arctan do not creep.",
        )  # fmt: skip
    return simulated, figure


def _held(name: str, own: Mapping[str, float | str | None]) -> float:
    """The speed at the end of 100 s under 0.95 F_s, reached in 10 s."""
    run = solve(
        Scenario(
            name="held_load", law={"name": name, "parameters": "canudas1995", **own}, plant={"mass": 1.0},
            drive={"kind": "force", "signal": {"kind": "points", "t": [0.0, 10.0], "value": [0.0, _SHARE * 1.5]}},
            solve={"t_end": 110.0}, output={"step": 10.0},
        )
    )  # fmt: skip
    return float(run["v"][-1])
