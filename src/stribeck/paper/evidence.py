"""The figures of the chapter on guarantees: why a law has a property, or has it not."""

from __future__ import annotations

from collections.abc import Mapping
from math import pi, tan
from typing import Any

import numpy as np

from stribeck import laws
from stribeck.analysis.advise.search import with_k_v
from stribeck.analysis.advise.steady import Creep
from stribeck.analysis.properties import storage_interval
from stribeck.analysis.properties.cycles import integrate
from stribeck.laws.base import Law
from stribeck.laws.terms import g
from stribeck.paper.common import STEEPNESSES, Variant, solve
from stribeck.paper.statements import passivity_cycle
from stribeck.report import plots
from stribeck.report.page import FigureSvg
from stribeck.scenario import Scenario

_V_MAX = 0.02  # m/s: LuGre with Table 1 is passive up to about twice that
_SHARE = 0.95
Numbers = dict[str, Any]


def storage(made: Mapping[str, Law]) -> FigureSvg:
    """L(z) and U(z) of each law: where the one passes the other there is no storage function."""
    names = list(made)
    with plots.style():
        figure, axes = plots.figure([names[:4], names[4:]], 4.6)
        for name, law in made.items():
            Z = float(law.z_bound(law.p))
            share = np.concatenate([np.linspace(0.004, 0.9, 180), np.linspace(0.905, 0.998, 60)])
            low, high = storage_interval(law, share * Z, _V_MAX)
            scale = law.p.sigma_0 * Z
            axis = axes[name]
            a, b = (np.clip(x / scale, -9, 9) for x in (low, high))
            axis.fill_between(share, a, b, where=a <= b, color=plots.COLOURS[6], alpha=0.35, linewidth=0)
            axis.fill_between(
                share, b, a, where=a > b * (1 + 1e-9) + 1e-12, color=plots.COLOURS[1], alpha=0.35, linewidth=0
            )
            plots.line(axis, 2, share, b, "U: energy that winding up needs")
            plots.line(axis, 1, share, a, "L: energy that unwinding gives back")
            axis.plot(share, share, color=plots.GREY, linewidth=0.8, label="sigma_0 z")
            axis.set(title=name, ylim=(-0.4, 3.4), xlim=(0, 1))
        for name in names[4:]:
            axes[name].set_xlabel("z/Z")
        for name in (names[0], names[4]):
            axes[name].set_ylabel("J/m, over sigma_0 Z")
        plots.legend(figure, axes[names[0]])
        return plots.finish(
            figure, "guarantees_storage",
            f"The slope of a storage function must lie between L and U (Table 1, |v| <= {_V_MAX:g} m/s, Z = F_s/sigma_0, Dahl's "
            "F_c/sigma_0). Where L is above U (orange) there is none, and two speeds by turns draw energy: in both of "
            "Sobczyk's laws for every z, however slow. In the others the elastic energy, of slope sigma_0 z, fits in at this speed.",
        )  # fmt: skip


def energy(law: Law) -> tuple[Numbers, FigureSvg]:
    """What lugre_sobczyk gives back when its bristles are unwound slowly, and the cycle that is replayed."""
    k_v, charged = float(law.p.k_v), 1e-6
    e = np.geomspace(1e-3, 30, 60)
    found = np.array([integrate(law, -x / k_v, charged, 0.0) for x in e])
    cycle = passivity_cycle(k_v)
    limit = pi / 2 * law.p.sigma_0 * g(law.p, 0.0) * charged / e
    with plots.style():
        made, axes = plots.figure([["energy", "time"]], 3.2)
        axis = axes["energy"]
        plots.line(axis, 1, e / k_v, -1e9 * found[:, 1], "drawn by unwinding at this speed")
        plots.line(axis, 2, e / k_v, 1e9 * limit, "pi sigma_0 g z/(2 e), e = k_v |v|")
        axis.axhline(1e9 * cycle["put_in"], color=plots.GREY, linewidth=1.0, label="put in by charging")
        dot = {"color": plots.COLOURS[0], "markersize": 5}
        axis.plot([1 / k_v], [1e9 * cycle["drawn_out"]], "o", label="replayed", **dot)
        axis.set(xscale="log", yscale="log", xlabel="speed of unwinding (m/s)", ylabel="energy (nJ)")
        plots.line(axes["time"], 1, e / k_v, found[:, 0], "time")
        axes["time"].plot([1 / k_v], [cycle["time"]], "o", **dot)
        axes["time"].set(xscale="log", yscale="log", xlabel="speed of unwinding (m/s)", ylabel="time (s)")
        plots.legend(made, axis)
        figure = plots.finish(
            made, "guarantees_energy",
            f"lugre_sobczyk, Table 1, k_v = {k_v:.0e} s/m, charged to z = 1 um at {10 / k_v:.0e} m/s and unwound to z = 0. The slower, the "
            "more it gives back, like 1/e, and the longer it takes, like 1/e^2; no store can pay for it. "
            f"The cycle marked takes {cycle['time']:.2g} s and draws {1e9 * (cycle['drawn_out'] - cycle['put_in']):.0f} nJ in all.",
        )  # fmt: skip
    return cycle, figure


def unbounded() -> FigureSvg:
    """z of lugre_arctan at slow speeds: in the limit, and on the way there."""
    law = laws.law("lugre_arctan", "canudas1995", k_v=1e6)
    Z = float(law.z_bound(law.p))
    v = np.geomspace(1e-10, 1e-3, 200)
    with plots.style():
        made, axes = plots.figure([["limit", "way"]], 3.2)
        axis = axes["limit"]
        axis.axhline(1.0, color=plots.GREY, linewidth=1.0, label="Z = F_s/sigma_0, the bound of the other laws")
        for i, k_v in enumerate(STEEPNESSES, start=1):
            plots.line(axis, i, v, with_k_v(law, k_v).steady_deflection(v) / Z, f"k_v = 1e{round(np.log10(k_v))} s/m")
        axis.set(xscale="log", yscale="log", xlabel="v held (m/s)", ylabel="z/Z", title="limit, g pi/(2 arctan(k_v v))")
        for i, speed in enumerate((1e-6, 1e-7, 1e-8), start=1):
            distance = 1e-3
            run = solve(
                Scenario(
                    name="slow", law={"name": law.name, "k_v": 1e6, "parameters": "canudas1995"},
                    drive={"kind": "velocity", "signal": {"kind": "points", "t": [0.0, 1.0], "value": [speed, speed]}},
                    solve={"t_end": distance / speed}, output={"step": distance / speed / 400},
                )
            )  # fmt: skip
            plots.line(axes["way"], i, 1e3 * run["y"], run["z"] / Z, f"{speed:.0e} m/s")
        axes["way"].axhline(1.0, color=plots.GREY, linewidth=1.0)
        axes["way"].set(xlabel="distance (mm)", ylabel="z/Z", yscale="log", title="on the way, k_v = 1e6 s/m")
        axes["way"].legend(title="v held", loc="lower right")
        plots.legend(made, axis)
        return plots.finish(
            made, "guarantees_unbounded",
            "The first smooth law unwinds its bristles by v S_0(v) <= |v|, which is too little: held at a slow speed, z goes to "
            "any multiple of the bound that the other laws keep, within a fraction of a millimetre.",
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


def dither(variants: Mapping[str, Variant]) -> tuple[dict[str, dict[str, float]], FigureSvg]:
    """How far every law drifts under two loads that stay below F_s, and the picture."""
    sine = _load(variants, {"kind": "sine", "offset": 0.4, "amplitude": 0.25, "frequency": 5.0})
    teeth = [(second + part, force) for second in range(18) for part, force in ((0.0, 0.0), (0.95, 0.55))]
    saw = _load(variants, {"kind": "points", "t": [t for t, _ in teeth], "value": [force for _, force in teeth]})
    moved = {label: {"sine": sine[label], "sawtooth": saw[label]} for label in variants}
    floor = 1e-16  # m: what is smaller is rounding
    with plots.style():
        made, axes = plots.figure([["drift"]], 2.9)
        axis, rows = axes["drift"], np.arange(len(variants))[::-1]
        for i, (found, title, mark) in enumerate(
            ((sine, "0.4 +- 0.25 N at 5 Hz", "o"), (saw, "0 to 0.55 N, 1 Hz sawtooth", "s")), start=1
        ):
            far = np.maximum(np.abs(list(found.values())), floor)
            axis.plot(
                far,
                rows,
                mark,
                color=plots.COLOURS[i],
                label=title,
                markersize=6,
                fillstyle="none" if i > 1 else "full",
            )
        axis.set(
            xscale="log", xlabel="moved in 16 s (m); at the left edge: nothing but rounding", xlim=(0.5 * floor, 1e-2)
        )
        axis.set_yticks(rows, list(variants))
        plots.legend(made, axis)
        figure = plots.finish(
            made, "guarantees_dither",
            "Loads below sigma_0 z_ba = 0.7 N and far below F_s = 1.5 N. Every law whose bristles relax while z is small walks away; "
            "the elasto-plastic law and its majorant version stay. The smooth elasto-plastic law of the paper's Remark 1 walks under the "
            "sawtooth, whose slow part winds its bristles less than the body moves.",
        )  # fmt: skip
    return moved, figure


def creep() -> tuple[Numbers, FigureSvg]:
    """Creep under 0.95 F_s held against k_v: from the steady state, and simulated."""
    variants: dict[str, Variant] = {
        "lugre_sobczyk": ("lugre_sobczyk", {}),
        **{f"lugre_majorant, {word}": ("lugre_majorant", {"smooth_abs": word}) for word in ("sqrt", "atan", "compact")},
    }  # type: ignore[dict-item]
    k_v = np.geomspace(3e5, 3e8, 31)
    simulated: dict[str, dict[str, float]] = {}
    with plots.style():
        made, axes = plots.figure([["creep"]], 3.3)
        axis = axes["creep"]
        for i, (label, (name, own)) in enumerate(variants.items(), start=1):
            law = laws.law(name, "canudas1995", k_v=1.0, **own)
            plots.line(axis, i, k_v, [1e6 * Creep(1.0, _SHARE).measure(with_k_v(law, k)) for k in k_v], label)
            simulated[label] = {f"{k:.0e}": _held(name, {**own, "k_v": k}) for k in STEEPNESSES}
            axis.plot(
                STEEPNESSES, [1e6 * v for v in simulated[label].values()], "o", color=plots.COLOURS[i], markersize=4
            )
        axis.set(xscale="log", yscale="log", xlabel="k_v (s/m)", ylabel="creep (um/s)")
        plots.legend(made, axis)
        figure = plots.finish(
            made, "guarantees_creep",
            f"Creep under {_SHARE:g} F_s held (Table 1): from the steady state (lines) and simulated for 100 s (dots). Each law creeps in "
            f"proportion to 1/k_v: lugre_sobczyk at tan(pi F/(2 F_s))/k_v = {tan(_SHARE * pi / 2):.1f}/k_v, the majorants where v/m(v) = F/F_s: "
            "3.04/k_v (sqrt), 1.47/k_v (arctan), 0.59/k_v (compact). lugre and lugre_arctan do not creep.",
        )  # fmt: skip
    return simulated, figure


def _held(name: str, own: Mapping[str, Any]) -> float:
    """The speed at the end of 100 s under 0.95 F_s, reached in 10 s."""
    run = solve(
        Scenario(
            name="held_load", law={"name": name, "parameters": "canudas1995", **own}, plant={"mass": 1.0},
            drive={"kind": "force", "signal": {"kind": "points", "t": [0.0, 10.0], "value": [0.0, _SHARE * 1.5]}},
            solve={"t_end": 110.0}, output={"step": 10.0},
        )
    )  # fmt: skip
    return float(run["v"][-1])
