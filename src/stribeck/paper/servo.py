"""A pneumatic servo whose friction is compensated: the paper's section 5, which it proves and does not simulate."""

from __future__ import annotations

from typing import Any

import numpy as np

from stribeck import examples
from stribeck.analysis.lyapunov import RISE
from stribeck.paper.common import Done, record, solve
from stribeck.report import plots
from stribeck.report.page import Chapter, FigureSvg, Table
from stribeck.scenario import Scenario
from stribeck.simulation import Solution

Changes = dict[str, Any]

_LUGRE: Changes = {"name": "lugre"}
_MATCHED, _UNCOMPENSATED = "plant and observer lugre_sobczyk", "no compensation"
_TOO_STRONG = "lugre_sobczyk, all parameters 50 % too high"


def _observer(name: str, k_v: float = 1e6, **more: Any) -> Changes:
    return {"name": name, "k_v": k_v, **more}


# label: the plant's law (without parameters), the observer, and other changes
_VARIANTS: dict[str, tuple[Changes, Changes, Changes]] = {
    _MATCHED: (_observer("lugre_sobczyk"), _observer("lugre_sobczyk"), {}),
    "lugre, observer lugre_sobczyk": (_LUGRE, _observer("lugre_sobczyk"), {}),
    "lugre, observer lugre_arctan": (_LUGRE, _observer("lugre_arctan"), {}),
    "lugre, observer lugre_majorant": (_LUGRE, _observer("lugre_majorant"), {}),
    "lugre, observer lugre_sobczyk, k_v = 1e4": (_LUGRE, _observer("lugre_sobczyk", 1e4), {}),
    "lugre, observer lugre_majorant, k_v = 1e4": (_LUGRE, _observer("lugre_majorant", 1e4), {}),
    "lugre, sobczyk that knows all parameters 20 % too high": (_LUGRE, _observer("lugre_sobczyk"), {"wrong": 1.2}),
    "lugre, sobczyk that knows all parameters 20 % too low": (_LUGRE, _observer("lugre_sobczyk"), {"wrong": 0.8}),
    "lugre, sobczyk sampled every 1 ms, 12 bit, noise 20 um": (
        _LUGRE, _observer("lugre_sobczyk"),
        {"drive.sample_time": 1e-3, "drive.quantisation": 1 / 4096, "drive.noise": 2e-5, "drive.bandwidth": 150.0}),
    _UNCOMPENSATED: (_LUGRE, {"name": "none"}, {}),
}  # fmt: skip
_DRAWN = (_MATCHED, *list(_VARIANTS)[1:2], *list(_VARIANTS)[5:7], *list(_VARIANTS)[8:])
_ROUND = (0.0, 1.0, 2.0, 3.0)  # s: a move of 0.1 m, a rest, the move back, a rest
_REST = 8.0  # s, how long the last rest of the moves is


def scenario(law: Changes, observer: Changes, **changes: Any) -> Scenario:
    """The example under a law and an observer; ``wrong`` is a factor of all that the observer knows."""
    data = Scenario.load(examples.path("servo")).data
    known = data["law"]["parameters"]
    wrong = changes.pop("wrong", None)
    if wrong is not None:
        observer = {**observer, "parameters": {n: wrong * x for n, x in known.items() if n != "v_s"}}
    data = {**data, "law": {**law, "parameters": known}, "drive": {**data["drive"], "observer": observer}}
    return Scenario(data).with_changes(changes)


def chapter(done: Done) -> Chapter:
    """Tracking of a sine, moves from point to point, and the adaptive controller."""
    found = {label: solve(scenario(law, observer, **more), label) for label, (law, observer, more) in _VARIANTS.items()}
    moves = _moves()
    adapted = _adapted()
    numbers = {
        "error": {label: _last(s) for label, s in found.items()},
        "V_end": {label: s.final["V"] for label, s in found.items()},
        "rises": {label: _rises(s) for label, s in found.items()},
        "rest": {label: float(s["e"][-1]) for label, s in moves.items()},
        "z_err_at_rest": {label: float(s["z_hat"][-1] - s["z"][-1]) for label, s in moves.items() if label != _UNCOMPENSATED},
        "adapted": {label: _adaptation(s) for label, s in adapted.items()},
    }  # fmt: skip
    rows = [
        [label, f"{_last(s):.2g}", f"{s.final['V']:.2g}", "no" if not _rises(s) else f"after {_rises(s)} rows"]
        for label, s in found.items()
    ]
    head = [
        "plant and observer (k_v = 1e6 unless said)",
        "largest error of the last 5 s (m)",
        "V at 20 s (J)",
        "V rises",
    ]
    tables = [Table(head, rows), _rest_table(moves), _adaptation_table(adapted)]
    figures = [_tracking(found), _inside(found[_MATCHED], found[_UNCOMPENSATED]), _moving(moves), _adapting(adapted)]
    data = record({label: found[label] for label in _DRAWN})
    title = "A pneumatic servo with friction compensation"
    return Chapter("servo", title, _text(found, moves), tables, figures, numbers, data)


def _last(s: Solution) -> float:
    return float(np.max(np.abs(s["e"][len(s.t) * 3 // 4 :])))


def _rises(s: Solution) -> int:
    return int(np.sum(np.diff(s["V"]) > RISE * s["V"][0]))


def _text(found: dict[str, Solution], moves: dict[str, Solution]) -> tuple[str, ...]:
    matched, none = _last(found[_MATCHED]), _last(found[_UNCOMPENSATED])
    sobczyk, majorant = (moves[name] for name in ("lugre_sobczyk", "lugre_majorant"))
    return (
        "The paper proves that a cascade controller with its law as friction observer tracks without error, and shows no "
        "simulation. Its equations, with the printing errors put right, stand in docs/servo.md; the plant is illustrative.",
        f"Where plant and observer follow the same law the error falls to {matched:.0e} m, the solver's floor; without "
        f"compensation it is {1e3 * none:.0f} mm. A plant under lugre is the honest case: no observer with dF/dt equals "
        "it. On the sine the majorant reaches the floor where the paper's law keeps an error in proportion to 1/k_v; at "
        f"rest it is the other way round: the majorant leaks and leaves a constant {_rest(majorant):.1e} m, "
        f"the paper's law {_rest(sobczyk):.0e} m.",
        "The paper's Remark 2 says that z_hat - z may stay where it is while the body rests. It does not: the error of the "
        "deflection acts on the body as a force, so the body cannot stay on its path before it is gone. After the moves it is "
        f"{abs(float(sobczyk['z_hat'][-1] - sobczyk['z'][-1])):.0e} m for the paper's law with the plant under lugre.",
    )


def _rest(s: Solution) -> float:
    """The error at the end of the last rest, m."""
    return abs(float(s["e"][-1]))


# -- moves from point to point ---------------------------------------------------------------------------------------


def _moves() -> dict[str, Solution]:
    """Two moves there and back, then a rest."""
    t = [*_ROUND, *(x + 4 for x in _ROUND)]
    signal = {"kind": "point_to_point", "t": t, "value": [0.5, 0.6, 0.6, 0.5, 0.5, 0.6, 0.6, 0.5]}
    changes = {"drive.signal": signal, "solve.t_end": t[-1] + _REST, "plant.initial.y": 0.5, "output.step": 0.005}
    observers = {name: _observer(name) for name in ("lugre_sobczyk", "lugre_majorant")}
    found = {
        name: solve(scenario(_LUGRE, observer, **changes), name)
        for name, observer in {**observers, _UNCOMPENSATED: {"name": "none"}}.items()
    }
    found[_TOO_STRONG] = solve(scenario(_LUGRE, _observer("lugre_sobczyk"), wrong=1.5, **changes), _TOO_STRONG)
    return found


def _rest_table(moves: dict[str, Solution]) -> Table:
    rows = []
    for label, s in moves.items():
        moving = float(np.max(np.abs(s["e"][s.t <= s.t[-1] - _REST])))
        z_err = "-" if label == _UNCOMPENSATED else f"{float(s['z_hat'][-1] - s['z'][-1]):.1e}"
        rows.append([label, f"{moving:.2g}", f"{s['e'][-1]:.2g}", z_err])
    head = [
        "moves, plant lugre, observer",
        "largest error while moving (m)",
        "error after the rest (m)",
        "z_hat - z there (m)",
    ]
    return Table(head, rows)


def _moving(moves: dict[str, Solution]) -> FigureSvg:
    with plots.style():
        made, axes = plots.figure([["y", "y"], ["e", "v"]], 5.2)
        for i, (label, s) in enumerate(moves.items()):
            plots.line(axes["y"], i, s.t, s["y"], label)
            plots.line(axes["e"], i, s.t, np.maximum(np.abs(s["e"]), 1e-16), label)
            plots.line(axes["v"], i, s.t, s["v"], label)
        axes["y"].set(xlabel="t (s)", ylabel="y (m)", title="(a) two moves of 0.1 m, each way, and a rest")
        axes["e"].set(xlabel="t (s)", ylabel="|e| (m)", yscale="log", title="(b) error")
        axes["v"].set(xlabel="t (s)", ylabel="v (m/s)", title="(c) velocity at the end of the rest")
        axes["v"].set_xlim(s.t[-1] - 1.5, s.t[-1])
        plots.legend(made, axes["y"])
        return plots.finish(
            made, "servo_moves",
            "Without compensation the piston stops short of its goal, and nothing removes the error, because the controller "
            "has no integral; it does not stick and slip, because its viscous friction and the controller damp it. With a "
            "compensator that is 50 % too strong it never comes to rest: a limit cycle, as PID control has one for another "
            "reason.",
        )  # fmt: skip


# -- the sine --------------------------------------------------------------------------------------------------------


def _tracking(found: dict[str, Solution]) -> FigureSvg:
    with plots.style():
        made, axes = plots.figure([["e"], ["V"]], 6.4)
        for i, label in enumerate(_DRAWN):
            s = found[label]
            plots.line(axes["e"], i, s.t, np.maximum(np.abs(s["e"]), 1e-14), label)
            plots.line(axes["V"], i, s.t, np.maximum(s["V"], 1e-24), label)
        axes["e"].set(xlabel="t (s)", ylabel="|e| (m)", yscale="log", title="(a) tracking error")
        axes["V"].set(xlabel="t (s)", ylabel="V (J)", yscale="log", title="(b) Lyapunov function")
        plots.legend(made, axes["e"])
        return plots.finish(
            made, "servo_tracking",
            "Tracking 0.5 + 0.2 sin(2 pi 0.2 t) m from 10 mm beside it. V falls to the solver's floor where the observer has "
            "the plant's law; elsewhere it falls to what the difference of the laws or parameters leaves.",
        )  # fmt: skip


def _inside(s: Solution, none: Solution) -> FigureSvg:
    with plots.style():
        made, axes = plots.figure([["p", "u"], ["F", "z"]], 5.2)
        for i, (name, label) in enumerate((("p_1", "chamber 1"), ("p_2", "chamber 2"))):
            plots.line(axes["p"], i, s.t, s[name] / 1e5, label)
        axes["p"].set(xlabel="t (s)", ylabel="pressure (bar)", title="(a) pressures", xlim=(0, 6))
        for i, (run, label) in enumerate(((s, "compensated"), (none, "no compensation"))):
            plots.line(axes["u"], i, run.t, run["u"], label)
        axes["u"].set(xlabel="t (s)", ylabel="u (V)", title="(b) valve voltage", xlim=(0, 6), ylim=(-2.5, 2.5))
        for i, (name, label) in enumerate((("F", "friction"), ("F_hat", "estimate"))):
            plots.line(axes["F"], i, s.t, s[name], label)
        axes["F"].set(xlabel="t (s)", ylabel="F (N)", title="(c) friction and estimate", xlim=(0, 6))
        for i, (name, label) in enumerate((("z", "z"), ("z_hat", "z_hat"))):
            plots.line(axes["z"], i, s.t, 1e3 * s[name], label)
        axes["z"].set(xlabel="t (s)", ylabel="deflection (mm)", title="(d) z and its estimate", xlim=(0, 6))
        for panel, bottom in (("p", 2.4), ("F", -95), ("z", -12)):
            axes[panel].set_ylim(bottom=bottom)  # room for the legends
        for panel, axis in axes.items():
            axis.legend(loc="upper right" if panel == "u" else "lower left", fontsize=7)
        return plots.finish(
            made, "servo_inside",
            f"The same run from inside ({_MATCHED}). The valve is at its limit of 10 V in the first instants (beyond the axis), "
            "the only time that the proof does not cover.",
        )  # fmt: skip


# -- the adaptive controller -----------------------------------------------------------------------------------------


def _adapted() -> dict[str, Solution]:
    """The controller that starts with all parameters half as large, or half as large again, on both paths."""
    period = [(4.0 * n + t, y) for n in range(50) for t, y in zip(_ROUND, (0.5, 0.6, 0.6, 0.5), strict=True)]
    moves = {"kind": "point_to_point", "t": [t for t, _ in period], "value": [y for _, y in period]}
    paths: dict[str, Changes] = {"sine": {}, "moves": {"drive.signal": moves}}
    law = _observer("lugre_sobczyk")
    shared = {"solve.t_end": 200.0, "output.step": 0.05, "drive.adaptive": True}
    return {
        f"{path}, all {word}": solve(scenario(law, law, wrong=factor, **shared, **changes), path)
        for path, changes in paths.items() for word, factor in (("- 50 %", 0.5), ("+ 50 %", 1.5))
    }  # fmt: skip


def _adaptation(s: Solution) -> dict[str, Any]:
    true = s.scenario.law.values
    period = round(5.0 / s.scenario.output.step)
    scales = {n: s.final[f"{n}_hat"] / (true[n] or 1.0) for n in ("sigma_0", "sigma_1", "sigma_2", "F_c")}
    return {
        "first": float(np.abs(s["e"][period // 5 : period]).max()),
        "last": float(np.abs(s["e"][-period:]).max()),
        **scales,
    }


def _adaptation_table(adapted: dict[str, Solution]) -> Table:
    head = ["adaptive, known parameters", "error, 1 to 5 s (m)", "error, 195 to 200 s (m)", *(
        f"{n} / true" for n in ("sigma_0", "sigma_1", "sigma_2", "F_c"))]  # fmt: skip
    rows = []
    for label, s in adapted.items():
        first, last, *scales = _adaptation(s).values()
        rows.append([label, f"{first:.2g}", f"{last:.2g}", *(f"{x:.3f}" for x in scales)])
    return Table(head, rows)


def _adapting(adapted: dict[str, Solution]) -> FigureSvg:
    with plots.style():
        made, axes = plots.figure([["e", "e"], ["sigma_0", "sigma_1"], ["sigma_2", "F_c"]], 6.4)
        for i, (label, s) in enumerate(adapted.items()):
            period = round(4.0 / s.scenario.output.step)
            windows = np.abs(s["e"][: len(s.t) // period * period]).reshape(-1, period).max(1)
            plots.line(axes["e"], i, 4.0 * (np.arange(len(windows)) + 0.5), windows, label)
            for name in ("sigma_0", "sigma_1", "sigma_2", "F_c"):
                plots.line(axes[name], i, s.t[::8], s[f"{name}_hat"][::8] / (s.scenario.law.values[name] or 1.0), label)
        axes["e"].set(xlabel="t (s)", ylabel="|e| (m)", yscale="log", title="(a) largest error of 4 s")
        for letter, name in zip("bcde", ("sigma_0", "sigma_1", "sigma_2", "F_c"), strict=True):
            axes[name].set(xlabel="t (s)", ylabel=f"{name} / true", title=f"({letter}) {name}")
        plots.legend(made, axes["e"])
        return plots.finish(
            made, "servo_adaptive",
            "All of sigma_0, sigma_1, sigma_2, F_c and F_s start 50 % too low or too high. F_c, which every reversal shows, is "
            "found first; sigma_1 acts only within a few millimetres of a reversal and hardly moves the error, so it is found "
            "last, and what it leaves wrong bounds the error.",
        )  # fmt: skip
