"""Draws four of the pictures of README into this folder, guides.py the fifth: python docs/pictures/make.py [FOLDER]."""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.patches import Rectangle

import stribeck

plt.rcParams.update(
    {"svg.hashsalt": "stribeck", "svg.fonttype": "none", "axes.spines.top": False, "axes.spines.right": False}
)
PAPER = "canudas1995"  # the parameters of the paper's Table 1
WIDTH = 5.2  # inches: a phone, 358 px wide, then shows text of 10 points as 9.5 px
# A ball-screw stage: kg, N, m.
STAGE = {"sigma_0": 8e5, "sigma_1": 2500.0, "sigma_2": 40.0, "F_c": 14.0, "F_s": 20.0, "v_s": 5e-3}


def stick_slip() -> stribeck.Solution:
    """A slider on a slowly pulled spring."""
    return stribeck.simulate(
        stribeck.Scenario(
            law={"name": "lugre_majorant", "k_v": 1e6, "parameters": PAPER},
            plant={"mass": 1.0},
            drive={"kind": "spring", "stiffness": 2.0, "signal": {"kind": "ramp", "rate": 0.1}},
            solve={"t_end": 40.0},
            output={"step": 0.1},
        )
    )


def draw_stick_slip(file: Path) -> None:
    """A film: the slider above, its friction below."""
    solution = stick_slip()
    t, y, pull = solution.t, solution["y"], 0.1 * solution.t
    figure, (scene, force) = plt.subplots(2, figsize=(6.4, 3.2), height_ratios=(1, 1.6), layout="constrained")
    scene.set(xlim=(-0.3, 5.2), ylim=(0, 1), yticks=[], xlabel="position (m)")
    scene.spines["left"].set_visible(False)
    slider = scene.add_patch(Rectangle((-0.2, 0.05), 0.4, 0.5, color="#3572b0"))
    (spring,) = scene.plot([], [], color="#666666", lw=1)
    (hand,) = scene.plot([], [], "o", color="#c4412f", ms=5)
    force.plot(t, solution["F"], color="#dddddd", lw=1)
    (trace,) = force.plot([], [], color="#3572b0")
    force.set(xlim=(0, 40), ylim=(0, 1.7), xlabel="time (s)", ylabel="friction (N)")
    coils = np.linspace(0, 1, 41)

    def frame(k: int) -> None:
        slider.set_x(y[k] - 0.2)
        spring.set_data(
            y[k] + 0.2 + coils * (pull[k] + 0.8 - y[k] - 0.2), 0.3 + 0.12 * np.sin(16 * np.pi * coils) * (coils % 1 > 0)
        )
        hand.set_data([pull[k] + 0.8], [0.3])
        trace.set_data(t[:k], solution["F"][:k])

    FuncAnimation(figure, frame, frames=range(0, len(t), 3)).save(file, PillowWriter(fps=15), dpi=80)
    plt.close(figure)


def axis(compensation: dict[str, object] | None) -> stribeck.Solution:
    """A stage that follows a slow sine under a sampled controller, with friction compensated or not."""
    law = {"name": "lugre", "parameters": STAGE}
    controller = {
        "kind": "cascade", "on": "slide", "measures": "slide", "K_p": 60.0, "K_v": 1200.0, "T_i": 0.03, "limit": 400.0,
        "signal": {"kind": "sine", "amplitude": 5e-3, "frequency": 0.5},
        "sampling": {"period": 5e-4, "delay": 2.5e-4, "resolution": 1e-7}, "feedforward": {"inertia": 8.0},
    }  # fmt: skip
    if compensation:
        controller["compensation"] = compensation
    return stribeck.simulate(
        stribeck.Scenario(
            schema=2,
            bodies={"slide": {"mass": 8.0}},
            contacts={"guide": {"from": "slide", "law": law}},
            controllers={"axis": controller},
            solve={"t_end": 6.0},
            output={"step": 1e-3},
        )
    )


def draw_hunting(file: Path) -> None:
    """The tracking error after reversals, with and without compensation."""
    figure, plot = plt.subplots(figsize=(WIDTH, 2.4), layout="constrained")
    for compensation, words, color in (
        (None, "no compensation", "#c4412f"),
        ({"contact": "guide", "speed": "reference"}, "with compensation", "#3572b0"),
    ):
        solution = axis(compensation)
        shown = solution.t > 2
        error = 5e-3 * np.sin(np.pi * solution.t) - solution["slide.y"]
        plot.plot(solution.t[shown], 1e6 * error[shown], color=color, label=words)
    plot.set(xlabel="time (s)", ylabel="tracking error (\N{MICRO SIGN}m)", xlim=(2, 6))
    plot.legend(frameon=False, loc="lower center", bbox_to_anchor=(0.5, 1), ncols=2)
    figure.savefig(file, metadata={"Date": None})
    plt.close(figure)


def draw_fit(file: Path) -> None:
    """A synthetic log of which the truth is known, and the curve that is fitted to it."""
    truth = stribeck.law("stribeck_tanh", parameters=PAPER, k_v=1e4)
    rng = np.random.default_rng(3)
    t = np.arange(0.0, 20.0, 0.002)
    v = 0.05 * np.sin(2 * np.pi * 0.1 * t) * np.sin(2 * np.pi * 0.37 * t)
    force = truth.steady_force(v) + 0.05 * rng.standard_normal(len(t))
    fit = stribeck.fit({"t": t, "v": v, "F": force}, "stribeck_tanh", time="t", velocity="v", force="F")
    figure, plot = plt.subplots(figsize=(WIDTH, 2.4), layout="constrained")
    plot.plot(1e3 * v[::5], force[::5], ".", ms=2, color="#999999", label="log", rasterized=True)
    speeds = np.linspace(v.min(), v.max(), 2001)
    plot.plot(1e3 * speeds, fit.law(guessing=True).steady_force(speeds), color="#3572b0", label="fit")
    plot.set(xlabel="velocity (mm/s)", ylabel="friction (N)")
    plot.legend(frameon=False, loc="lower right", markerscale=4)
    figure.savefig(file, metadata={"Date": None})
    plt.close(figure)


def draw_passive(file: Path) -> None:
    """The counterexample of `check`: a motion in which friction returns more energy than it took."""
    law = stribeck.law("lugre_sobczyk", parameters=PAPER, k_v=1e7)
    solution = stribeck.simulate(stribeck.check(law)["passive"].scenario)
    figure, plot = plt.subplots(figsize=(WIDTH, 2.4), layout="constrained")
    t, energy = solution.t, 1e6 * solution["E_in"]
    least, gain = int(energy.argmin()), -energy[-1]
    plot.axhline(0, color="#bbbbbb", lw=1)
    plot.plot(t, energy, color="#c4412f")
    arrow = {"arrowstyle": "<->", "color": "black", "shrinkA": 0, "shrinkB": 0}
    plot.annotate("", (t[-1], 0), (t[-1], energy[-1]), arrowprops=arrow)
    unit = "\N{MICRO SIGN}J"
    plot.text(0.98 * t[-1], -gain / 2, f"energy gained\nin a cycle: {gain:.0f} {unit}", ha="right", va="center")
    plot.text(
        0.02 * t[-1], -gain / 2, f"fast, unwinding the bristles:\n{-energy[least]:.0f} {unit} come out", va="center"
    )
    plot.text(
        0.25 * t[-1],
        1.12 * energy[least],
        f"slow, winding them up again: {energy[-1] - energy[least]:.0f} {unit} go in",
        va="top",
    )
    plot.set(xlabel="time (s)", ylabel=f"energy put in ({unit})", ylim=(1.45 * energy[least], 20))
    figure.savefig(file, metadata={"Date": None})
    plt.close(figure)


PICTURES = {
    "stick_slip.gif": draw_stick_slip,
    "hunting.svg": draw_hunting,
    "fit.svg": draw_fit,
    "passive.svg": draw_passive,
}


def main(folder: Path) -> None:
    """Draw all of them into a folder."""
    for name, draw in PICTURES.items():
        draw(folder / name)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
