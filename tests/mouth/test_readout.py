"""What a page reads off a figure: the same numbers as were drawn."""

import json
import re
from html import unescape

import numpy as np
import pytest

pytest.importorskip("matplotlib")
from stribeck.mouth import plots

pytestmark = pytest.mark.pictures


def drawn(draw, layout=(("a",),)):
    with plots.style():
        built, axes = plots.figure(layout, 2.5)
        draw(axes)
        text = plots.svg(built)
    return text, json.loads(unescape(re.search(r'<svg data-axes="([^"]*)"', text)[1]))


def vertices(text, name):
    path = re.search(rf'<g id="{name}">\s*<path d="([^"]*)"', text)[1]
    return np.array([list(map(float, pair)) for pair in re.findall(r"[ML] ([-\d.]+) ([-\d.]+)", path)])


def values(scale, share):
    """As ``valued`` in page.js."""
    low, high = scale["ends"]
    if scale.get("kind") == "log":
        return low * (high / low) ** share
    if scale.get("kind") == "asinh":
        p, q = np.arcsinh(np.array([low, high]) / scale["width"])
        return scale["width"] * np.sinh(p + (q - p) * share)
    return low + (high - low) * share


@pytest.mark.parametrize("kind", ["linear", "log", "asinh"])
def test_a_curve_read_off_the_drawing_is_the_one_that_was_drawn(kind):
    x, y = np.array([1.0, 2.0, 30.0, 400.0]), np.array([-3.0, 5.0, -7.0, 11.0])

    def draw(axes):
        axes["a"].plot(x, y, label="some $law")
        axes["a"].set_xscale(kind, **({"linear_width": 2.0} if kind == "asinh" else {}))
        axes["a"].set(xlabel="v (mm/s)", ylabel="F (N)")

    text, (panel,) = drawn(draw)
    ((name, label),) = panel["lines"]
    assert (label, panel["x"]["label"], panel["y"]["label"]) == ("some $law", "v (mm/s)", "F (N)")
    left, top, wide, high = panel["box"]
    at = vertices(text, name)
    np.testing.assert_allclose(values(panel["x"], (at[:, 0] - left) / wide), x, rtol=1e-4, atol=0.02)
    np.testing.assert_allclose(values(panel["y"], 1 - (at[:, 1] - top) / high), y, rtol=1e-4, atol=0.002)


def test_what_cannot_be_read_is_left_out():
    def draw(axes):
        axes["a"].plot([1, 2, 3], [1, 2, 3])
        axes["a"].set_yscale("symlog", linthresh=1.0)
        axes["b"].plot([1, 2, 3], [0, 1, 1])
        axes["b"].set_yticks([0, 1, 2], ["hunts", "stands", "law 2"])
        axes["b"].set_xticks([1, 3], ["1", "3"])

    _, reported = drawn(draw, [["a", "b"]])
    assert [panel["y"].get("words") for panel in reported] == [[[0.0, "hunts"], [1.0, "stands"], [2.0, "law 2"]]]
    assert "words" not in reported[0]["x"]  # numbers


def test_a_map_tells_its_cells_and_not_its_key():
    def draw(axes):
        mesh = axes["a"].pcolormesh(
            [1, 2, 4], [0, 1, 2, 3], np.ma.masked_invalid([[1.0, 2.0], [3.0, np.nan], [5.0, 6.0]])
        )
        axes["a"].figure.colorbar(mesh, ax=axes["a"])

    _, (panel,) = drawn(draw)
    assert panel["cells"] == {"x": [1, 2, 4], "y": [0, 1, 2, 3], "values": [1, 2, 3, None, 5, 6]}
