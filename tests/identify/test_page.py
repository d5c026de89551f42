"""What a fit's page says of its model, and which rows it shows."""

import re

import numpy as np

from stribeck.identify import figures, said
from stribeck.identify.core.states import Estimate, EstimateState
from stribeck.identify.log import Log
from stribeck.identify.models.terms import TERMS, column


def test_the_formula_of_a_term_is_the_column_that_is_fitted():
    draw = np.random.default_rng(2)
    y, v, a, load, pressure = draw.uniform(-1, 1, (5, 7))
    t = np.arange(7.0)
    log = Log(t, y, v, a, np.zeros(7), np.zeros(7, np.int32), load, pressure, step=1.0)
    known = {"y": y, "v": v, "a": a, "N": load, "p": pressure, "sin": np.sin, "cos": np.cos, "sign": np.sign}
    for name, term in TERMS.items():
        if term.column is None:
            continue
        built = eval(re.sub(r"\|(\w)\|", r"abs(\1)", re.sub(r"([\w)]) (?=[\w|])", r"\1 * ", term.factor)), known)
        assert np.allclose(column(name, log), built), name


def test_files_stand_behind_each_other_on_the_axis_of_time():
    assert figures._in_a_row(np.array([0.5, 1.0, 3.0]))[0].tolist() == [0.5, 1.0, 3.0]
    assert figures._in_a_row(np.array([0.0, 1.0, 3.0, 0.0, 1.0]))[0].tolist() == [0.0, 1.0, 3.0, 3.0, 4.0]


def test_reasons_that_no_experiment_mends_are_printed_first():
    """A terminal prints five notes, and the reason of a level that was withheld was the sixth."""
    open_ = Estimate(1.0, (0.1, 9.0), None, EstimateState.NOT_IDENTIFIABLE, why="wide", experiment="reversals")
    level = Estimate(1.0, (0.9, 1.1), None, EstimateState.NOT_IDENTIFIABLE, why="the search crept")
    lines = said._open({"sigma_0": open_, "F_c": open_, "level half": level})
    assert [line.partition(":")[0] for line in lines] == ["level half", "sigma_0", "F_c"]
