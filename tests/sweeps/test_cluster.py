"""Sweeps on a cluster of real processes: the same bytes as here, whatever dies on the way."""

import json
import os
import signal
import subprocess
import sys
import time
import warnings
from contextlib import contextmanager
from types import SimpleNamespace

import numpy as np
import pytest

import stribeck
from stribeck import Scenario
from stribeck.errors import StribeckError, StribeckNote
from stribeck.simulation import backend
from stribeck.sweeps import cluster as module
from stribeck.sweeps import job, parts

distributed = pytest.importorskip("distributed")
pytestmark = pytest.mark.filterwarnings("ignore::stribeck.errors.StribeckNote")

by_c = pytest.mark.skipif(backend.chosen() == "wasm", reason="leaves out who has no C compiler")

LANES = {"law.k_v": np.geomspace(1e6, 1e8, 24), "plant.mass": np.linspace(1.0, 2.0, 24)}


def scenario(folder=None, law=None):
    return Scenario(
        law=law or {"name": "lugre_majorant", "k_v": 1e6, "parameters": "canudas1995"},
        plant={"mass": 1.0},
        drive={"kind": "spring", "stiffness": 2.0, "signal": {"kind": "ramp", "rate": 0.1}},
        solve={"t_end": 2.0},
        output={"step": 0.01},
        folder=folder,
    )


def bytes_of(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


class Cluster:
    """A Dask scheduler and workers, each a process of its own."""

    def __init__(self, folder):
        self.folder, self.processes, self.workers = folder, [], []
        file = folder / "scheduler.json"
        self.scheduler = self._start("scheduler", "--port", "0", "--no-dashboard", "--scheduler-file", file)
        self.address = wait_for(lambda: json.loads(file.read_text())["address"] if file.exists() else None)

    def _start(self, *words, **environment):
        command = [sys.executable, "-m", "distributed.cli.dask_" + words[0], *map(str, words[1:])]
        environment = {**os.environ, "DASK_DISTRIBUTED__SCHEDULER__WORKER_TTL": "3s", **environment}
        with (self.folder / f"{len(self.processes)}.log").open("wb") as log:
            found = subprocess.Popen(
                command, stdout=log, stderr=log, cwd=self.folder, env=environment, start_new_session=True
            )
        self.processes.append(found)
        return found

    def worker(self, **environment):
        words = ("--nthreads", 1, "--no-nanny", "--no-dashboard", "--death-timeout", 60)
        self.workers.append(self._start("worker", self.address, *words, **environment))
        return self.workers[-1]

    def close(self):
        for process in self.processes:
            with_group(process, signal.SIGKILL)


def with_group(process, number):
    if process.poll() is None:
        os.killpg(process.pid, number)
    process.wait()


def wait_for(look, seconds=60):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        try:
            if (found := look()) is not None:
                return found
        except (ValueError, OSError):
            pass
        time.sleep(0.05)
    raise AssertionError("nothing came")


@contextmanager
def cluster_in(folder, workers=0):
    folder.mkdir()
    made = Cluster(folder)
    try:
        for _ in range(workers):
            made.worker()
        yield made
    finally:
        made.close()


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """Two workers, and one that has no compiler."""
    with cluster_in(tmp_path_factory.mktemp("dask") / "cluster") as made:
        made.worker(STRIBECK_CC="none")
        made.worker()
        made.worker()
        with distributed.Client(made.address) as client:
            client.wait_for_workers(3, timeout=60)
        yield made


@pytest.fixture(scope="module")
def here(tmp_path_factory):
    """The files of the sweep as this machine makes them."""
    folder = tmp_path_factory.mktemp("here")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(job, "_PART_BYTES", 2 * 8.0 * 7 * 201)
        stribeck.sweep(scenario(), LANES, folder)
    return bytes_of(folder)


@by_c
def test_workers_make_the_same_bytes_though_one_is_killed_and_one_has_no_compiler(cluster, here, tmp_path):
    killed = []

    def kill(share, lanes):
        if not killed and lanes >= 6:
            killed.append(cluster.workers.pop(1))
            with_group(killed[0], signal.SIGKILL)
            cluster.worker()

    with pytest.warns(StribeckNote, match="left out: tcp://.* solves by WebAssembly, not by a C compiler"):
        found = stribeck.sweep(scenario(), LANES, tmp_path, progress=kill, cluster=cluster.address)
    assert killed
    assert found.failed == 0
    assert bytes_of(tmp_path) == here
    assert len(here) == 13


def test_a_client_of_ones_own(cluster, here, tmp_path):
    with distributed.Client(cluster.address) as client:
        stribeck.sweep(scenario(), LANES, tmp_path, cluster=client)
        assert client.status == "running"
    assert bytes_of(tmp_path) == here


@pytest.mark.thorough
def test_a_law_of_ones_own_goes_along_as_text(cluster, tmp_path):
    (tmp_path / "mine.py").write_text(
        "from stribeck.laws.lugre import LuGre\nclass Mine(LuGre):\n    name = 'mine'\n    description = 'LuGre, another name'\n"
    )
    law = {"name": "mine.py:Mine", "parameters": "canudas1995"}
    for name, given in (("here", {}), ("there", {"cluster": cluster.address})):
        mass = {"plant.mass": [1.0, 1.5, 2.0]}
        stribeck.sweep(scenario(tmp_path, law), mass, tmp_path / name, summary=True, **given)
    assert bytes_of(tmp_path / "there") == bytes_of(tmp_path / "here")


@pytest.mark.thorough
def test_a_scheduler_that_is_killed_is_one_line_and_the_sweep_goes_on(here, tmp_path, capfd):
    with cluster_in(tmp_path / "cluster", workers=1) as made:

        def kill(share, lanes):
            if lanes >= 4 and made.scheduler.poll() is None:
                with_group(made.scheduler, signal.SIGKILL)

        gone = r"cluster: the scheduler went away after \d+ of 12 parts; the same command goes on from there"
        with pytest.raises(StribeckError, match=gone):
            stribeck.sweep(scenario(), LANES, tmp_path / "there", progress=kill, cluster=made.address)
    assert capfd.readouterr().err == ""  # no traceback of Dask's
    done = json.loads((tmp_path / "there" / "_manifest.json").read_text())["sha256"]
    assert 2 <= len(done) < 12
    found = stribeck.sweep(scenario(), LANES, tmp_path / "there")
    assert found.found == len(done)
    assert bytes_of(tmp_path / "there") == here


@pytest.mark.thorough
@by_c
def test_no_worker_that_can(tmp_path):
    with cluster_in(tmp_path / "cluster") as made:
        made.worker(STRIBECK_CC="none")
        with pytest.raises(
            StribeckError,
            match=r"no worker can make these numbers: tcp://.* solves by WebAssembly, not by a C compiler",
        ):
            stribeck.sweep(scenario(), LANES, tmp_path / "there", cluster=made.address)


@pytest.mark.thorough
@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs a full device")  # noqa: PTH110
def test_a_worker_whose_temporary_folder_takes_nothing_is_left_out_and_named(here, tmp_path):
    with cluster_in(tmp_path / "cluster") as made:
        made.worker()
        full = made.worker(TMPDIR=str(tmp_path / "gone"), DASK_TEMPORARY_DIRECTORY=str(made.folder))
        assert full.poll() is None
        with distributed.Client(made.address) as client:
            client.wait_for_workers(2, timeout=60)
            client.run(lambda: __import__("tempfile").__dict__.update(tempdir="/dev/full"), workers=[
                next(a for a, pid in client.run(os.getpid).items() if pid == full.pid)
            ])  # fmt: skip
        with pytest.warns(StribeckNote, match="left out: tcp://"):
            stribeck.sweep(scenario(), LANES, tmp_path / "there", cluster=made.address)
    assert bytes_of(tmp_path / "there") == here


@pytest.mark.thorough
@pytest.mark.skipif(not hasattr(signal, "SIGSTOP"), reason="needs SIGSTOP")
def test_a_worker_that_is_stopped_for_ever_is_named_and_its_parts_go_to_others(here, tmp_path, monkeypatch):
    monkeypatch.setattr(module, "_SILENT", 1.0)
    with cluster_in(tmp_path / "cluster", workers=2) as made:
        with distributed.Client(made.address) as client:
            client.wait_for_workers(2, timeout=60)
        os.killpg(made.workers[0].pid, signal.SIGSTOP)
        with pytest.warns(StribeckNote, match="tcp://.* has not answered for 1 s; Dask gives its parts to others"):
            stribeck.sweep(scenario(), LANES, tmp_path / "there", cluster=made.address)
        assert made.workers[0].poll() is None
    assert bytes_of(tmp_path / "there") == here


@pytest.mark.thorough
def test_a_worker_that_would_make_other_bits_refuses(tmp_path):
    sweep = job.Sweep(scenario(), {k: np.asarray(x) for k, x in LANES.items()}, tmp_path, True)
    first = tuple((path, x[:1].tobytes()) for path, x in sweep.values_of(0).items())
    probe = sweep.order.probe(sweep.values_of(0))
    assert parts._order(sweep.order.to_text(probe), first).scenario.name == sweep.lanes.scenario.name
    with pytest.raises(StribeckError, match="other bits"):
        parts._order(sweep.order.to_text("0" * 64), first)
    other = json.loads(sweep.order.to_text(probe))
    with pytest.raises(StribeckError, match="has Stribeck"):
        parts._order(json.dumps({**other, "stribeck": "0.0.1"}), first)
    with pytest.raises(StribeckError, match="mass"):
        parts._order(json.dumps({**other, "data": {**other["data"], "plant": {"mass": -1}}}), first)


class Future:
    status = "pending"

    def cancel(self, force):
        self.status = "cancelled"


class Scheduler:
    """What `_Work` asks of Dask's client, of workers that answer at once or are still at it."""

    def __init__(self, **threads):
        self.status, self.scheduler, self.beat, self.asked = "running", SimpleNamespace(identity=None), 1.0, []
        self.threads = {f"tcp://{name}": n for name, n in threads.items()}

    def sync(self, identity):
        return {"workers": {a: {"nthreads": n, "last_seen": self.beat} for a, n in self.threads.items()}}

    def submit(self, function, *sent, workers, pure):
        future = Future()
        self.asked.append((sent, workers, future))
        return future


@pytest.fixture
def work():
    def made(parts=20, **threads):
        client = Scheduler(**threads)
        return client, module._Work(client, list(range(parts)), lambda part: (part,))

    return made


def test_two_parts_for_each_thread_in_their_order(work):
    client, asked = work(a=2, b=1)
    for _ in range(2):
        asked._send(asked._workers())
        assert [(sent, workers) for sent, workers, _ in client.asked] == [((n,), None) for n in range(6)]


def test_parts_of_a_worker_that_refuses_go_to_the_others_only(work):
    client, asked = work(a=1, b=1)
    asked._send(asked._workers())
    refused = client.asked[0][2]
    asked.in_hand.pop(refused)
    refused.status, refused.result = "finished", lambda: parts.Refusal("tcp://a", "solves otherwise")
    with pytest.warns(StribeckNote, match="left out: tcp://a solves otherwise"):
        assert asked._result_of(0, refused) is None
    assert not asked.in_hand
    assert sorted(asked.todo) == list(range(20))
    del client.asked[:]
    asked._send(asked._workers())
    assert [workers for _, workers, _ in client.asked] == [["tcp://b"]] * 2
    client.threads = {"tcp://a": 1, "tcp://c": 1}  # the one that the parts in hand may use is gone
    asked._send(asked._workers())
    assert client.asked[-1][1] == ["tcp://c"]
    assert len(asked.todo) + len(asked.in_hand) == 20
    client.threads = {"tcp://a": 1}
    with pytest.raises(StribeckError, match="no worker can make these numbers: tcp://a solves otherwise"):
        asked._send(asked._workers())


def test_a_client_that_is_closed_has_no_workers(work):
    client, asked = work(a=1)
    client.status = "closed"
    with pytest.raises(ConnectionError):
        asked._send(asked._workers())


def test_no_worker_is_said_once_until_one_comes(work, recwarn):
    warnings.simplefilter("always")
    client, asked = work()
    for threads in ({}, {}, {"tcp://a": 1}, {}):
        client.threads = threads
        asked._send(asked._workers())
    said = [str(each.message) for each in recwarn if each.category is StribeckNote]
    assert said == ["cluster: no worker at present; waiting for one (0 of 20 parts done)"] * 2
    client.status = "closed"
    with pytest.raises(ConnectionError):
        asked._workers()


def test_a_silent_worker_is_said_once(work, monkeypatch, recwarn):
    warnings.simplefilter("always")
    client, asked = work(a=1)
    for client.beat, now in [(1, 0), (1, 59), (1, 61), (1, 62), (2, 63), (2, 120), (2, 122.9)]:
        monkeypatch.setattr(module, "monotonic", lambda now=now: float(now))
        asked._workers()
    said = [str(each.message) for each in recwarn if each.category is StribeckNote]
    assert [text[:50] for text in said] == ["cluster: tcp://a has not answered for 60 s; Dask g"]


@pytest.mark.parametrize("status", ["cancelled", "lost"])
def test_a_part_that_is_lost_is_made_again_and_one_that_failed_is_told(status, work):
    _, asked = work(parts=1, a=1)
    asked._send(asked._workers())
    (future,) = asked.in_hand
    asked.in_hand.clear()
    future.status = status
    assert asked._result_of(0, future) is None
    assert list(asked.todo) == [0]
    future.status, future.exception = "error", lambda: ValueError("out of memory")
    with pytest.raises(StribeckError, match=r"part 0 failed on a worker: .*out of memory"):
        asked._result_of(0, future)
