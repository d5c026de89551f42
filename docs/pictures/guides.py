"""Draws the figures of the guides into this folder: python docs/pictures/guides.py [FOLDER]."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyBboxPatch

import stribeck
from stribeck.cli import _status
from stribeck.laws import find

plt.rcParams.update(
    {"svg.hashsalt": "stribeck", "svg.fonttype": "none", "axes.spines.top": False, "axes.spines.right": False}
)
BLUE, RED, GRAY = "#3572b0", "#c4412f", "#999999"
PAPER = "canudas1995"  # the parameters of the paper's Table 1
WIDTH = 5.2  # inches: a phone, 358 px wide, then shows text of 10 points as 9.5 px


def saved(figure: plt.Figure, file: Path) -> None:
    """Write a figure without a date, so that the same numbers give the same file."""
    figure.savefig(file, metadata={"Date": None})
    plt.close(figure)


def example(name: str, folder: Path, **changes: object) -> stribeck.Scenario:
    """A built-in example, written to a folder and read back with some values replaced."""
    if not (folder / f"{name}.toml").exists():
        _status(["new", name, "--out", str(folder / f"{name}.toml")])
    return stribeck.load(folder / f"{name}.toml", {path.replace("__", "."): x for path, x in changes.items()})


def draw_hunts(file: Path) -> None:
    """The axis of 'stribeck new axis-hunts', with its integral gain and with a fiftieth of it."""
    figure, plot = plt.subplots(figsize=(WIDTH, 2.6), layout="constrained")
    with tempfile.TemporaryDirectory() as folder:
        for gain, words, color in ((2e5, "K_i = 200 kN/(m s): hunts", RED), (4e3, "K_i = 4 kN/(m s): quiet", BLUE)):
            solution = stribeck.simulate(example("axis_hunts", Path(folder), controllers__axis__K_i=gain))
            shown = solution.t < 10
            plot.plot(solution.t[shown][::5], 1e3 * solution["slide.y"][shown][::5], color=color, label=words, lw=1)
    plot.axhline(10, color=GRAY, lw=0.8, ls="--", label="target")
    plot.set(xlabel="time (s)", ylabel="position (mm)", ylim=(8, 12))
    figure.legend(frameon=False, loc="outside upper center", ncols=2)
    saved(figure, file)


def draw_windup(file: Path) -> None:
    """Position and controller's force of 'stribeck new axis-hunts': the force is a ramp while the slide sticks."""
    with tempfile.TemporaryDirectory() as folder:
        solution = stribeck.simulate(example("axis_hunts", Path(folder)))
    shown = (solution.t > 4) & (solution.t < 6)
    figure, (above, below) = plt.subplots(2, figsize=(WIDTH, 3.4), sharex=True, layout="constrained")
    above.plot(solution.t[shown], 1e3 * solution["slide.y"][shown], color=RED, lw=1)
    above.axhline(10, color=GRAY, lw=0.8, ls="--")
    above.set_ylabel("slide.y (mm)")
    below.plot(solution.t[shown], solution["axis.u"][shown], color=BLUE, lw=1)
    below.set(xlabel="time (s)", ylabel="axis.u (N)")
    saved(figure, file)


def draw_two_laws(file: Path) -> None:
    """Stick-slip of 'stribeck new stick-slip' under two laws: the friction force, and the position's deviation."""
    with tempfile.TemporaryDirectory() as folder:
        first, second = (
            stribeck.simulate(example("stick_slip", Path(folder), law__name=law)) for law in ("lugre", "lugre_sobczyk")
        )
    figure, (above, below) = plt.subplots(2, figsize=(WIDTH, 3.4), sharex=True, layout="constrained")
    for solution, color, dashes, law in ((first, GRAY, "-", "lugre"), (second, BLUE, "--", "lugre_sobczyk")):
        above.plot(solution.t[::4], solution["F"][::4], dashes, color=color, lw=1.2, label=law)
    above.set_ylabel("F (N)")
    above.legend(frameon=False)
    below.plot(first.t[::4], 1e3 * (second["y"] - first["y"])[::4], color=BLUE, lw=1)
    below.set(xlabel="time (s)", ylabel="deviation of y (mm)")
    saved(figure, file)


def draw_joint(file: Path) -> None:
    """The held-out recording of 'stribeck new joint-from-log' beside the fitted machine's motion."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        _status(["new", "joint-from-log", "--out", str(folder / "joint.toml")])
        logs, record = folder / "joint.logs.toml", folder / "joint_from_log_2.csv"
        fit = ["fit", str(folder / "joint.toml"), "--logs", str(logs), "--starts", "4", "--out", str(folder / "fit")]
        assert _status(fit) == 0
        measured = np.genfromtxt(record, delimiter=",", names=True)
        changes = {
            "loads.motor.signal.path": str(record),
            "bodies.joint.initial.y": float(measured["angle"][0]),
            "solve.t_end": float(measured["t"][-1]),
        }
        solution = stribeck.simulate(stribeck.load(folder / "fit" / "machine.toml", changes))
    figure, (above, below) = plt.subplots(2, figsize=(WIDTH, 3.4), sharex=True, layout="constrained")
    above.plot(measured["t"][::4], measured["torque"][::4], color=GRAY, lw=1)
    above.set_ylabel("torque (N m)")
    below.plot(measured["t"][::24], measured["angle"][::24], ".", ms=5, color=GRAY, label="held-out recording")
    below.plot(solution.t, solution["joint.y"], color=BLUE, lw=1, label="fitted machine")
    below.set(xlabel="time (s)", ylabel="angle (rad)")
    figure.legend(frameon=False, loc="outside upper center", ncols=2)
    saved(figure, file)


def draw_kv(file: Path) -> None:
    """How fast a body creeps under 0.95 F_s, against k_v, for two smooth laws."""
    figure, plot = plt.subplots(figsize=(WIDTH, 2.6), layout="constrained")
    steepness = np.geomspace(1e5, 1e8, 13)
    for name, color in (("lugre_sobczyk", RED), ("lugre_majorant", BLUE)):
        creep = []
        for k_v in steepness:
            law = stribeck.law(name, PAPER, k_v=float(k_v))
            speeds = np.geomspace(1e-9, 1e-3, 2001)
            over = np.flatnonzero(law.steady_force(speeds) >= 0.95 * law.values["F_s"])
            creep.append(1e6 * speeds[over[0]] if len(over) else np.nan)  # nan: it breaks away
        plot.loglog(steepness, creep, "o-", ms=3, color=color, label=name)
    plot.axhline(1, color=GRAY, lw=0.8, ls="--", label="tolerance of the example")
    plot.set(xlabel="k_v (s/m)", ylabel="creep under 0.95 F_s (\N{MICRO SIGN}m/s)")
    plot.legend(frameon=False)
    saved(figure, file)


def draw_creep(file: Path) -> None:
    """A joint that holds a load: the torque of regularized friction lets it sink, bristles do not."""
    figure, plot = plt.subplots(figsize=(WIDTH, 2.4), layout="constrained")
    for law, words, color in (
        ({"name": "stribeck_tanh", "k_v": 100.0, "parameters": PAPER}, "tanh(100 v), as engines regularize", RED),
        ({"name": "elastoplastic_majorant", "k_v": 1e7, "z_ba": 9.5e-6, "parameters": PAPER}, "bristles", BLUE),
    ):
        solution = stribeck.simulate(
            stribeck.Scenario(
                law=law, plant={"mass": 1.0},
                drive={"kind": "force", "signal": {"kind": "step", "time": 0.0, "value": 0.9}},
                solve={"t_end": 5.0}, output={"step": 0.05},
            )
        )  # fmt: skip
        plot.plot(solution.t, 1e3 * solution["y"], color=color, label=words)
    plot.set(xlabel="time (s)", ylabel="position (mm)")
    plot.legend(frameon=False)
    saved(figure, file)


def draw_blocks(file: Path) -> None:
    """The block of an FMU of a law within a model of a mass: the friction is subtracted from the force that drives the mass."""
    figure, plot = plt.subplots(figsize=(WIDTH, 2.2), layout="constrained")
    plot.set(xlim=(0, 10), ylim=(0.2, 3.2), aspect="equal")
    plot.axis("off")
    for x, width, words in ((3.0, 1.7, "mass\n1/(m s)"), (6.5, 1.9, "FMU\nfriction")):
        plot.add_patch(FancyBboxPatch((x, 1.6), width, 1.1, "round,pad=0.08", fc="white", ec=BLUE, lw=1.5))
        plot.text(x + width / 2, 2.15, words, ha="center", va="center")
    plot.add_patch(Circle((1.7, 2.15), 0.25, fc="white", ec="black", lw=1.2))
    for x, y, sign in ((1.3, 2.35, "+"), (1.95, 1.62, "\N{MINUS SIGN}")):
        plot.text(x, y, sign, ha="center", va="center")
    arrow = {"arrowstyle": "-|>", "color": "black", "lw": 1.2, "shrinkA": 0, "shrinkB": 0}
    for start, end, words in (
        ((0.1, 2.15), (1.45, 2.15), "drive"), ((1.95, 2.15), (2.92, 2.15), ""), ((4.78, 2.15), (6.42, 2.15), "velocity v"),
        ((8.48, 2.15), (9.9, 2.15), "friction F"), ((1.7, 0.7), (1.7, 1.9), ""),
    ):  # fmt: skip
        plot.annotate("", end, start, arrowprops=arrow)
        plot.text((start[0] + end[0]) / 2, 2.3, words, ha="center", va="bottom")
    plot.plot([9.2, 9.2, 1.7], [2.15, 0.7, 0.7], color="black", lw=1.2)
    saved(figure, file)


def draw_map(file: Path) -> None:
    """Slips in 40 s of a pulled slider: 40 x 40 simulations of one batch."""
    with tempfile.TemporaryDirectory() as folder:
        scenario = example("stick_slip", Path(folder), law__name="lugre_majorant")
        F_s, stiffness = np.meshgrid(np.linspace(1.02, 2.0, 40), np.linspace(0.5, 6.0, 40))
        varied = {"law.parameters.F_s": F_s.ravel(), "drive.stiffness": stiffness.ravel()}
        ensemble = stribeck.simulate(scenario, varied)
    figure, plot = plt.subplots(figsize=(WIDTH, 3.0), layout="constrained")
    image = plot.pcolormesh(F_s, stiffness, ensemble.slips.reshape(F_s.shape), cmap="Blues", rasterized=True)
    figure.colorbar(image, label="slips in 40 s")
    once = ensemble.slips.reshape(F_s.shape) <= 1
    plot.text(1.03, float(stiffness[once].mean()), "slides steadily\nafter one slip", va="center", fontsize=9)
    plot.set(xlabel="F_s (N)", ylabel="stiffness of the spring (N/m)")
    saved(figure, file)


OWN_LAW = """
from stribeck.constants import Constant
from stribeck.expressions.ops import sqrt
from stribeck.laws import BristleLaw, Claims
from stribeck.laws.terms import g


class RootLuGre(BristleLaw):
    name, source = "root_lugre", "the guide"
    claims = Claims(unique=True, bounded=True, smooth=True, passive=False, drift_free=False)
    k_v = Constant("s/m", "steepness of the smooth |v|", above=0, example=1e6)

    @staticmethod
    def dz_dt(p, v, z):
        return v - sqrt(v**2 + 1 / p.k_v**2) / g(p, v) * z
"""


def draw_own_law(file: Path) -> None:
    """Hysteresis of the guide's own law beside LuGre's, under a small sine of the speed."""
    figure, plot = plt.subplots(figsize=(WIDTH, 2.8), layout="constrained")
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "mylaw.py").write_text(OWN_LAW, encoding="utf-8")
        for name, constants, color in (("lugre", {}, GRAY), (f"{folder}/mylaw.py:RootLuGre", {"k_v": 1e4}, BLUE)):
            law = find(name)({**stribeck.library(PAPER).sets[PAPER].values, **constants})
            scenario = stribeck.Scenario(
                law=law, drive={"kind": "velocity", "signal": {"kind": "sine", "amplitude": 1e-3, "frequency": 2.0}},
                solve={"t_end": 1.5}, output={"step": 1e-3},
            )  # fmt: skip
            solution = stribeck.simulate(scenario)
            shown = solution.t > 0.5
            plot.plot(1e3 * solution["v"][shown], solution["F"][shown], color=color, label=law.name)
    plot.set(xlabel="velocity (mm/s)", ylabel="friction (N)")
    plot.legend(frameon=False)
    saved(figure, file)


def draw_plan(file: Path) -> None:
    """The tests of 'stribeck fit --plan stroke=0.05,speed=0.1,force=50,deflection=1e-5', one after the other."""
    from stribeck.identify.plan import Limits, program

    tests = program(Limits(stroke=0.05, speed=0.1, force=50.0, deflection=1e-5))
    figure, (above, below) = plt.subplots(2, figsize=(WIDTH, 4.0), layout="constrained")
    time, kinds = 0.0, dict[str, list[float]]()
    for test in (each for each in tests if each.control == "motion"):
        v = test.velocity(1e-3)
        above.plot(time + 1e-3 * np.arange(len(v)), 1e3 * v, color=BLUE, lw=1)
        kinds.setdefault(test.kind, []).extend([time, time + 1e-3 * len(v)])
        time += 1e-3 * len(v)
    words = {
        "presliding loop": "small loops,\nslow and fast",
        "constant speed": "strokes,\nslow to fast",
        "acceleration": "accelerations",
    }
    for kind, times in kinds.items():
        above.axvspan(min(times), max(times), color=GRAY, alpha=0.15 if kind == "constant speed" else 0, lw=0)
        above.text(np.mean([min(times), max(times)]), 6e2, words[kind], ha="center", va="bottom", fontsize=9)
    above.set_yscale("symlog", linthresh=1e-2)
    above.set(xlabel="time (s)", ylabel="velocity (mm/s)", yticks=[-100, -1, 0, 1, 100], ylim=(-3e2, 3e2))
    above.set_yticklabels(["\N{MINUS SIGN}100", "\N{MINUS SIGN}1", "0", "1", "100"])
    for test in (each for each in tests if each.control == "force"):
        assert test.force_rate is not None
        below.plot([0, test.duration], [0, test.force_rate * test.duration], color=BLUE, lw=1)
    below.set(xlabel="time (s)", ylabel="force (N)")
    below.set_title("force ramps from standstill", fontsize=9)
    saved(figure, file)


def draw_intervals(file: Path) -> None:
    """A fit of a synthetic log: 95 % interval, model range and truth of each parameter."""
    truth = stribeck.law("stribeck_tanh", parameters=PAPER, k_v=1e4)
    rng = np.random.default_rng(3)
    t = np.arange(0.0, 20.0, 0.002)
    v = 0.05 * np.sin(2 * np.pi * 0.1 * t) * np.sin(2 * np.pi * 0.37 * t)
    force = truth.steady_force(v) + 0.05 * rng.standard_normal(len(t))
    fit = stribeck.fit({"t": t, "v": v, "F": force}, "stribeck_tanh", time="t", velocity="v", force="F")
    shown = [(n, fit[n]) for n in ("F_c", "F_s", "sigma_2", "v_s") if n in fit.parameters]
    figure, plot = plt.subplots(figsize=(WIDTH, 2.2), layout="constrained")
    for row, (name, each) in enumerate(reversed(shown)):
        true = truth.values[name]
        if each.range is not None:
            plot.plot(np.array(each.range) / true, [row, row], color="#a9c4e4", lw=8, solid_capstyle="butt")
        if each.interval is not None:
            plot.plot(np.array(each.interval) / true, [row, row], color=BLUE, lw=4, solid_capstyle="butt")
        plot.plot(each.value / true, row, "o", ms=4, mfc="white", mec=BLUE)
    plot.axvline(1, color=RED, lw=1)
    plot.set(
        yticks=range(len(shown)),
        yticklabels=[n for n, _ in reversed(shown)],
        xlabel="value / true value",
        ylim=(-0.6, 3.6),
    )
    bars = [Line2D([], [], color=color, lw=width) for color, width in (("#a9c4e4", 8), (BLUE, 4), (RED, 1))]
    bars.append(Line2D([], [], marker="o", ls="", ms=4, mfc="white", mec=BLUE))
    names = ["model range", "95 % interval", "true value", "estimate"]
    figure.legend(bars, names, frameon=False, loc="outside upper center", ncols=2, handlelength=1.5)
    saved(figure, file)


# What each law needs beside the parameters of the paper; of makkar, a curve with the same F_c, F_s and sigma_2.
CONSTANTS: dict[str, dict[str, float]] = {
    "lugre": {}, "dahl": {}, "lugre_arctan": {"k_v": 1e6}, "lugre_sobczyk": {"k_v": 1e6}, "lugre_majorant": {"k_v": 1e6},
    "elastoplastic": {"z_ba": 7e-6}, "elastoplastic_sobczyk": {"z_ba": 7e-6, "k_v": 1e6},
    "elastoplastic_majorant": {"z_ba": 7e-6, "k_v": 1e6}, "coulomb_viscous": {"k_v": 1e5}, "stribeck": {"k_v": 1e5},
    "stribeck_tanh": {"k_v": 1e5},
    "makkar": {"g1": 0.5, "g2": 1e5, "g3": 700.0, "g4": 1.0, "g5": 1e5, "g6": 0.4},
}  # fmt: skip
EXPERIMENTS = (  # the example, its title, what is drawn over what, their units and factors
    ("presliding", "presliding", ("y", "\N{MICRO SIGN}m", 1e6), ("u", "N", 1)),
    ("break_away", "break-away", ("t", "s", 1), ("F", "N", 1)),
    ("stick_slip", "stick-slip", ("t", "s", 1), ("y", "m", 1)),
    ("hysteresis", "hysteresis", ("v", "mm/s", 1e3), ("F", "N", 1)),
    ("limit_cycle", "hunting", ("t", "s", 1), ("y", "m", 1)),
)


def draw_law(name: str, file: Path) -> None:
    """What a law does in five experiments: the built-in examples, with this law."""
    names = [name for name, *_ in EXPERIMENTS]
    figure = plt.figure(figsize=(WIDTH, 4.8), layout="constrained")
    plots = figure.subplot_mosaic([names[:2], names[2:4], names[4:] * 2])
    with tempfile.TemporaryDirectory() as folder:
        for example_name, title, horizontal, vertical in EXPERIMENTS:
            plot = plots[example_name]
            changes = {"law.name": name, **{f"law.{n}": x for n, x in CONSTANTS[name].items()}}
            base = example(example_name, Path(folder))
            solution = stribeck.simulate(stribeck.load(base.folder / f"{example_name}.toml", changes))
            keep = slice(None, None, max(1, len(solution.t) // 600))
            axes = [(solution.t if n == "t" else solution[n])[keep] * factor for n, _, factor in (horizontal, vertical)]
            plot.plot(*axes, color=BLUE, lw=1)
            plot.set_title(title, fontsize=9)
            plot.set_xlabel(f"{horizontal[0]} ({horizontal[1]})", fontsize=8)
            plot.set_ylabel(f"{vertical[0]} ({vertical[1]})", fontsize=8)
            plot.tick_params(labelsize=7)
    saved(figure, file)


def draw_own_element(file: Path) -> None:
    """The rig of the guide, released with its hardening spring, and with the linear one."""
    text = (Path(__file__).parent.parent / "howto" / "own-element.md").read_text(encoding="utf-8")
    figure, plot = plt.subplots(figsize=(WIDTH, 2.4), layout="constrained")
    with tempfile.TemporaryDirectory() as folder:
        for name, kind in (("elements.py", "python"), ("rig.toml", "toml")):
            code = text.partition(f"```{kind}\n")[2].partition("```")[0]
            (Path(folder) / name).write_text(code, encoding="utf-8")
        for cubic, words, color in ((0.0, "linear", GRAY), (1e5, "hardening", BLUE)):
            changes = {"links.spring.cubic": cubic, "output.step": 1e-3}
            solution = stribeck.simulate(stribeck.load(f"{folder}/rig.toml", changes))
            plot.plot(solution.t, 1e3 * solution["slider.y"], color=color, label=words)
    plot.set(xlabel="time (s)", ylabel="position (mm)")
    figure.legend(frameon=False, loc="outside upper center", ncols=2)
    saved(figure, file)


def draw_fits_flow(file: Path) -> None:
    """The way from a log to an estimate."""
    boxes = (
        ("log", "read, check,\nresample"), ("signals", "filter,\ndifferentiate"), ("model", "law, terms, forms;\nor simulation"),
        ("search", "least squares,\nmany starts"), ("judge", "profiles, residuals,\ncross-validation"),
        ("estimate", "interval, range,\nstate, experiment"),
    )  # fmt: skip
    figure, plot = plt.subplots(figsize=(WIDTH, 3.6), layout="constrained")
    plot.set(xlim=(0, 7), ylim=(-2.2, 4.4))
    plot.axis("off")
    arrow = {"arrowstyle": "-|>", "color": "black", "lw": 1.2}
    for i, (name, words) in enumerate(boxes):
        x, y = 0.2 + 3.8 * (i % 2), 2.8 - 2.3 * (i // 2)
        plot.add_patch(FancyBboxPatch((x, y), 2.8, 1.4, "round,pad=0.05", fc="white", ec=BLUE, lw=1.5))
        plot.text(x + 1.4, y + 1.1, name, ha="center", va="center", weight="bold")
        plot.text(x + 1.4, y + 0.45, words, ha="center", va="center", fontsize=9)
        if i % 2 == 0:
            plot.annotate("", (x + 3.75, y + 0.7), (x + 2.85, y + 0.7), arrowprops=arrow)
        elif i < len(boxes) - 1:
            plot.annotate("", (1.6, y - 0.85), (x + 1.4, y - 0.05), arrowprops=arrow)
    saved(figure, file)


def _law_drawer(name: str) -> Callable[[Path], None]:
    return lambda file: draw_law(name, file)


PICTURES = {
    **{f"laws/{name}.svg": _law_drawer(name) for name in CONSTANTS},
    "fits_flow.svg": draw_fits_flow,
    "hunts.svg": draw_hunts,
    "windup.svg": draw_windup,
    "two_laws.svg": draw_two_laws,
    "joint.svg": draw_joint,
    "kv.svg": draw_kv,
    "creep.svg": draw_creep,
    "fmu.svg": draw_blocks,
    "map.svg": draw_map,
    "own_law.svg": draw_own_law,
    "own_element.svg": draw_own_element,
    "plan.svg": draw_plan,
    "intervals.svg": draw_intervals,
}


def main(folder: Path) -> None:
    """Draw all of them into a folder."""
    (folder / "laws").mkdir(exist_ok=True)
    for name, draw in PICTURES.items():
        draw(folder / name)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
