"""What a fit's page says of its model, and which rows it shows."""

import json
import re
from html import unescape

import numpy as np
import pytest

import stribeck
from stribeck.identify import figures
from stribeck.identify.api import read_log
from stribeck.identify.data.read import ColumnNames
from stribeck.identify.formula import model_lines
from stribeck.identify.log import Log
from stribeck.identify.models.terms import TERMS, column
from tests.pages import Page

T = np.arange(2000) * 2e-3
V = np.sin(3 * T) + 0.3 * np.sin(7.1 * T)


def record(**more):
    y = np.concatenate([[0.0], np.cumsum(0.5 * (V[1:] + V[:-1])) * 2e-3])
    draw = np.random.default_rng(1)
    force = 2 * np.gradient(V, 2e-3) + 5 * np.sign(V) + V + 30 * y + 0.05 * draw.standard_normal(len(T))
    return {"t": T, "y": y + 1e-6 * draw.standard_normal(len(T)), "F": force, **more}


def fitted(terms=(), **constants):
    log = read_log(record(), ColumnNames({"time": "t", "position": "y", "force": "F"}))
    return log, stribeck.fit(log, "coulomb_viscous", terms=terms, constants=constants, forms=False)


def test_the_formula_of_a_term_is_the_column_that_is_fitted():
    draw = np.random.default_rng(2)
    y, v, a, load, pressure = draw.uniform(-1, 1, (5, 7))
    t = np.arange(7.0)
    log = Log(t, y, v, a, np.zeros(7), np.zeros(7, np.int32), load, pressure, step=1.0)
    known = {
        "y": y,
        "v": v,
        "a": a,
        "N": load,
        "p": pressure,
        "sin": np.sin,
        "cos": np.cos,
        "sign": np.sign,
    }
    for name, term in TERMS.items():
        if term.column is None:
            continue
        made = eval(re.sub(r"\|(\w)\|", r"abs(\1)", re.sub(r"([\w)]) (?=[\w|])", r"\1 * ", term.factor)), known)
        assert np.allclose(column(name, log), made), name


def test_the_page_has_the_formula_of_what_was_fitted(tmp_path):
    _log, fit = fitted(["stiffness", "F_c_by_direction"], k_v=1e4)
    lines = model_lines(fit)
    assert lines[0].startswith("force = F + mass a + offset + stiffness y")
    assert "F_c grows by F_c_by_direction sign(v)" in lines
    assert any(line.startswith("F = ") and "F_c" in line for line in lines)
    assert model_lines(fitted(stiffness=30.0)[1])[0] == lines[0]
    fit.report(tmp_path / "report.html")
    assert lines[0] in Page(tmp_path / "report.html").text


@pytest.mark.pictures
def test_axes_are_in_units_that_a_person_would_use(tmp_path):
    """They were in metres: a stiffness of 2e6 N/m had its 1e6 beside the axis, a Stribeck velocity 0.00498 m/s."""
    small = record()
    small |= {"y": 1e-3 * small["y"], "F": 1e4 * small["F"]}
    log = read_log(small, ColumnNames({"time": "t", "position": "y", "force": "F"}))
    fit = stribeck.fit(log, "coulomb_viscous", terms=["stiffness"], constants={"k_v": 1e7}, forms=False)
    fit.report(tmp_path / "report.html")
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    axes = [a for found in re.findall(r'data-axes="([^"]*)"', text) for a in json.loads(unescape(found))]
    labels = {a[side]["label"] for a in axes for side in "xy"}
    assert {"position (mm)", "velocity (mm/s)", "force (kN)"} <= labels
    assert not any(re.search(r"\((m|m/s|N/m)\)", label) for label in labels)


def test_a_law_with_bristles_has_its_deflection_explained():
    log, fit = fitted()
    assert not any("bristles" in line for line in model_lines(fit))
    lines = model_lines(stribeck.fit(log.rows(slice(0, 100)), "dahl", starts=1))
    assert any(line.startswith("dz/dt = ") for line in lines)
    assert "z: deflection of the bristles (m)" in lines


def test_files_stand_behind_each_other_on_the_axis_of_time():
    assert figures._in_a_row(np.array([0.5, 1.0, 3.0]))[0].tolist() == [0.5, 1.0, 3.0]
    assert figures._in_a_row(np.array([0.0, 1.0, 3.0, 0.0, 1.0]))[0].tolist() == [0.0, 1.0, 3.0, 3.0, 4.0]
