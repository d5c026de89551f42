"""A pneumatic servo whose friction is compensated: the paper's section 5, which it proves and does not simulate."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from examples.paper.common import Chapter, Done, Printed, finish, record, solve
from stribeck import examples
from stribeck.arrays import Array
from stribeck.loops.lyapunov import rises
from stribeck.mouth import plots
from stribeck.mouth.document import Table
from stribeck.scenario import Scenario
from stribeck.simulation import Solution

Changes = Mapping[str, object]

_LUGRE: Changes = {"name": "lugre"}
_MATCHED, _UNCOMPENSATED = "plant and observer lugre_sobczyk", "no compensation"
_EXAMPLE = "no compensation, the example's seal"
_TOO_STRONG = "lugre_sobczyk, all parameters 50 % too high"


def _observer(name: str, k_v: float = 1e6, **more: object) -> Changes:
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
    "lugre, sobczyk sampled every 1 ms, 12 bit, noise 20 µm": (
        _LUGRE, _observer("lugre_sobczyk"),
        {"drive.sample_time": 1e-3, "drive.quantization": 1 / 4096, "drive.noise": 2e-5, "drive.bandwidth": 150.0}),
    _UNCOMPENSATED: (_LUGRE, {"name": "none"}, {}),
}  # fmt: skip
_DRAWN = (_MATCHED, *list(_VARIANTS)[1:2], *list(_VARIANTS)[5:7], *list(_VARIANTS)[8:])
# A seal that sticks harder than the example's: bristles bend by 0.5 mm, not by 9 mm, and F_s is half as much again as F_c.
_STICKY = {"sigma_0": 1e5, "F_s": 50.0}
_SLOW = 20.0  # s, of a move of 0.2 m
_ROUND = (0.0, 1.0, 2.0, 3.0)  # s: a move of 0.1 m, a rest, the move back, a rest
_FLOOR = {"e": 1e-16, "V": 1e-26}  # below what a double can resolve here
_REST = 8.0  # s, how long the last rest of the moves is


def scenario(law: Changes, observer: Changes, **changes: object) -> Scenario:
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
    result = {
        label: solve(scenario(law, observer, **more), label) for label, (law, observer, more) in _VARIANTS.items()
    }
    moves, slow, adapted = _moves(), _slow(), _adapted()
    numbers = {
        "error": {label: _last(s) for label, s in result.items()},
        "V_end": {label: s.final["V"] for label, s in result.items()},
        "rises": {label: _rises(s) for label, s in result.items()},
        "rest": {label: float(s["e"][-1]) for label, s in moves.items()},
        "z_err_at_rest": {label: float(s["z_hat"][-1] - s["z"][-1]) for label, s in moves.items() if label != _UNCOMPENSATED},
        "stick_slips": {label: _stick_slips(s) for label, s in slow.items()},
        "adapted": {label: _adaptation(s) for label, s in adapted.items()},
    }  # fmt: skip
    rows = [
        [label, f"{_last(s):.2g}", f"{s.final['V']:.2g}", "no" if not _rises(s) else f"after {_rises(s)} rows"]
        for label, s in result.items()
    ]
    head = [
        "plant and observer (k_v = 1e6 unless said)",
        "largest error of the last 5 s (m)",
        "V at 20 s (J)",
        "V rises",
    ]
    tables = [Table(head, rows), _rest_table(moves), _adaptation_table(adapted)]
    figures = [
        _tracking(result),
        _inside(result[_MATCHED], result[_UNCOMPENSATED]),
        _moving(moves, slow),
        _adapting(adapted),
    ]
    data = record({label: result[label] for label in _DRAWN})
    title = "A pneumatic servo with friction compensation"
    return Chapter("servo", title, _text(result, moves, slow, adapted), tables, figures, numbers, data)


def _last(s: Solution) -> float:
    return float(np.max(np.abs(s["e"][len(s.t) * 3 // 4 :])))


def _rises(s: Solution) -> int:
    return int(rises(s["V"]).sum())


def _text(
    found: dict[str, Solution], moves: dict[str, Solution], slow: dict[str, Solution], adapted: dict[str, Solution]
) -> tuple[str, ...]:
    matched, none = _last(found[_MATCHED]), _last(found[_UNCOMPENSATED])
    sobczyk, majorant = (moves[name] for name in ("lugre_sobczyk", "lugre_majorant"))
    numbers = [_adaptation(s) for s in adapted.values()]
    worst = max(adapted.values(), key=lambda s: _adaptation(s)["last"])
    off = {n: abs(_adaptation(worst)[n] - 1) for n in ("sigma_0", "sigma_1", "sigma_2", "F_c")}
    return (
        "The paper proves that a cascade controller with its law as friction observer tracks without error, and shows no "
        "simulation. Its equations, with the printing errors put right, stand in the documentation; the plant is illustrative.",
        f"Where plant and observer follow the same law the error falls to {matched:.0e} m, the solver's floor; without "
        f"compensation it is {1e3 * none:.0f} mm. A plant under lugre is the honest case: no observer with dF/dt equals "
        "it. On the sine the majorant reaches the floor where the paper's law keeps an error in proportion to 1/k_v; at "
        f"rest it is the other way round: the majorant leaks and leaves a constant {_rest(majorant):.1e} m, "
        f"the paper's law {_rest(sobczyk):.0e} m.",
        "The paper's Remark 2 says that z_hat - z may stay where it is while the body rests. It does not: the error of the "
        "deflection acts on the body as a force, so the body cannot stay on its path before it is gone. After the moves it is "
        f"{abs(float(sobczyk['z_hat'][-1] - sobczyk['z'][-1])):.0e} m for the paper's law with the plant under lugre.",
        f"A slow move, 0.2 m in {_SLOW:g} s, with a seal that is stiffer and sticks harder than the example's: without "
        f"compensation the piston sticks and slips {_stick_slips(slow[_UNCOMPENSATED])} times on its way, with it "
        f"{_stick_slips(slow['lugre_sobczyk'])} times; with the example's seal {_stick_slips(slow[_EXAMPLE])} times, even "
        "without compensation.",
        "The adaptive controller does not reach the floor of the known case in the time shown: errors of "
        f"{min(n['last'] for n in numbers):.0e} to {max(n['last'] for n in numbers):.0e} m remain. What bounds them are the "
        "parameters that the path excites weakly: in the worst case "
        + ", ".join(f"{name} is off by {100 * x:.1f} %" for name, x in off.items())
        + ". On the sine, which excites all of them, error and parameters go on converging exponentially (the documentation).",
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
    result = {
        name: solve(scenario(_LUGRE, observer, **changes), name)
        for name, observer in {**observers, _UNCOMPENSATED: {"name": "none"}}.items()
    }
    result[_TOO_STRONG] = solve(scenario(_LUGRE, _observer("lugre_sobczyk"), wrong=1.5, **changes), _TOO_STRONG)
    return result


def _slow() -> dict[str, Solution]:
    """A slow move: with a seal that sticks, without and with compensation, and with the example's seal."""
    signal = {"kind": "point_to_point", "t": [0.0, _SLOW], "value": [0.4, 0.6]}
    changes = {"drive.signal": signal, "plant.initial.y": 0.4, "solve.t_end": _SLOW + 2, "output.step": 0.01}
    sticky = {f"law.parameters.{name}": x for name, x in _STICKY.items()}
    none = {"name": "none"}
    return {
        _UNCOMPENSATED: solve(scenario(_LUGRE, none, **changes, **sticky), _UNCOMPENSATED),
        "lugre_sobczyk": solve(scenario(_LUGRE, _observer("lugre_sobczyk"), **changes, **sticky), "lugre_sobczyk"),
        _EXAMPLE: solve(scenario(_LUGRE, none, **changes), _EXAMPLE),
    }


def _stick_slips(s: Solution) -> int:
    """How often the body slips, at more than twice v_s, after it all but stood on its way."""
    v = np.abs(s["v"][(s.t > 0.1 * _SLOW) & (s.t < 0.9 * _SLOW)])
    states = np.where(v > 0.04, 1, np.where(v < 2e-3, -1, 0))
    return int(np.sum(np.diff(states[states != 0]) > 0))


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


def _moving(moves: dict[str, Solution], slow: dict[str, Solution]) -> Printed:
    with plots.style():
        built, axes = plots.figure([["y", "y"], ["e", "v"]], 5.2)
        for i, (label, s) in enumerate(moves.items()):
            plots.line(axes["y"], i, s.t[::5], s["y"][::5], label)
            plots.line(axes["e"], i, *_largest(s, "e", 0.1), label)
        for i, (label, color) in enumerate(((_UNCOMPENSATED, 2), ("lugre_sobczyk", 0))):
            plots.line(axes["v"], color, slow[label].t, slow[label]["v"], label, zorder=3 + i)
        axes["y"].set(xlabel="t (s)", ylabel="y (m)", title="(a) two moves of 0.1 m, each way, and a rest")
        axes["e"].set(xlabel="t (s)", ylabel="|e| (m)", title="(b) largest error of 0.1 s")
        plots.logarithmic(axes["e"], x=False)
        axes["v"].set(xlabel="t (s)", ylabel="v (m/s)", title="(c) a slow move, a seal that sticks more")
        plots.legend(built, axes["y"])
        return finish(
            built, "servo_moves",
            "Without compensation the piston of the example stops short of its goal, and nothing removes the error, because the "
            "controller has no integral (so it cannot hunt either); its soft bristles and viscous friction keep it from "
            "sticking and slipping. (c) has another seal: sigma_0 = 1e5 N/m and F_s = 50 N, all else as before, moved 0.2 m in "
            f"{_SLOW:g} s: the compressed air is the spring, and the piston sticks and slips; compensation takes it away. "
            "With a compensator that is 50 % too strong the piston never comes to rest (a): a limit cycle.",
        )  # fmt: skip


# -- the sine --------------------------------------------------------------------------------------------------------


def _largest(s: Solution, name: str, window: float) -> tuple[Array, float]:
    """The largest magnitude of a column in each stretch of so many seconds: what a logarithmic axis can show."""
    size = round(window / s.scenario.output.step)
    rows = len(s.t) // size * size
    largest = np.abs(s[name][:rows]).reshape(-1, size).max(1)
    return s.t[:rows:size] + window / 2, np.maximum(largest, _FLOOR[name])


def _tracking(found: dict[str, Solution]) -> Printed:
    with plots.style():
        built, axes = plots.figure([["e"], ["V"]], 6.4)
        for i, label in enumerate(_DRAWN):
            for name, axis in axes.items():
                plots.line(axis, i, *_largest(found[label], name, 0.1), label)
        axes["e"].set(xlabel="t (s)", ylabel="|e| (m)", title="(a) tracking error, the largest of 0.1 s")
        axes["V"].set(xlabel="t (s)", ylabel="V (J)", title="(b) Lyapunov function, the largest of 0.1 s")
        for axis in axes.values():
            plots.logarithmic(axis, x=False)
        plots.legend(built, axes["e"])
        return finish(
            built, "servo_tracking",
            "Tracking 0.5 + 0.2 sin(2 pi 0.2 t) m from 10 mm beside it. V falls to the solver's floor where the observer has "
            "the plant's law; elsewhere it falls to what the difference of the laws or parameters leaves.",
        )  # fmt: skip


def _inside(s: Solution, none: Solution) -> Printed:
    shown = s.t <= 6.0
    t = s.t[shown]
    with plots.style():
        built, axes = plots.figure([["p", "u"], ["F", "z"]], 5.2)
        for i, (name, label) in enumerate((("p_1", "chamber 1"), ("p_2", "chamber 2"))):
            plots.line(axes["p"], i, t, s[name][shown] / 1e5, label)
        axes["p"].set(xlabel="t (s)", ylabel="pressure (bar)", title="(a) pressures", xlim=(0, 6))
        for i, (run, label) in enumerate(((s, "compensated"), (none, "no compensation"))):
            plots.line(axes["u"], i, t, run["u"][shown], label)
        axes["u"].set(xlabel="t (s)", ylabel="u (V)", title="(b) valve voltage", xlim=(0, 6), ylim=(-2.5, 2.5))
        for i, (name, label) in enumerate((("F", "friction"), ("F_hat", "estimate"))):
            plots.line(axes["F"], i, t, s[name][shown], label)
        axes["F"].set(xlabel="t (s)", ylabel="F (N)", title="(c) friction and estimate", xlim=(0, 6))
        for i, (name, label) in enumerate((("z", "z"), ("z_hat", "z_hat"))):
            plots.line(axes["z"], i, t, 1e3 * s[name][shown], label)
        axes["z"].set(xlabel="t (s)", ylabel="deflection (mm)", title="(d) z and its estimate", xlim=(0, 6))
        for panel, bottom in (("p", 2.4), ("F", -95), ("z", -12)):
            axes[panel].set_ylim(bottom=bottom)  # room for the legends
        for panel, axis in axes.items():
            axis.legend(loc="upper right" if panel == "u" else "lower left", fontsize=7)
        return finish(
            built, "servo_inside",
            f"The same run from inside ({_MATCHED}). The valve is at its limit of 10 V in the first instants (beyond the axis), "
            "the only time that the proof does not cover.",
        )  # fmt: skip


# -- the adaptive controller -----------------------------------------------------------------------------------------


def _adapted() -> dict[str, Solution]:
    """The controller that starts with all parameters half as large, or half as large again, on both paths."""
    period = [(4.0 * n + t, y) for n in range(50) for t, y in zip(_ROUND, (0.5, 0.6, 0.6, 0.5), strict=True)]
    moves = {"kind": "point_to_point", "t": [t for t, _ in period], "value": [y for _, y in period]}
    paths: dict[str, Changes] = {"sine": {"solve.t_end": 400.0}, "moves": {"drive.signal": moves}}
    law = _observer("lugre_sobczyk")
    shared = {"solve.t_end": 200.0, "solve.rtol": 1e-6, "output.step": 0.05, "drive.adaptive": True}
    return {
        f"{path}, all {word}": solve(scenario(law, law, wrong=factor, **{**shared, **changes}), path)
        for path, changes in paths.items() for word, factor in (("- 50 %", 0.5), ("+ 50 %", 1.5))
    }  # fmt: skip


def _adaptation(s: Solution) -> dict[str, float]:
    true = s.scenario.law.values
    period = round(5.0 / s.scenario.output.step)
    scales = {n: s.final[f"{n}_hat"] / (true[n] or 1.0) for n in ("sigma_0", "sigma_1", "sigma_2", "F_c")}
    return {
        "first": float(np.abs(s["e"][period // 5 : period]).max()),
        "last": float(np.abs(s["e"][-period:]).max()),
        **scales,
    }


def _adaptation_table(adapted: dict[str, Solution]) -> Table:
    head = ["adaptive, known parameters", "error, 1 to 5 s (m)", "error, last 5 s (m)", *(
        f"{n} / true" for n in ("sigma_0", "sigma_1", "sigma_2", "F_c"))]  # fmt: skip
    rows = []
    for label, s in adapted.items():
        first, last, *scales = _adaptation(s).values()
        rows.append([label, f"{first:.2g}", f"{last:.2g}", *(f"{x:.3f}" for x in scales)])
    return Table(head, rows)


def _adapting(adapted: dict[str, Solution]) -> Printed:
    with plots.style():
        built, axes = plots.figure([["e", "e"], ["sigma_0", "sigma_1"], ["sigma_2", "F_c"]], 6.4)
        for i, (label, s) in enumerate(adapted.items()):
            plots.line(axes["e"], i, *_largest(s, "e", 5.0), label)
            for name in ("sigma_0", "sigma_1", "sigma_2", "F_c"):
                plots.line(
                    axes[name], i, s.t[::40], s[f"{name}_hat"][::40] / (s.scenario.law.values[name] or 1.0), label
                )
        axes["e"].set(xlabel="t (s)", ylabel="|e| (m)", title="(a) largest error of 5 s")
        plots.logarithmic(axes["e"], x=False)
        for letter, name in zip("bcde", ("sigma_0", "sigma_1", "sigma_2", "F_c"), strict=True):
            axes[name].set(xlabel="t (s)", ylabel=f"{name} / true", title=f"({letter}) {name}")
        plots.legend(built, axes["e"])
        return finish(
            built, "servo_adaptive",
            "All of sigma_0, sigma_1, sigma_2, F_c and F_s start 50 % too low or too high. F_c converges first, because every "
            "reversal shows it. sigma_1 converges last, because it acts only within millimeters of a reversal. On the moves, "
            "sigma_0 and sigma_1 act only at the start and the end of a move. They are confounded there and separate slowly.",
        )  # fmt: skip
