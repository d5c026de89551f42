"""Recordings of ROS, in files that its own libraries wrote in the test, and of BAM."""

import json
import struct
from itertools import islice

import numpy as np
import pytest

from stribeck.errors import InputError, naming
from stribeck.identify.actuator import read_logs
from stribeck.recorded.logs import opened_log
from tests.identify.actuator.recorded import logs

N = 20
T = 0.01 * np.arange(N)
ELBOW, PUSH = np.sin(T), np.cos(3 * T[::2])
JOINTS = """std_msgs/Header header
string[] name
float64[] position
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec"""
BEGIN = 1_700_000_000 * 10**9
UNKNOWN = {"bodies.a.mass": {"low": 0.1, "high": 2.0}}
COLUMNS = {"outputs": {"a.y": "/joints.elbow.position"}, "inputs": {"loads.push.signal": "/effort.data[1]"}}


def stamps(i):
    """When sample i was taken, and when its message arrived: 3 ms later."""
    taken = BEGIN + 10**7 * i
    return taken // 10**9, taken % 10**9, taken + 3 * 10**6


def mcap_file(path):
    from mcap_ros2.writer import Writer

    with path.open("wb") as file:
        writer = Writer(file, chunk_size=200)
        joints = writer.register_msgdef("sensor_msgs/msg/Joints", JOINTS)
        effort = writer.register_msgdef("std_msgs/msg/Effort", "float32[] data")
        for i in range(N):
            sec, nanosec, arrived = stamps(i)
            header = {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": ""}
            message = {"header": header, "name": ["wrist", "elbow"], "position": [9.0, float(ELBOW[i])]}
            writer.write_message("/joints", joints, message, arrived, arrived)
            if i % 2 == 0:
                writer.write_message("/effort", effort, {"data": [0.0, float(PUSH[i // 2])]}, arrived, arrived)
        writer.finish()


def bag(path):
    from rosbags.rosbag1 import Writer as Writer1
    from rosbags.rosbag2 import Writer as Writer2
    from rosbags.typesys import Stores, get_typestore

    old = path.suffix == ".bag"
    store = get_typestore(Stores.ROS1_NOETIC if old else Stores.ROS2_JAZZY)
    kind = store.types
    more = {"seq": 0} if old else {}
    with Writer1(path) if old else Writer2(path, version=9) as writer:
        joints = writer.add_connection("/joints", "sensor_msgs/msg/JointState", typestore=store)
        effort = writer.add_connection("/effort", "std_msgs/msg/Float64MultiArray", typestore=store)
        pack = store.serialize_ros1 if old else store.serialize_cdr
        layout = kind["std_msgs/msg/MultiArrayLayout"](dim=[], data_offset=0)
        for i in range(N):
            sec, nanosec, arrived = stamps(i)
            stamp = kind["builtin_interfaces/msg/Time"](sec=sec, nanosec=nanosec)
            header = kind["std_msgs/msg/Header"](stamp=stamp, frame_id="", **more)
            position = np.array([9.0, ELBOW[i]])
            none = np.zeros(0)
            message = kind["sensor_msgs/msg/JointState"](header, ["wrist", "elbow"], position, none, none)
            writer.write(joints, arrived, pack(message, message.__msgtype__))
            if i % 2 == 0:
                data = np.array([0.0, PUSH[i // 2]])
                message = kind["std_msgs/msg/Float64MultiArray"](layout=layout, data=data)
                writer.write(effort, arrived, pack(message, message.__msgtype__))


@pytest.mark.parametrize("name", ["run.mcap", "run.bag", "run"])
def test_topics_have_their_own_times(name, tmp_path):
    pytest.importorskip("mcap" if name == "run.mcap" else "rosbags")
    (mcap_file if name == "run.mcap" else bag)(tmp_path / name)
    (recording,) = read_logs(logs(tmp_path, [{"file": name, **COLUMNS}], UNKNOWN)).recordings
    y, u = recording.outputs["a.y"], recording.inputs["loads.push.signal"]
    np.testing.assert_allclose([recording.t, y.t], [T] * 2, atol=1e-9)
    np.testing.assert_allclose(y.x, ELBOW, rtol=1e-12)
    np.testing.assert_allclose(u.t, T[::2] + 0.003, atol=1e-9)  # no header: when it was recorded
    np.testing.assert_allclose(u.x, PUSH, rtol=1e-6)
    assert opened_log(tmp_path / name).columns({"time": "/joints.t"})["time"][0] == 0


def test_a_topic_that_is_not_there_and_a_file_that_is_none(tmp_path):
    pytest.importorskip("mcap")
    mcap_file(tmp_path / "run.mcap")
    wrong = COLUMNS | {"outputs": {"a.y": "/joints.elbo.position"}, "time": "/joints.t"}
    (tmp_path / "torn.mcap").write_bytes((tmp_path / "run.mcap").read_bytes()[:200])
    (tmp_path / "text.mcap").write_text("t,y\n0,1\n")
    with pytest.raises(InputError) as error:
        read_logs(logs(tmp_path, [{"file": "run.mcap", **wrong}, "torn.mcap", "text.mcap"], UNKNOWN))
    first, torn, text = error.value.problems
    assert "did you mean '/joints.elbow.position'?" in first
    assert "torn.mcap': cannot be read as MCAP" in torn
    assert "text.mcap': cannot be read as MCAP" in text


@pytest.mark.parametrize("within", [False, True], ids=["message", "number"])
def test_a_bag_that_was_cut_short_gives_what_it_has(within, tmp_path, monkeypatch):
    """Where it ends within a number, releases of mcap before 1.6 raise struct.error."""
    reader = pytest.importorskip("mcap.reader").NonSeekingReader
    path = tmp_path / "run.mcap"
    mcap_file(path)
    every = reader.iter_messages

    def torn(self, **how):
        yield from islice(every(self, **how), 20)
        struct.unpack("<Q", b"1234")

    if within:
        monkeypatch.setattr(reader, "iter_messages", torn)
    else:
        whole = path.read_bytes()
        path.write_bytes(whole[: len(whole) // 2])
    (recording,) = read_logs(logs(tmp_path, [{"file": "run.mcap", **COLUMNS}], UNKNOWN)).recordings
    assert 8 <= len(recording.t) < N
    assert any("cut short" in note for note in recording.notes)


def test_messages_in_json(tmp_path):
    pytest.importorskip("mcap")
    from mcap.writer import Writer

    with (tmp_path / "run.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("joint", "jsonschema", b"{}")
        channel = writer.register_channel("/joints", "json", schema)
        for i in range(N):
            data = json.dumps({"elbow": {"position": ELBOW[i]}, "on": True, "many": 64 * [ELBOW[i]]}).encode()
            writer.add_message(channel, 10**7 * i, data, 10**7 * i)
        writer.finish()
    (recording,) = read_logs(logs(tmp_path, [{"file": "run.mcap", **COLUMNS, "inputs": {}}], UNKNOWN)).recordings
    last = opened_log(tmp_path / "run.mcap").columns({"y": "/joints.many[63]"})["y"]
    np.testing.assert_allclose([recording.outputs["a.y"].x, last], [ELBOW] * 2)


def test_messages_within_messages(tmp_path):
    """ros2_control's joint states, a trajectory and an odometry's covariance, in a compressed bag of SQLite."""
    pytest.importorskip("rosbags")
    from rosbags.rosbag2 import CompressionFormat, CompressionMode, Writer
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    state, value = "control_msgs/msg/DynamicJointState", "control_msgs/msg/InterfaceValue"
    store.register(get_types_from_msg("string[] interface_names\nfloat64[] values", value))
    text = "std_msgs/Header header\nstring[] joint_names\nInterfaceValue[] interface_values"
    store.register(get_types_from_msg(text, state))
    store.register(get_types_from_msg("geometry_msgs/PoseWithCovariance pose\nstring[] name", "my_msgs/msg/Odometer"))
    kind, none = store.types, np.zeros(0)
    point, still = (
        kind["geometry_msgs/msg/Point"](1.0, 2.0, 3.0),
        kind["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0),
    )
    pose = kind["geometry_msgs/msg/Pose"](point, still)
    begin = kind["builtin_interfaces/msg/Duration"](sec=1, nanosec=0)
    bag = Writer(tmp_path / "run", version=8)
    bag.set_compression(CompressionMode.MESSAGE, CompressionFormat.ZSTD)
    with bag:
        topics = {
            "/states": state,
            "/odometer": "my_msgs/msg/Odometer",
            "/wanted": "trajectory_msgs/msg/JointTrajectory",
        }
        ways = {topic: bag.add_connection(topic, each, typestore=store) for topic, each in topics.items()}
        for i in range(N):
            stamp = kind["builtin_interfaces/msg/Time"](*stamps(i)[:2])
            header = kind["std_msgs/msg/Header"](stamp, "")
            values = [kind[value](["position", "effort"], np.array([ELBOW[i] + k, 10.0 * k])) for k in (0, 1)]
            covered = kind["geometry_msgs/msg/PoseWithCovariance"](pose, np.arange(36.0))
            aim = kind["trajectory_msgs/msg/JointTrajectoryPoint"](np.array([0.0, float(i)]), none, none, none, begin)
            for topic, message in {
                "/states": kind[state](header, ["wrist", "elbow"], values),
                "/odometer": kind["my_msgs/msg/Odometer"](covered, ["base"]),
                "/wanted": kind["trajectory_msgs/msg/JointTrajectory"](header, ["wrist", "elbow"], [aim]),
            }.items():
                bag.write(ways[topic], stamps(i)[2], store.serialize_cdr(message, message.__msgtype__))
    columns = {
        "outputs": {"a.y": "/states.elbow.interface_values.position.values", "a.v": "/odometer.pose.covariance[35]"},
        "inputs": {"loads.push.signal": "/wanted.points[0].elbow.positions"},
    }
    (recording,) = read_logs(logs(tmp_path, [{"file": "run", **columns}], UNKNOWN)).recordings
    np.testing.assert_allclose(recording.outputs["a.y"].x, ELBOW + 1, rtol=1e-12)
    assert recording.outputs["a.v"].x.tolist() == [35.0] * N
    assert recording.inputs["loads.push.signal"].x.tolist() == list(range(N))
    (part,) = (tmp_path / "run").glob("*.db3")
    with pytest.raises(InputError, match=r"part of a rosbag: give the folder"):
        read_logs(logs(tmp_path, [{"file": str(part), **columns}], UNKNOWN))


def test_the_units_that_a_file_states_are_used_unless_others_are_given(tmp_path):
    rows = "".join(f"{10 * k},{k},{2 * k}\n" for k in range(N))
    (tmp_path / "run.csv").write_text(f"t,q,i\nms,deg,kN\n{rows}")
    columns = {"outputs": {"a.y": "q"}, "inputs": {"loads.push.signal": {"column": "i", "unit": "mN"}}}
    (one,) = read_logs(logs(tmp_path, [{"file": "run.csv", **columns}], UNKNOWN)).recordings
    np.testing.assert_allclose(one.t, T, rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(one.outputs["a.y"].x, np.deg2rad(np.arange(N)), rtol=1e-12)
    assert one.outputs["a.y"].unit == "deg"
    np.testing.assert_allclose(one.inputs["loads.push.signal"].x, 2e-3 * np.arange(N), rtol=1e-12)


def test_a_log_of_bam_has_constants_beside_its_columns(tmp_path):
    rows = [{"position": float(x), "goal_position": 1.0} for x in ELBOW]
    (tmp_path / "run.json").write_text(json.dumps({"mass": 1.5, "motor": "xl", "dt": 0.01, "entries": rows}))
    source = opened_log(tmp_path / "run.json")
    assert source.constants == {"mass": 1.5, "dt": 0.01}
    result = source.columns({"time": "t", "position": "position"})
    np.testing.assert_allclose(result["time"], T, atol=1e-15)
    assert result["position"].tolist() == ELBOW.tolist()


@pytest.mark.parametrize(
    ("content", "said"),
    [("{", "is not JSON"), ("[1]", "must be a log of BAM"), ('{"entries": []}', "must be a log of BAM"),
     ('{"entries": [1]}', "must be a log of BAM"), (None, "cannot be read")],
)  # fmt: skip
def test_what_is_no_log_of_bam_is_refused(content, said, tmp_path):
    if content is not None:
        (tmp_path / "run.json").write_text(content)
    with pytest.raises(InputError, match=rf"run\.json': {said}"):
        opened_log(tmp_path / "run.json")


def test_a_log_of_bam_may_state_its_times(tmp_path):
    for times, dt in (({}, {"dt": 0.5}), ({"timestamp": [0.0, 0.5, 1.0]}, {}), ({"t": [0.0, 0.5, 1.0]}, {"dt": 7.0})):
        rows = [{"position": 1.0, "said": "x", **{n: x[i] for n, x in times.items()}} for i in range(3)]
        (tmp_path / "run.json").write_text(json.dumps({"entries": rows, **dt}))
        source = opened_log(tmp_path / "run.json")
        assert source.columns({"time": "t"})["time"].tolist() == [0.0, 0.5, 1.0]
        assert "said" not in source.names


@pytest.mark.parametrize(
    ("time", "said"),
    [(3 - T, r"falls from 3 s to 2\.99 s: 1 of 20 rows"), (0 * T + 3, r"repeats 3 s: 1 of 20 rows"),
     (T[:5], "has 5 rows with a time: must have at least 8")],
)  # fmt: skip
def test_why_a_recording_has_too_few_rows(time, said, tmp_path):
    """A time that ran backwards was reported as a file of one row."""
    rows = "".join(f"{t},{t}\n" for t in time)
    (tmp_path / "run.csv").write_text(f"t,y\n{rows}")
    with pytest.raises(InputError, match=said):
        read_logs(logs(tmp_path, [{"file": "run.csv", "outputs": {"a.y": "y"}, "inputs": {}}], UNKNOWN))


@pytest.mark.parametrize("name", ["none.csv", "none.json", "none.db3", "torn.npz"])
def test_a_file_that_cannot_be_read_is_called_by_its_key(name, tmp_path):
    """Its line said 'log.0.file: DATA: ...', and of a column '--log 0.outputs...'."""
    (tmp_path / "torn.npz").write_text("no archive")
    (tmp_path / "text.csv").write_text("t,y\n" + "0.1,much\n" * 9)
    tables = [
        {"file": name, "outputs": {"a.y": "y"}, "inputs": {}},
        {"file": "text.csv", "outputs": {"a.y": "y"}, "inputs": {}},
    ]
    path = logs(tmp_path, tables, UNKNOWN)
    with naming(str.upper), pytest.raises(InputError) as refused:
        read_logs(path)
    file, column = refused.value.problems
    assert file.startswith(f"{path}: log.0.file: '{tmp_path / name}'")
    assert column.startswith(f"{path}: log.1.outputs.a.y: column 'y' holds text")
