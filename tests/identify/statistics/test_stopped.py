"""Ctrl-C in a static fit: the best values so far are kept, marked, and none of them is called known."""

import tomllib

import numpy as np
import pytest

import stribeck
from stribeck.cli import _status
from stribeck.identify.methods import static
from stribeck.identify.statistics import choose

NAMES = {"time": "t", "velocity": "v", "force": "F"}


def axis():
    t, rng = np.arange(0, 8, 4e-3), np.random.default_rng(0)
    v = 0.1 * np.sin(2 * np.pi * 0.37 * t) + 0.05 * np.sin(2 * np.pi * 0.91 * t + 1)
    force = 2 * np.gradient(v, t) + 5 * np.tanh(1e4 * v) + 20 * v + 1 + 0.1 * rng.standard_normal(len(t))
    return {"t": t, "v": v, "F": force}


@pytest.fixture
def stopping(monkeypatch):
    """Ctrl-C at the n-th call of a function."""

    def at(module, name, number):
        real, calls = getattr(module, name), []

        def called(*args, **named):
            calls.append(name)
            if len(calls) == number:
                raise KeyboardInterrupt
            return real(*args, **named)

        monkeypatch.setattr(module, name, called)

    return at


@pytest.mark.parametrize(
    ("where", "number", "law"),
    [
        ((choose, "settle"), 2, None), ((choose, "settle"), 5, None), ((static, "static_intervals"), 1, None),
        ((choose, "settle"), 3, "stribeck"), ((static, "static_intervals"), 1, "coulomb_viscous"),
        ((choose, "settle"), 2, "coulomb_viscous"),
    ],
)  # fmt: skip
def test_the_best_values_so_far_are_kept(stopping, where, number, law):
    """All of it was lost."""
    stopping(*where, number)
    fit = stribeck.fit(axis(), law, columns=NAMES)
    assert isinstance(fit, stribeck.Fit)
    assert fit.status == "stopped"
    told = {**fit.estimates, **fit.body}
    assert told["F_c"].best == pytest.approx(5.0, rel=0.05)
    assert told["sigma_2"].best == pytest.approx(20.0, rel=0.2)
    assert not any(e.identifiable or e.value is not None or e.low is not None for e in told.values())
    assert fit.notes[0].startswith("stopped by Ctrl-C")


def test_of_several_laws_the_one_that_was_done_is_kept(stopping):
    stopping(choose, "rows_of", 2)
    fit = stribeck.fit(axis(), ["coulomb_viscous", "stribeck"], columns=NAMES)
    assert (fit.law, fit.status) == ("coulomb_viscous", "stopped")
    assert fit.estimates["F_c"].low < 5.05
    assert fit.estimates["F_c"].high > 4.95
    assert fit.notes[0] == "stopped by Ctrl-C: the best values so far, of coulomb_viscous"


def test_the_command_writes_what_was_found_or_says_that_there_is_nothing(stopping, tmp_path, capsys):
    log, out = tmp_path / "log.csv", tmp_path / "out"
    rows = zip(*(x.tolist() for x in axis().values()), strict=True)
    log.write_text("t,v,F\n" + "".join(f"{t},{v},{f}\n" for t, v, f in rows))
    words = ["fit", str(log), "--time", "t", "--velocity", "v", "--force", "F", "--out", str(out)]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(choose, "settle", lambda *_: (_ for _ in ()).throw(KeyboardInterrupt))
        assert _status(words) == 130
    assert capsys.readouterr().err == "stribeck: nothing was found yet\nstribeck: interrupted\n"
    assert not out.exists()
    stopping(choose, "settle", 4)
    assert _status(words) == 130
    found = tomllib.loads((out / "parameters.toml").read_text())
    assert found["status"] == "stopped"
    assert found["parameters"]["F_c"]["value"] == pytest.approx(5.0, rel=0.05)
    assert found["parameters"]["F_c"]["determined"] is False
    assert found["unknown"]["F_c"]["why"] == "the fit was stopped before its end"
    assert "stopped by Ctrl-C" in capsys.readouterr().out
    assert {path.name for path in out.iterdir()} == {"parameters.toml", "report.html", "fit.json"}
    assert _status(["predict", str(log), "--fit", str(out)]) == 0
