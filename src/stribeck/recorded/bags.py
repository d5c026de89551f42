"""Reads recordings of ROS: MCAP files and rosbags. The numbers of each topic become columns with their own times."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterable, Iterator, Mapping
from numbers import Real
from pathlib import Path

import numpy as np

from stribeck.arrays import Array
from stribeck.errors import InputError, arg, needed
from stribeck.recorded import Source

_LONGEST = 64  # numbers of an array: a longer one is an image or a point cloud, not an actuator's signal
_NAMES = ("name", "names", "joint_names", "interface_names")  # fields with the names of an equally long array's entries

Messages = Iterable[tuple[str, int, object]]  # topic, time (ns), message


class BagSource(Source):
    """Columns ``TOPIC.FIELD`` (``/joint_states.elbow.position``), and ``TOPIC.t`` in s from the first message.

    ``TOPIC.t`` is the header's stamp, or the time of recording without one. ``times`` maps each column to its time
    column.
    """

    def __init__(self, path: Path, messages: Messages) -> None:
        rows: dict[str, list[tuple[int, dict[str, float]]]] = {}
        for topic, logged, message in messages:
            stamp = _stamp(message)
            rows.setdefault(topic, []).append((logged if stamp is None else stamp, dict(_fields("", message, ()))))
        rows = {
            topic: messages_of_topic
            for topic, messages_of_topic in rows.items()
            if any(numbers for _, numbers in messages_of_topic)
        }
        if not rows:
            raise InputError(f"{arg('data')}: '{path}': has no messages with numbers")
        begin = min(row[0] for messages_of_topic in rows.values() for row in messages_of_topic)
        columns: dict[str, Array] = {}
        self.times: dict[str, str] = {}
        self.notes: list[str] = []
        for topic, messages_of_topic in rows.items():
            messages_of_topic.sort(key=lambda row: row[0])  # messages may arrive out of order
            columns[f"{topic}.t"] = np.array([(logged - begin) * 1e-9 for logged, _ in messages_of_topic])
            for name in dict.fromkeys(name for _, numbers in messages_of_topic for name in numbers):
                columns[f"{topic}.{name}"] = np.array([numbers.get(name, np.nan) for _, numbers in messages_of_topic])
                self.times[f"{topic}.{name}"] = f"{topic}.t"
        super().__init__(path, columns)
        self.names, self.constants = list(self.variables), {}  # a topic with one message has columns too


def _stamp(message: object) -> int | None:
    """The time in a message's header, ns; None without a header, or if the stamp is not set."""
    stamp = _get(_get(message, "header"), "stamp")
    seconds = _get(stamp, "sec", _get(stamp, "secs"))
    rest = _get(stamp, "nanosec", _get(stamp, "nsecs", 0))
    if not isinstance(seconds, int) or not isinstance(rest, int) or seconds == rest == 0:
        return None
    return seconds * 10**9 + rest


def _get(message: object, name: str, other: object = None) -> object:
    return message.get(name, other) if isinstance(message, Mapping) else getattr(message, name, other)


def _inside(message: object) -> dict[str, object] | None:
    """A message's fields; None if the value is not a message."""
    if isinstance(message, Mapping):
        return {str(n): x for n, x in message.items()}
    names = getattr(message, "__dataclass_fields__", None) or getattr(message, "__slots__", None)
    return {n: getattr(message, n) for n in names if not n.startswith("_")} if names else None


def _fields(path: str, value: object, called: tuple[str, ...]) -> Iterator[tuple[str, float]]:
    """The numbers in a message by path. Entries of arrays as long as ``called`` have these names, others their index."""
    if isinstance(value, Real):
        yield path, float(value)
    elif isinstance(value, str | bytes):
        return
    elif (inside := _inside(value)) is not None:
        texts = [
            x for n in _NAMES if isinstance(x := inside.get(n), list | tuple) and all(isinstance(w, str) for w in x)
        ]
        names = next((tuple(x) for x in texts if x), called)
        for name, x in inside.items():
            if name not in ("header", "stamp"):
                yield from _fields(f"{path}.{name}" if path else name, x, names)
    elif isinstance(value, list | tuple | np.ndarray) and len(value) <= _LONGEST:
        before, _, last = path.rpartition(".")
        if len(called) == len(value):
            for name, x in zip(called, value, strict=True):
                yield from _fields(f"{before}.{name}.{last}" if before else f"{name}.{last}", _plain(x), ())
        else:
            for i, x in enumerate(value):
                yield from _fields(f"{path}[{i}]", _plain(x), called)


def _plain(x: object) -> object:
    return x.item() if isinstance(x, np.generic) else x


def opened_mcap(path: Path) -> Source:
    """An MCAP file: ROS 2 messages (cdr) and JSON.

    Raises:
        MissingExtra: the library ``mcap`` is not installed.
        InputError: it cannot be read, or holds no such messages.
    """
    with needed("reading MCAP files"):
        from mcap.exceptions import McapError
        from mcap.reader import NonSeekingReader
        from mcap_ros2.decoder import DecoderFactory
    others: dict[str, str] = {}
    notes: list[str] = []

    def messages() -> Iterator[tuple[str, int, object]]:
        factory, count = DecoderFactory(), 0
        reader = NonSeekingReader(file).iter_messages(log_time_order=False)  # needs no index; a truncated file has none
        while True:
            try:
                schema, channel, message = next(reader)
            except StopIteration:
                return
            except (McapError, struct.error) as error:  # a truncated file; the class depends on mcap's version
                if not count:
                    raise
                notes.append(f"{path.name}: ends in the middle of a message after {count}: was it cut short? ({error})")
                return
            count += 1
            decode = factory.decoder_for(channel.message_encoding, schema)
            if decode is None and channel.message_encoding == "json":
                decode = json.loads
            if decode is None:
                others[channel.topic] = channel.message_encoding or "none"
            else:
                yield channel.topic, message.log_time, decode(message.data)

    try:
        with path.open("rb") as file:
            source = BagSource(path, messages())
            source.notes = notes
            return source
    except InputError as error:
        if not others:
            raise
        encodings = ", ".join(f"{topic} ({kind})" for topic, kind in others.items())
        raise InputError(f"{error}; not read, as neither cdr nor json: {encodings}") from None
    except (McapError, struct.error, ValueError, RecursionError) as error:
        raise InputError(f"{arg('data')}: '{path}': cannot be read as MCAP: {error or type(error).__name__}") from None


def opened_rosbag(path: Path) -> Source:
    """A rosbag: a file ``.bag`` of ROS 1, or the folder of one of ROS 2.

    Raises:
        MissingExtra: the library ``rosbags`` is not installed.
        InputError: it cannot be read.
    """
    with needed("reading rosbags"):
        from rosbags.highlevel import AnyReader, AnyReaderError
        from rosbags.interfaces import ConnectionExtRosbag2
        from rosbags.typesys import Stores, get_typestore
    stores = get_typestore(Stores.ROS2_JAZZY)  # for bags without type definitions
    try:
        with AnyReader([path], default_typestore=stores) as bag:
            known = [
                c for c in bag.connections
                if not isinstance(c.ext, ConnectionExtRosbag2) or c.msgtype in bag.typestore.fielddefs
            ]  # fmt: skip
            return BagSource(
                path,
                (
                    (c.topic, logged, bag.deserialize(raw, c.msgtype))
                    for c, logged, raw in bag.messages(connections=known)
                ),
            )
    except AnyReaderError as error:
        raise InputError(f"{arg('data')}: '{path}': cannot be read as a rosbag: {error}") from None
