"""Sweeps on a cluster of real processes and in a real object store: the same bytes, whatever dies on the way."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
import urllib.request
from contextlib import contextmanager

import numpy as np
import pytest

import stribeck
from stribeck.errors import InputError, StribeckError, StribeckNote
from stribeck.identify.actuator import fit_machine
from stribeck.identify.log import Log
from stribeck.identify.methods.dynamic import fit_dynamic
from stribeck.identify.methods.motion import fit_motion
from stribeck.identify.work import Work
from stribeck.simulation import lanes, response
from stribeck.simulation.variations import Variations
from stribeck.sweeps import job as module
from stribeck.sweeps import places, worker
from stribeck.sweeps.job import Sweep
from stribeck.sweeps.places import Store, place_of
from tests.identify import rig
from tests.identify.actuator.recorded import body, logs, record
from tests.simulation.rig import needs_compiler

distributed = pytest.importorskip("distributed")
pytestmark = [needs_compiler, pytest.mark.filterwarnings("ignore::stribeck.errors.StribeckNote")]

LANES = {"law.k_v": np.geomspace(1e6, 1e8, 24), "plant.mass": np.linspace(1.0, 2.0, 24)}


@pytest.fixture(autouse=True)
def small_parts(monkeypatch):
    """Two lanes a part."""
    monkeypatch.setattr(module, "_PART_BYTES", 2 * 8.0 * 7 * 201)


@pytest.fixture
def own_law(tmp_path):
    """A scenario with a law in a file and a parameter set beside it."""
    (tmp_path / "mine.py").write_text(
        "from stribeck.laws.lugre import LuGre\nclass Mine(LuGre):\n    name = 'mine'\n    description = 'LuGre, another name'\n"
    )
    return tmp_path


def scenario(folder=None, law=None):
    return stribeck.Scenario(
        law=law or {"name": "lugre_majorant", "k_v": 1e6, "parameters": "canudas1995"},
        plant={"mass": 1.0},
        drive={"kind": "spring", "stiffness": 2.0, "signal": {"kind": "ramp", "rate": 0.1}},
        solve={"t_end": 10.0},
        output={"step": 0.05},
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
        self.on = self.address.replace("tcp://", "dask://")

    def _start(self, *words, **environment):
        command = [sys.executable, "-m", "distributed.cli.dask_" + words[0], *map(str, words[1:])]
        environment = {**os.environ, **environment}
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
def cluster_in(folder):
    folder.mkdir()
    made = Cluster(folder)
    try:
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
def bucket():
    """An S3 server in a process of its own; the environment says where."""
    process = subprocess.Popen(
        [sys.executable, "-c", _SERVER],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        start_new_session=True,
    )
    port = int(process.stdout.readline())
    here = {
        "AWS_ENDPOINT_URL": f"http://127.0.0.1:{port}", "AWS_ACCESS_KEY_ID": "a", "AWS_SECRET_ACCESS_KEY": "b",
        "AWS_DEFAULT_REGION": "us-east-1", "AWS_EC2_METADATA_DISABLED": "true",
    }  # fmt: skip
    with pytest.MonkeyPatch.context() as patch:
        for name, value in here.items():
            patch.setenv(name, value)
        request = urllib.request.Request(f"http://127.0.0.1:{port}/bucket", method="PUT")
        assert urllib.request.urlopen(request).status == 200
        yield "s3://bucket"
    with_group(process, signal.SIGKILL)
    process.stdout.close()


_SERVER = """
import sys, time
from moto.server import ThreadedMotoServer
server = ThreadedMotoServer("127.0.0.1", 0, verbose=False)
server.start()
print(server.get_host_and_port()[1], flush=True)
while True:
    time.sleep(60)
"""


def objects(url):
    place = Store(url)
    found = {}
    for name in place.names():
        with place.open(name) as file:
            found[name] = file.read()
    return found


def test_workers_killed_on_the_way_and_one_without_a_compiler(cluster, tmp_path):
    stribeck.sweep(scenario(), LANES, tmp_path / "here")
    killed = []

    def kill(share, lanes):
        if not killed and lanes >= 6:
            killed.append(cluster.workers.pop(1))
            with_group(killed[0], signal.SIGKILL)
            cluster.worker()

    with pytest.warns(StribeckNote, match="left out: tcp://.* has no C compiler"):
        stribeck.sweep(scenario(), LANES, tmp_path / "there", progress=kill, on=cluster.on)
    assert killed
    assert bytes_of(tmp_path / "there") == bytes_of(tmp_path / "here")
    assert len(bytes_of(tmp_path / "here")) == 13


def test_a_law_of_ones_own_goes_along_as_text(cluster, own_law, tmp_path):
    law = {"name": "mine.py:Mine", "parameters": "canudas1995"}
    stribeck.sweep(scenario(own_law, law), {"plant.mass": [1.0, 1.5, 2.0]}, tmp_path / "here", summary=True)
    stribeck.sweep(
        scenario(own_law, law), {"plant.mass": [1.0, 1.5, 2.0]}, tmp_path / "there", summary=True, on=cluster.on
    )
    assert bytes_of(tmp_path / "there") == bytes_of(tmp_path / "here")


def test_a_scheduler_that_goes_away_is_one_line_and_the_sweep_goes_on(tmp_path):
    stribeck.sweep(scenario(), LANES, tmp_path / "here")
    with cluster_in(tmp_path / "cluster") as made:
        made.worker()

        def kill(share, lanes):
            if lanes >= 4 and made.scheduler.poll() is None:
                with_group(made.scheduler, signal.SIGKILL)

        with pytest.raises(
            StribeckError, match=r"the scheduler went away after \d+ of 12 parts; the same command goes on"
        ):
            stribeck.sweep(scenario(), LANES, tmp_path / "there", progress=kill, on=made.on)
    done = json.loads((tmp_path / "there" / "_manifest.json").read_text())["sha256"]
    assert 2 <= len(done) < 12
    stribeck.sweep(scenario(), LANES, tmp_path / "there")
    assert bytes_of(tmp_path / "there") == bytes_of(tmp_path / "here")


def test_no_worker_that_can(tmp_path):
    with cluster_in(tmp_path / "cluster") as made:
        made.worker(STRIBECK_CC="none")
        with (
            pytest.warns(StribeckNote, match="left out"),
            pytest.raises(StribeckError, match=r"no worker can make these numbers: tcp://.* has no C compiler"),
        ):
            stribeck.sweep(scenario(), LANES, tmp_path / "there", on=made.on)


def test_in_an_object_store_by_workers_and_from_here(bucket, tmp_path):
    stribeck.sweep(scenario(), LANES, tmp_path / "here", summary=True)
    expected = bytes_of(tmp_path / "here")
    stribeck.sweep(scenario(), LANES, f"{bucket}/alone", summary=True)
    assert objects(f"{bucket}/alone") == expected
    with cluster_in(tmp_path / "cluster") as made:
        made.worker()
        stribeck.sweep(scenario(), LANES, f"{bucket}/workers", summary=True, on=made.on)
    assert objects(f"{bucket}/workers") == expected
    place = Store(f"{bucket}/workers")
    place.put("part-000003.parquet", lambda beside: beside.write_bytes(b"damaged"))
    place._files.delete_file(place._at("part-000005.parquet"))
    seen = []
    stribeck.sweep(
        scenario(), LANES, f"{bucket}/workers", summary=True, progress=lambda share, lanes: seen.append(lanes)
    )
    assert seen[-1] == 4  # lanes: two parts, and no others
    assert objects(f"{bucket}/workers") == expected
    with pytest.raises(StribeckError, match="holds another sweep"):
        stribeck.sweep(scenario(), {"law.k_v": [1e6]}, f"{bucket}/workers", summary=True)


def test_two_clients_of_one_store(bucket, tmp_path, monkeypatch):
    monkeypatch.setattr(places, "_BEAT", 0.2)
    place, entered, leave = Store(f"{bucket}/two"), threading.Event(), threading.Event()

    def first():
        with place.alone():
            entered.set()
            leave.wait()

    thread = threading.Thread(target=first)
    thread.start()
    try:
        assert entered.wait(30)
        wait_for(lambda: place.names() or None)
        with pytest.raises(StribeckError, match="another process is at work there"):
            stribeck.sweep(scenario(), LANES, f"{bucket}/two", summary=True)
    finally:
        leave.set()
        thread.join()
    places.put_json(place, "_busy.json", {"who": "one that was killed", "token": "x", "beat": 3})
    stribeck.sweep(scenario(), LANES, f"{bucket}/two", summary=True)
    assert set(place.names()) == {"_manifest.json", *(f"part-{i:06d}.parquet" for i in range(12))}


def test_a_worker_that_would_make_other_bits_says_so(tmp_path):
    job = Sweep(scenario(), {k: np.asarray(x) for k, x in LANES.items()}, tmp_path, True)
    first = tuple((path, x[:1].tobytes()) for path, x in job.values_of(0).items())
    probe = job.order.probe(job.values_of(0))
    assert worker._built(job.order.to_text(probe), first).scenario.name == job.lanes.scenario.name
    with pytest.raises(worker.Refused, match="other bits"):
        worker._built(job.order.to_text("0" * 64), first)
    other = json.loads(job.order.to_text(probe))
    with pytest.raises(worker.Refused, match="has Stribeck"):
        worker._built(json.dumps({**other, "stribeck": "0.0.1"}), first)
    with pytest.raises(worker.Refused, match="cannot build it"):
        worker._built(json.dumps({**other, "data": {**other["data"], "plant": {"mass": -1}}}), first)


def test_a_worker_that_would_solve_lanes_to_other_bits_says_so():
    values = {path: np.asarray(x) for path, x in LANES.items()}
    given = Variations(scenario(), values)
    first = tuple((path, x[:1].tobytes()) for path, x in values.items())
    probe = lanes.solve_here(lanes.compiled(given.scenario.system), given.part(np.array([0])), 1).digest
    solve = worker._solver(worker.lanes_text(scenario(), probe), first)
    assert solve(values).states.shape[0] == 24
    with pytest.raises(worker.Refused, match="other bits"):
        worker._solver(worker.lanes_text(scenario(), "0" * 64), first)
    with pytest.raises(worker.Refused, match="other bits"):  # the bits of another lane
        worker._solver(worker.lanes_text(scenario(), probe), tuple((p, x[1:2].tobytes()) for p, x in values.items()))


def test_paths_in_any_order(tmp_path):
    """The columns of a part have the order of the paths: a worker's first lane too."""
    values = {path: np.asarray(LANES[path]) for path in sorted(LANES, reverse=True)}
    job = Sweep(scenario(), values, tmp_path, True)
    job.run()
    text = job.order.to_text(job.order.probe(job.values_of(0)))
    first = {path: x[:1].tobytes() for path, x in job.values_of(0).items()}
    numbers = {path: x.tobytes() for path, x in job.values_of(3).items()}
    assert worker.part(text, first, numbers, 6, job.name(3))["data"] == job.path(3).read_bytes()


def test_places_of_paths_and_urls(tmp_path):
    assert isinstance(place_of(tmp_path), places.Folder)
    assert str(place_of(str(tmp_path))) == str(tmp_path)


def bits(ensemble):
    return {name: ensemble[name].tobytes() for name in ("y", "v", "F")}, ensemble.reason, ensemble.accepted.tolist()


def test_lanes_of_an_ensemble_from_workers_of_which_one_is_killed(cluster):
    """Numbers and reasons as this machine's, to the last bit; one lane may not be, and one fails."""
    values = {"law.k_v": np.geomspace(1e6, 1e8, 66), "plant.mass": np.linspace(1.0, 2.0, 66)}
    values["plant.mass"][7] = -1.0
    here = stribeck.simulate_ensemble(scenario(), values)
    killed = []

    def kill(share):
        if not killed:
            killed.append(cluster.workers.pop())
            with_group(killed[0], signal.SIGKILL)
            cluster.worker()

    with stribeck.on_cluster(cluster.on):
        there = stribeck.simulate_ensemble(scenario(), values, progress=kill)
    assert killed
    assert bits(there) == bits(here)
    assert "plant.mass" in here.reason[7]


def test_a_fit_of_a_machine_on_workers_finds_the_same_bits(cluster, tmp_path):
    for i, amplitude in enumerate((3.0, 5.0)):
        record(tmp_path / f"run{i}.csv", body(amplitude=amplitude), seed=i)
    wanted = {
        "contacts.guide.law.parameters.F_c": {"low": 0.1, "high": 10.0},
        "bodies.a.mass": {"low": 0.2, "high": 5.0},
    }
    path = logs(tmp_path, ["run0.csv", "run1.csv"], wanted)
    here = fit_machine(body(mass=2.0, F_c=0.5, F_s=1.3), path, starts=2, baselines=False)
    with stribeck.on_cluster(cluster.on):
        there = fit_machine(body(mass=2.0, F_c=0.5, F_s=1.3), path, starts=2, baselines=False)
    assert there.to_json() == here.to_json()
    assert there.status == "done"


def test_a_fit_of_a_log_on_workers_of_which_one_is_killed_finds_the_same_bits(cluster):
    """Starts and profiles; every answer of the law comes from a worker."""
    log = rig.measured([rig.loop(2e-5, 4.0), rig.stroke(5e-3), rig.stroke(0.1)])
    given = {"mass": 0.0, "starts": 4}
    here = fit_dynamic(log, "lugre", **given)
    asked, answer = [], response.answer_here

    def counted(question):
        asked.append(question.function)
        return answer(question)

    def kill(share):
        if share > 0.1 and not killed:
            killed.append(cluster.workers.pop())
            with_group(killed[0], signal.SIGKILL)
            cluster.worker()

    killed = []
    with stribeck.on_cluster(cluster.on), pytest.MonkeyPatch.context() as patch:
        patch.setattr(response, "answer_here", counted)
        there = fit_dynamic(log, "lugre", work=Work(kill), **given)
    assert there.to_json() == here.to_json()
    assert killed
    assert len(asked) == 1  # the probe


@pytest.mark.thorough
def test_a_fit_of_the_motion_on_workers_finds_the_same_bits(cluster):
    t = np.arange(0, 0.8, 2e-3)
    force = (16 + 6 * np.sin(2 * np.pi * 1.3 * t)) * np.sin(2 * np.pi * 0.8 * t)
    law = {"name": "lugre", "parameters": rig.TRUTH}
    signal_ = {"kind": "points", "t": t.tolist(), "value": force.tolist()}
    data = {"law": law, "plant": {"mass": 2.0}, "drive": {"kind": "force", "signal": signal_}}
    moved = stribeck.simulate({**data, "solve": {"t_end": float(t[-1])}, "output": {"step": 2e-3}})
    noise = 1e-4 * np.random.default_rng(0).standard_normal(len(t))
    log = Log(
        time=t, position=moved["y"], velocity=moved["v"] + noise, acceleration=np.gradient(moved["v"], 2e-3), force=force,
        run=np.zeros(len(t), np.int32), step=2e-3,
    )  # fmt: skip
    given = {"body": (), "starts": 1, "profiles": False}
    here = fit_motion(log, "lugre", **given)
    with stribeck.on_cluster(cluster.on):
        there = fit_motion(log, "lugre", **given)
    assert there.to_json() == here.to_json()


def test_a_worker_that_would_answer_to_other_bits_says_so():
    law = response.Response(stribeck.law("lugre", "canudas1995").__class__)
    numbers = {
        "t": np.linspace(0, 1, 5),
        "v": np.ones(5),
        "bend": np.zeros(5),
        "constants": law.lanes([law_constants()]),
    }
    numbers |= {"z": np.zeros(1), "gain": np.zeros(len(law.names)), "tolerance": np.array([1e-12])}
    question = response.Question("stribeck_respond", law._text, numbers)
    found = response.answer_here(question)
    assert found is not None
    right = worker.law_text(question, response.digest(found))
    assert worker.some_answers(right, numbers)["found"][0].tobytes() == found[0].tobytes()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(worker, "_address", lambda: "tcp://one")
        told = worker.some_answers(worker.law_text(question, "0" * 64), numbers)
        assert "other bits" in told["refused"]
        patch.setattr(worker.compiler, "find", lambda: None)
        worker._law.cache_clear()
        assert worker.some_answers(right, numbers)["refused"] == "has no C compiler"


def law_constants():
    return stribeck.law("lugre", "canudas1995").values


def test_lanes_whose_scheduler_goes_away(tmp_path):
    with cluster_in(tmp_path / "cluster") as made:
        made.worker()
        with stribeck.on_cluster(made.on):
            stribeck.simulate_ensemble(scenario(), {"plant.mass": [1.0, 2.0]})
            with_group(made.scheduler, signal.SIGKILL)
            with pytest.raises(StribeckError, match=r"the scheduler went away after 0 of 1 parts$"):
                stribeck.simulate_ensemble(scenario(), {"plant.mass": [1.0, 2.0]})
    assert stribeck.simulate_ensemble(scenario(), {"plant.mass": [1.0]}).status == ["done"]  # here again


@pytest.mark.parametrize("on", ["dask://", "ray"])
def test_what_is_no_cluster(on):
    with pytest.raises(InputError, match="on: "), stribeck.on_cluster(on):
        pass
