"""A module of a page run without a browser, by wasmtime: what the page's worker does, in Python."""

import gzip
import struct
from base64 import b64decode

import numpy as np
import wasmtime


class Module:
    """A law's module, and memory behind its own."""

    def __init__(self, law, layout):
        self.store = wasmtime.Store()
        module = wasmtime.Module(self.store.engine, gzip.decompress(b64decode(law["wasm"])))
        self.imports = [each.name for each in module.imports]
        self.exports = wasmtime.Instance(self.store, module, []).exports(self.store)
        self.memory, self.law, self.layout = self.exports["memory"], law, layout
        self.top = self.exports["__heap_base"].value(self.store)

    def call(self, name, *arguments):
        return self.exports[name](self.store, *arguments)

    def room(self, size):
        at = -(-self.top // 16) * 16
        self.top = at + size
        missing = self.top - self.memory.data_len(self.store)
        if missing > 0:
            self.memory.grow(self.store, -(-missing // 65536))
        return at

    def put(self, values, kind=np.float64):
        content = np.asarray(values, kind).tobytes()
        at = self.room(max(len(content), 8))
        self.memory.write(self.store, content, at)
        return at

    def read(self, at, count, kind=np.float64):
        return np.frombuffer(self.memory.read(self.store, at, at + count * np.dtype(kind).itemsize), kind)

    def set(self, at, name, value):
        offset, kind = self.layout[name]
        content = struct.pack({"pointer": "<I", "double": "<d", "integer": "<q"}[kind], value)
        self.memory.write(self.store, content, at + offset)

    def get(self, at, name):
        offset, kind = self.layout[name]
        return struct.unpack(
            {"double": "<d", "integer": "<q"}[kind], self.memory.read(self.store, at + offset, at + offset + 8)
        )[0]

    def values(self, scenario):
        values = {".".join(key): x for key, x in scenario.values().items()}
        return self.put([values[name] for name in self.law["parameters"]])

    def run(self, scenario):
        """The columns of a scenario, by name."""
        n, pieces, p = len(self.law["states"]), scenario.pieces(), self.values(scenario)
        setup = self.room(8 * (n + 2))
        self.call("stribeck_setup", p, scenario.solve.rtol, setup)
        found = self.read(setup, n + 2)
        out, room = self.room(8 * scenario.rows * n), 4096
        run = self.put(np.zeros(self.layout["_size"][0], np.int8), np.int8)
        start, rows = self.put(pieces.start), self.put(pieces.rows)
        one = self.put([0.0])
        start_values = [scenario.initial.get(s, 0.0) for s in self.law["states"]]
        fields = {
            "parameters": p, "atol": self.put(found[:n]), "x": self.put(start_values),
            "piece_start": start, "piece_rows": rows, "out": out, "event_time": self.put(np.zeros(room)),
            "thresholds": self.put([*scenario.thresholds(), 0.0]), "held": one, "memory": one, "queue": one, "noise": one,
            "piece_restart": self.put(pieces.restart, np.int8), "event_what": self.put(np.zeros(room, np.int32), np.int32),
            "sampled": one, "acted": one, "rtol": found[n] * scenario.solve.rtol, "step": scenario.output.step,
            "h": np.inf, "h_smallest": np.inf, "h_limit": found[n + 1], "queue_room": 1, "pieces": len(pieces.start),
            "rows": scenario.rows, "event_room": room, "t_end": scenario.end, "restart": 1, "attempts_left": 10**7,
        }  # fmt: skip
        for name, value in fields.items():
            self.set(run, name, value)
        assert self.call("stribeck_advance", run) == 0
        columns = self.law["columns"]
        table = self.room(8 * scenario.rows * len(columns))
        self.call("stribeck_table", p, scenario.rows, scenario.output.step, len(pieces.start), start, rows, out, table)
        cells = self.read(table, scenario.rows * len(columns)).reshape(scenario.rows, len(columns))
        return {c["name"]: cells[:, i] for i, c in enumerate(columns)}
