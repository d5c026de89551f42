"""What plots show: units that keep numbers short, words, what stands in an SVG file; tests/kept has the plots of runs."""

import os
import re
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from stribeck import Scenario, examples, simulate
from stribeck.loops import figures as design_figures
from stribeck.mouth import plots
from stribeck.mouth.quantities import Quantity, scale
from stribeck.simulation import drawing

pytestmark = pytest.mark.pictures

ROTARY = {
    "law": {"name": "lugre", "parameters": "olsson1998"},
    "plant": {"mass": 0.0023},
    "drive": {"kind": "force", "signal": {"kind": "sine", "amplitude": 0.5, "frequency": 2.0}},
    "solve": {"t_end": 1.0},
    "output": {"step": 1e-3},
}


def svg(figure):
    """A figure as SVG alone: its picture and its document take twice as long."""
    with plots.style():
        return plots.svg(figure.draw())


def test_what_hardly_changes_is_shown_as_a_change():
    y = 0.4 + 1e-7 * np.linspace(0, 1, 5)
    shown = scale([Quantity("y", "m", "position", y)])
    assert shown.label == "y \N{MINUS SIGN} 0.4 m (nm)"
    np.testing.assert_allclose(shown.of(y), np.linspace(0, 100, 5), atol=1e-5)


def test_a_figure_is_the_same_text_each_time():
    solution = simulate(Scenario.load(examples.path("stick_slip"), {"solve.t_end": 1.0}))
    figure = plots.drawn(drawing.overview({"a": solution}))
    assert not re.search(r">[^<]*\de-?\d[^<]*</text>", figure.svg)  # no 1e-3 above an axis
    with plots.style():
        built = drawing.overview({"a": solution}).draw()
        assert plots.svg(built) == figure.svg


def test_rotary_can_be_said_no_to_and_is_kept_by_changes():
    scenario = Scenario(**ROTARY)
    assert scenario.rotary
    assert scenario.with_changes({"law.parameters.F_s": 0.4}).rotary
    assert not Scenario(**ROTARY, rotary=False).rotary
    linear = {**ROTARY, "law": {"name": "lugre", "parameters": "canudas1995"}}
    assert not Scenario(**linear).rotary
    with pytest.raises(ValueError, match=r"^rotary: 1: must be true or false, not a number$"):
        Scenario(**ROTARY, rotary=1)


@pytest.mark.parametrize(("verdicts", "shown"), [(("quiet", "failed"), True), (("quiet", "hunting"), False)])
def test_runs_that_failed_stand_in_the_figure_of_verdicts(verdicts, shown):
    results = [SimpleNamespace(verdict=verdict) for verdict in verdicts]
    turned = SimpleNamespace(path="bodies.a.mass", low=0.0, high=1.0)
    line = SimpleNamespace(judgments=results, values=[0.2, 0.8], boundaries=[], mixed=[], turned=turned)
    assert (">failed<" in svg(design_figures.line(line, 0))) is shown


def test_matplotlib_says_nothing_of_its_own_folders(tmp_path):
    """A line of 350 characters stood on the screen of a user without a home."""
    words = "from stribeck.mouth import plots\nwith plots.style():\n    plots.figure([['a']], 2.0)\n"
    reported = os.environ | {"MPLCONFIGDIR": str(tmp_path / "file" / "below")}
    (tmp_path / "file").touch()
    done = subprocess.run([sys.executable, "-c", words], env=reported, capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == ("", "")


def test_a_label_longer_than_its_panel_loses_its_middle():
    """Matplotlib gives up its layout, with a warning of its own, if a label leaves no room for the panel."""
    name = "spindle" * 20
    with plots.style():
        figure, axes = plots.figure([["a", "b"]], 2.2)
        for axis in axes.values():
            axis.set(title=f"{name}: velocity", xlabel="t (s)", ylabel=f"{name}.v (mm/s)")
        text = plots.svg(figure)
    assert "…" in text
    assert all(end in text for end in ("spindlespin", "spindle: velocity<", ".v (mm/s)<", ">t (s)<"))
    assert name not in text


def test_powers_of_ten_stand_at_an_axis_and_a_user_s_dollars_stay():
    with plots.style():
        figure, axes = plots.figure([["a"]], 2.6)
        axes["a"].loglog([1e-3, 1e3], [1e-6, 1e6], label="$10^2$ of $x$")
        axes["a"].set_ylabel("$10^3$ (N)")
        plots.legend(figure, axes["a"])
        text = plots.svg(figure)
    drawn = re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)
    assert "mathdefault" not in drawn
    assert all(words in drawn for words in (">$10^2$ of $x$<", ">$10^3$ (N)<"))


@pytest.mark.thorough
def test_a_large_machine_has_a_figure_of_bounded_size():
    """One of 200 bodies was drawn for ten minutes, and Ctrl-C lost its numbers."""
    bodies = {f"b{i}": {"mass": 1.0} for i in range(30)}
    data = {"schema": 2, "bodies": bodies, "solve": {"t_end": 1.0}, "output": {"step": 0.5}}
    solution = simulate(Scenario(data, name="chain"))
    text = svg(drawing.overview({"chain": solution}))
    assert "chain: the first 40 of 60 panels" in text
    assert text.count(">t (s)<") == 40
    assert "b19.v" in text
    assert "b20.y" not in text
