"""Commands that are stopped: what was there stays as it was, nothing is left behind, nobody goes on working."""

import json
import os
import signal
import subprocess
import sys
import threading

import pytest
import tomli_w

import stribeck
from stribeck import examples
from stribeck.cli.stops import listen
from stribeck.files import together, write_text
from stribeck.identify import written
from stribeck.identify.actuator import MachineFit
from stribeck.identify.result import LogFit
from stribeck.mouth import page as pages
from stribeck.simulation.native import Solving
from tests.identify.actuator.recorded import body, logs, record
from tests.kept import logs as kept_logs

COLUMNS = ("--time", "t", "--velocity", "v", "--force", "F")
needs_signals = pytest.mark.skipif(os.name != "posix", reason="needs POSIX signals")


def _stopped(*_, **__):
    raise KeyboardInterrupt


def content(folder):
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


@pytest.mark.parametrize("command", [("run",), ("run", "--law", "lugre", "--law", "dahl")], ids=["run", "compare"])
def test_an_older_result_stays_whole(command, stribeck, scenario, tmp_path, monkeypatch):
    out = tmp_path / "out"
    words = [command[0], scenario, *command[1:], "--out", out]
    assert stribeck(*words).status == 0
    before = content(out)
    monkeypatch.setattr(pages, "write", _stopped)
    assert stribeck(*words, "--set", "drive.stiffness=3.0").status == 130
    assert content(out) == before


def test_a_new_result_never_stands_beside_an_old_summary(stribeck, scenario, tmp_path, monkeypatch):
    """Wherever the process dies, a summary that says 'done' is that of the files beside it."""
    out = tmp_path / "out"
    assert stribeck("run", scenario, "--out", out).status == 0
    old = content(out)
    moves, real = [], type(out).replace

    def replace(self, target):
        moves.append(target)
        real(self, target)
        summary = out / "summary.json"
        if target.parent == out and summary.exists():
            rows = len((out / "trajectory.csv").read_text().splitlines()) - 1
            assert json.loads(summary.read_text())["final"]["t"] == 5.0
            assert rows == 501
            assert content(out).keys() - {str(p.relative_to(out)) for p in out.glob(".*/*")} == old.keys()

    monkeypatch.setattr(type(out), "replace", replace)
    assert stribeck("run", scenario, "--out", out, "--set", "solve.t_end=5.0").status == 0
    moved = [p.name for p in moves if p.parent == out]
    assert {"trajectory.csv", "trajectory.parquet"} < set(moved)
    assert moved[-1] == "summary.json"
    assert sorted(moved) == sorted(old)


def test_a_result_that_fails_half_way(tmp_path):
    (tmp_path / "summary.json").write_text("old")
    with pytest.raises(ZeroDivisionError), together(tmp_path) as place:
        write_text(place / "a", f"new {1 / 0}")
    assert content(tmp_path) == {"summary.json": b"old"}
    with pytest.raises(ZeroDivisionError), together(tmp_path / "x" / "y"):
        1 / 0  # noqa: B018
    assert not (tmp_path / "x" / "y").exists()


def swap(folder, other):
    folder.rename(folder.with_name("moved"))
    folder.symlink_to(other)


@pytest.mark.skipif(os.name != "posix", reason="needs links")
def test_a_folder_that_was_swapped_for_a_link_meanwhile(tmp_path):
    """The files that another folder's summary lists were deleted there."""
    out, other = tmp_path / "out", tmp_path / "other"
    for folder in (out, other):
        with together(folder) as place:
            write_text(place / "a", str(folder))
            write_text(place / "summary.json", json.dumps({"files": [str(folder / n) for n in ("a", "summary.json")]}))
    before = content(other)
    with pytest.raises(OSError, match="was replaced by another folder meanwhile"), together(out):
        swap(out, other)
    assert content(other) == before


def test_what_an_older_result_alone_had_is_taken_away(tmp_path):
    """A figure of the older result stood beside the new summary; what the summary does not list is not ours."""
    out = tmp_path / "out"
    for names in (("old.svg", "figures/old.svg", "both"), ("both", "new.svg")):
        with together(out) as place:
            for name in names:
                (place / name).parent.mkdir(exist_ok=True)
                write_text(place / name, name)
            files = [str(out / name) for name in (*names, "../beside", "summary.json")]
            write_text(place / "summary.json", json.dumps({"files": files}))
        for path in (out / "mine.svg", tmp_path / "beside"):
            path.write_text("the user's")
    assert content(out).keys() == {"both", "new.svg", "summary.json", "mine.svg"}
    assert (tmp_path / "beside").exists()


@pytest.mark.parametrize("summary", ["", "[]", '{"files": 3}', '{"files": [3]}', '{"files": ["/"]}', '{"files": []}'])
def test_an_older_summary_that_is_none(tmp_path, summary):
    (tmp_path / "summary.json").write_text(summary)
    (tmp_path / "mine").write_text("")
    with together(tmp_path) as place:
        write_text(place / "a", "")
    assert content(tmp_path).keys() == {"a", "mine"}


def test_a_check_over_that_of_another_law(stribeck, tmp_path):
    """The counterexamples of the older law stayed, as if they were the new one's."""
    out = tmp_path / "out"
    assert stribeck("check", "lugre", "--out", out).status == 0
    old = {name for name in content(out) if "passive" in name}
    assert {"passive.toml", "not_passive.svg"} <= old
    (out / "rig.toml").write_text("# mine\n")
    assert stribeck("check", "lugre_majorant", "--set", "k_v=1e6", "--set", "v_d=0.01", "--out", out).status == 0
    assert not {name for name in content(out) if "passive" in name}
    assert (out / "rig.toml").exists()


def of_machine(status):
    return MachineFit(status, "", {}, [], [], [], {}, {"schema": 2})


def test_a_fit_over_one_of_another_kind(tmp_path, monkeypatch):
    """machine.toml of an older fit stood beside the numbers of another one."""
    written.write_fit(LogFit("coulomb_viscous", "static", {}, {"k_v": 1e9}, ("k_v",), 0.1, ""), tmp_path)
    assert content(tmp_path).keys() == {"parameters.toml", "fit.json", "report.html"}
    written.write_fit(of_machine("done"), tmp_path)
    assert content(tmp_path).keys() == {"parameters.toml", "fit.json", "report.html", "machine.toml"}
    whole = content(tmp_path)
    with monkeypatch.context() as patch:
        patch.setattr(written, "write_text", lambda path, text: path.write_text(text) / (path.name != "fit.json"))
        with pytest.raises(ZeroDivisionError):
            written.write_fit(of_machine("missed"), tmp_path)
    assert content(tmp_path) == whole
    written.write_fit(of_machine("missed"), tmp_path)
    assert content(tmp_path).keys() == {"parameters.toml", "fit.json", "report.html"}
    (tmp_path / "machine.toml").write_text("# the user's own\n")
    written.write_fit(of_machine("missed"), tmp_path)
    assert (tmp_path / "machine.toml").exists()


def test_a_program_over_one_with_a_synthetic_log(stribeck, tmp_path):
    words = ("fit", "--plan", "stroke=0.05,speed=0.1,force=50", "--out", tmp_path)
    assert stribeck(*words, "--simulate").status == 0
    assert {"synthetic_log.csv", "synthetic_truth.toml"} < content(tmp_path).keys()
    assert stribeck(*words).status == 0
    assert content(tmp_path).keys() == {"program.csv", "motion.csv"}


@pytest.mark.parametrize(
    "words",
    [
        "design machine.toml --out .", "fit machine.toml --logs logs.toml --out .",
        "explore machine.toml --out machine.toml", "export machine.toml --target fmu --out ./machine.toml",
        "check machine.toml --certificate machine.toml", "import bam machine.toml --out machine.toml",
    ],
)  # fmt: skip
def test_no_input_is_replaced(stribeck, tmp_path, monkeypatch, words):
    """``design machine.toml --out .`` wrote its own machine.toml over the user's."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "machine.toml").write_bytes(examples.path("machine").read_bytes())
    (tmp_path / "logs.toml").write_text("")
    before = content(tmp_path)
    result = stribeck(*words.split())
    assert (result.status, result.out) == (2, "")
    assert "machine.toml" in result.err
    assert result.err.rstrip().endswith(("must be another folder", "must be another file"))
    assert content(tmp_path) == before


SLOW = """
import signal, sys, time
signal.signal(signal.SIGHUP, signal.SIG_DFL)
from stribeck.mouth import page as pages
from tests.identify.actuator.recorded import body, logs, record
def slow(*args):
    print("ready", flush=True)
    time.sleep(600)
pages.write = slow
from stribeck.cli import main
main(sys.argv[1:])
"""


@pytest.mark.share(3)
@needs_signals
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, getattr(signal, "SIGHUP", None)])
def test_signals_leave_nothing(number, scenario, tmp_path):
    out = tmp_path / "out"
    command = [sys.executable, "-c", SLOW, "run", str(scenario), "--out", str(out)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "ready\n"
    process.send_signal(number)
    _, error = process.communicate(timeout=60)
    assert process.returncode == 128 + number
    assert error in ("stribeck: interrupted\n", "stribeck: terminated\n", "stribeck: ended\n")
    assert content(out) == {}


def test_a_signal_that_is_ignored_as_under_nohup_stays_so(monkeypatch):
    monkeypatch.setattr(signal, "getsignal", lambda number: signal.SIG_IGN)
    assert listen() == []


@pytest.mark.parametrize(("backend", "number"), [("wasm", "contacts.rail.law.k_v"), ("auto", "solve.rtol")])
def test_lanes_one_by_one_end_soon(backend, number, monkeypatch):
    """Single runs in threads look whether anybody still wants them."""
    monkeypatch.setenv("STRIBECK_BACKEND", backend)
    started, integrate, stopped = [], Solving.integrate, threading.Event()

    def counted(self, progress, most):
        started.append(number)
        assert len(started) < 3 or stopped.wait(60)
        return integrate(self, progress, most)

    def stop(share):
        stopped.set()
        raise KeyboardInterrupt

    law = {"name": "lugre_majorant", "k_v": 1e6, "parameters": "canudas1995"}
    machine = stribeck.Scenario(
        schema=2, bodies={"slider": {"mass": 1.0}}, contacts={"rail": {"from": "slider", "law": law}},
        solve={"t_end": 1.0, "rtol": 1e-6}, output={"step": 0.1},
    )  # fmt: skip
    monkeypatch.setattr(Solving, "integrate", counted)
    with pytest.raises(KeyboardInterrupt):
        stribeck.simulate(machine, {number: [1e-6] * 6}, threads=1, progress=stop)
    assert 0 < len(started) < 6


def _ends(*_, **__):
    raise OSError(28, "No space left on device")


def test_a_check_that_ends_while_it_writes_leaves_the_older_result_whole(stribeck, tmp_path, monkeypatch):
    """Killed over an older result it left the counterexamples of one law beside the page of another (2 of 8)."""
    asked = ("--parameters", "canudas1995", "--out", tmp_path / "out")
    assert stribeck("check", "lugre", *asked).status == 0
    before = content(tmp_path / "out")
    assert {"report.html", "passive.toml"} <= set(before)
    with monkeypatch.context() as patch:
        patch.setattr("stribeck.properties.written._scenarios", _ends)
        assert stribeck("check", "lugre_sobczyk", "--set", "k_v=1e7", *asked).status != 0
    assert content(tmp_path / "out") == before
    monkeypatch.setattr("stribeck.mouth.page.write", _ends)  # without room for the page the results are there
    result = stribeck("check", "lugre_sobczyk", "--set", "k_v=1e7", *asked)
    assert (result.status, "without the page: No space left" in result.err) == (0, True)
    assert "report.html" not in content(tmp_path / "out")


def test_a_result_waits_for_the_process_that_moves_its_own(tmp_path):
    """One that was stopped half-way would go on over what another has written meanwhile."""
    fcntl = pytest.importorskip("fcntl")
    write_text(tmp_path / "summary.json", "older")

    def write():
        with together(tmp_path) as place:
            write_text(place / "summary.json", "newer")

    other = os.open(tmp_path, os.O_RDONLY)
    fcntl.flock(other, fcntl.LOCK_EX)
    thread = threading.Thread(target=write)
    thread.start()
    thread.join(0.5)
    assert thread.is_alive()
    assert (tmp_path / "summary.json").read_text() == "older"
    os.close(other)
    thread.join(20)
    assert (tmp_path / "summary.json").read_text() == "newer"


@needs_signals
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_after_the_end(number):
    """While Python took its leave it printed a traceback."""
    code = (
        f"import atexit, os; atexit.register(lambda: os.kill(os.getpid(), {int(number)}))\n"
        "from stribeck.cli import main; main(['--version'])"
    )
    done = subprocess.run([sys.executable, "-c", code], check=False, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


def test_what_was_fitted_is_said_when_the_drawing_is_stopped(stribeck, tmp_path, monkeypatch):
    """The fit was lost with the page."""
    monkeypatch.setattr(pages, "write", _stopped)
    kept_logs.write("log.csv", tmp_path / "log.csv")
    words = ("--law", "coulomb_viscous", "--no-forms", "--out", tmp_path / "out")
    reported = stribeck("fit", tmp_path / "log.csv", *COLUMNS, *words)
    assert reported.status == 130
    assert "F_c" in reported.out
    assert "interrupted" in reported.err
    assert content(tmp_path / "out").keys() == {"parameters.toml", "fit.json"}  # written before the page is drawn
    record(tmp_path / "run.csv", body(amplitude=5.0))
    path = logs(tmp_path, ["run.csv"], {"bodies.a.mass": {"low": 0.2, "high": 5.0}})
    (tmp_path / "axis.toml").write_text(tomli_w.dumps(body()))
    reported = stribeck("fit", tmp_path / "axis.toml", "--logs", path, "--starts", "1", "--out", tmp_path / "machine")
    assert reported.status == 130
    assert "bodies.a.mass" in reported.out
    assert content(tmp_path / "machine").keys() == {"parameters.toml", "fit.json", "machine.toml"}
