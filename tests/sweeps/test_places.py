"""Sweeps into places that fsspec knows: one in memory, and a real S3 server."""

import json
import os
import signal
import socket
import subprocess
import sys
import urllib.request

import numpy as np
import pytest

import stribeck
from stribeck.errors import InputError, StribeckError
from stribeck.sweeps.places import Store

fsspec = pytest.importorskip("fsspec")

LANES = {"law.k_v": np.geomspace(1e6, 1e8, 12)}
SCENARIO = {
    "law": {"name": "lugre_majorant", "k_v": 1e6, "parameters": "canudas1995"}, "plant": {"mass": 1.0},
    "drive": {"kind": "spring", "stiffness": 2.0, "signal": {"kind": "ramp", "rate": 0.1}},
    "solve": {"t_end": 2.0}, "output": {"step": 0.01},
}  # fmt: skip


@pytest.fixture
def expected(tmp_path):
    stribeck.sweep(SCENARIO, LANES, tmp_path / "here", summary=True)
    return {path.name: path.read_bytes() for path in (tmp_path / "here").iterdir()}


def objects(url):
    return {name: Store(url).get(name) for name in Store(url).names()}


def goes_on(url, expected):
    """A sweep into a place; again where a part is damaged and one is gone; another one is refused."""
    stribeck.sweep(SCENARIO, LANES, url, summary=True)
    assert objects(url) == expected
    Store(url).put("part-000003.parquet", b"damaged")
    files, path = fsspec.core.url_to_fs(url)
    files.rm_file(f"{path}/part-000005.parquet")
    seen = []
    found = stribeck.sweep(SCENARIO, LANES, url, summary=True, progress=lambda share, lanes: seen.append(lanes))
    assert seen[-1] == 4  # lanes: two parts, and no others
    assert found.found == 4
    assert objects(url) == expected
    with pytest.raises(InputError, match="holds another sweep"):
        stribeck.sweep(SCENARIO, {"law.k_v": [1e6]}, url, summary=True)
    assert objects(url) == expected


def test_in_memory(expected):
    goes_on("memory://sweep", expected)


@pytest.fixture(scope="module")
def bucket():
    """An S3 server in a process of its own; the environment says where."""
    pytest.importorskip("s3fs")
    pytest.importorskip("moto.server")
    process = subprocess.Popen(
        [sys.executable, "-c", _SERVER], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
        start_new_session=True,
    )  # fmt: skip
    port = int(process.stdout.readline())
    with pytest.MonkeyPatch.context() as patch:
        for name, value in {
            "AWS_ENDPOINT_URL": f"http://127.0.0.1:{port}", "AWS_ACCESS_KEY_ID": "a", "AWS_SECRET_ACCESS_KEY": "b",
            "AWS_DEFAULT_REGION": "us-east-1", "AWS_EC2_METADATA_DISABLED": "true",
        }.items():  # fmt: skip
            patch.setenv(name, value)
        request = urllib.request.Request(f"http://127.0.0.1:{port}/bucket", method="PUT")
        assert urllib.request.urlopen(request).status == 200
        yield "s3://bucket"
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    process.stdout.close()


_SERVER = """
import time
from moto.server import ThreadedMotoServer
server = ThreadedMotoServer("127.0.0.1", 0, verbose=False)
server.start()
print(server.get_host_and_port()[1], flush=True)
while True:
    time.sleep(60)
"""


def test_in_an_object_store(bucket, expected):
    goes_on(f"{bucket}/sweep", expected)


def test_a_manifest_that_cannot_be_read_now_is_not_called_damaged(expected, monkeypatch):
    """A server's failure ends the sweep before anything is written."""
    url = "memory://busy"
    stribeck.sweep(SCENARIO, LANES, url, summary=True)

    def busy(self, path, *args, **kwargs):
        raise OSError("503 Slow Down")

    with monkeypatch.context() as now:
        now.setattr(type(Store(url)._files), "cat_file", busy)
        with pytest.raises(StribeckError, match=r"cannot be read now \(_manifest.json\): OSError: 503 Slow Down"):
            stribeck.sweep(SCENARIO, LANES, url, summary=True)
    assert objects(url) == expected
    assert stribeck.sweep(SCENARIO, LANES, url, summary=True).found == 6
    Store(url).put("_manifest.json", b"{")
    with pytest.raises(InputError, match=r"_manifest\.json in it is damaged"):
        stribeck.sweep(SCENARIO, LANES, url, summary=True)


@pytest.mark.thorough
def test_a_store_that_accepts_and_never_answers_ends_by_the_library_s_own_time_limit(monkeypatch):
    pytest.importorskip("s3fs")
    with socket.create_server(("127.0.0.1", 0)) as silent:
        settings = {"read_timeout": 0.5, "retries": {"max_attempts": 0}}
        monkeypatch.setitem(fsspec.config.conf, "s3", {
            "key": "a", "secret": "b", "config_kwargs": settings,
            "endpoint_url": f"http://127.0.0.1:{silent.getsockname()[1]}",
        })  # fmt: skip
        with pytest.raises(StribeckError, match="out: 's3://bucket/x': cannot be listed"):
            stribeck.sweep(SCENARIO, LANES, "s3://bucket/x", summary=True)


def test_the_manifest_counts_the_lanes_beyond_the_promised_accuracy(tmp_path):
    """Also of parts from an earlier run."""
    speed = 2 / np.sqrt(1 - 1e-13)  # over the top of the pendulum by so little that rounding decides when it falls
    data = {
        "schema": 2, "bodies": {"arm": {"inertia": 1.0}},
        "loads": {"gravity": {"on": "arm", "kind": "pendulum", "amplitude": 1.0}},
        "solve": {"t_end": 20.0}, "output": {"step": 0.1},
    }  # fmt: skip
    for _ in range(2):
        found = stribeck.sweep(data, {"bodies.arm.initial.v": [1.0, speed]}, tmp_path, summary=True)
        manifest = json.loads((tmp_path / "_manifest.json").read_text())
        assert found.inaccurate == sum(manifest["inaccurate"].values()) == 1


def test_the_manifest_counts_the_lanes_that_failed(tmp_path):
    found = stribeck.sweep(SCENARIO, {"plant.mass": [1.0, -1.0, 2.0]}, tmp_path, summary=True)
    manifest = json.loads((tmp_path / "_manifest.json").read_text())
    assert found.failed == sum(manifest["failed"].values()) == 1
    assert stribeck.sweep(SCENARIO, {"plant.mass": [1.0, -1.0, 2.0]}, tmp_path, summary=True).failed == 1


@pytest.mark.parametrize("count", [None, "x", -1, True, 1.5])
def test_a_manifest_whose_counts_are_no_counts_is_damaged(count, tmp_path):
    stribeck.sweep(SCENARIO, LANES, tmp_path, summary=True)
    path = tmp_path / "_manifest.json"
    manifest = json.loads(path.read_text())
    manifest["failed"][min(manifest["failed"])] = count
    path.write_text(json.dumps(manifest))
    with pytest.raises(InputError, match=r"_manifest\.json in it is damaged"):
        stribeck.sweep(SCENARIO, LANES, tmp_path, summary=True)
