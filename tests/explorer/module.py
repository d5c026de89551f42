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
        self.top, numbers = law["shape"]["end"], np.array(law["shape"]["numbers"], np.int32)
        self.memory.write(self.store, numbers.tobytes(), self.exports["shape"].value(self.store))

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
        values = {".".join(key): x for key, x in scenario.elements.values.items()}
        return self.put([values[name] for name in self.law["parameters"]])

    def run(self, scenario):
        """The columns of a scenario, by name."""
        n, pieces, p = len(self.law["states"]), scenario.pieces, self.values(scenario)
        setup = self.room(8 * (n + 2))
        self.call("system_setup", p, scenario.solve.rtol, setup)
        result = self.read(setup, n + 2)
        out, room = self.room(8 * scenario.rows * n), 4096
        run = self.put(np.zeros(self.layout["_size"][0], np.int8), np.int8)
        start, rows = self.put(pieces.start), self.put(pieces.rows)
        one = self.put([0.0])
        start_values = [scenario.initial.get(s, 0.0) for s in self.law["states"]]
        fields = {
            "parameters": p, "x": self.put(start_values), "atol": self.put(result[:n]),
            "fixed_atol": self.put(np.zeros(n)), "atol_now": self.put(np.zeros(n)),
            "piece_start": start, "piece_rows": rows, "out": out, "event_time": self.put(np.zeros(room)),
            "thresholds": self.put([*scenario.elements.thresholds(), 0.0]),
            "held": one, "memory": one, "queue": one, "noise": one,
            "piece_restart": self.put(pieces.restart, np.int8), "event_what": self.put(np.zeros(room, np.int32), np.int32),
            "sampled": one, "acted": one, "rtol": result[n] * scenario.solve.rtol, "step": scenario.output.step,
            "h": np.inf, "h_smallest": np.inf, "h_limit": result[n + 1], "queue_room": 1, "pieces": len(pieces.start),
            "rows": scenario.rows, "event_room": room, "t_end": scenario.end, "restart": 1, "attempts_left": 10**7,
        }  # fmt: skip
        for name, value in fields.items():
            self.set(run, name, value)
        assert self.call("stribeck_advance", run) == 0
        return self.columns(p, scenario.rows, scenario.output.step, pieces.start, rows, out, n)

    def columns(self, p, count, step, start, piece_rows, out, width):
        """Every column, row by row, as the page's table() makes them."""
        names = [c["name"] for c in self.law["columns"]]
        values, n = self.room(8 * count * len(names)), 0
        for i in range(count):
            while n + 1 < len(start) and start[n + 1] <= i * step * (1 + 1e-12):
                n += 1
            piece = piece_rows + 8 * n * self.law["shape"]["numbers"][1]
            self.call("system_columns", p, piece, i * step, out + 8 * i * width, values + 8 * i * len(names))
        cells = self.read(values, count * len(names)).reshape(count, len(names))
        return {name: cells[:, i] for i, name in enumerate(names)}


class MachineModule(Module):
    """The module of a machine's page, given the arrays that the page makes of its data."""

    def __init__(self, data):
        (law,) = data["laws"].values()
        super().__init__(law, data["layout"])
        self.data = data

    def run_machine(self, values):
        """The columns with some numbers turned, by name."""
        given, numbers = self.data["machine"], {n["path"]: n for n in self.data["numbers"]}
        arrays = {name: np.array(x, float) for name, x in given["arrays"].items()}
        for path, value in values.items():
            for name, i, rate in numbers[path]["effects"]:
                arrays[name][i] += rate * (value - numbers[path]["value"])
        rtol, rate, rooms = arrays.pop("rtol")[0], arrays.pop("least_rate")[0], given["rooms"]
        end, step = (numbers[path]["value"] for path in ("solve.t_end", "output.step"))
        rows, width = int(end / step + 1e-9) + 1, len(self.law["states"]) + rooms["held"] + rooms["shown"]
        place, room = {name: self.put(x) for name, x in arrays.items()}, 4096
        held, out = self.call("system_relations", place["parameters"], self.room(800)), self.room(8 * rows * width)
        assert held is None
        run = self.put(np.zeros(self.layout["_size"][0], np.int8), np.int8)
        zeros = np.zeros(max(rooms["held"], 1))
        fields = {
            **place, "out": out, "event_time": self.put(np.zeros(room)),
            "event_what": self.put(np.zeros(room, np.int32), np.int32),
            "piece_restart": self.put(given["restart"], np.int8), "sampled": self.put(zeros), "acted": self.put(zeros),
            "rtol": rtol, "h": np.inf, "h_smallest": np.inf, "h_limit": 1 / rate if rate else np.inf, "step": step,
            "queue_room": rooms["queue_room"], "noise_room": rooms["noise_room"], "pieces": len(given["restart"]), "rows": rows,
            "event_room": room, "t_end": max(end, (rows - 1) * step), "restart": 1, "attempts_left": 10**7,
        }  # fmt: skip
        for name, value in fields.items():
            self.set(run, name, value)
        assert self.call("stribeck_advance", run) == 0
        start = self.read(place["piece_start"], len(given["restart"]))
        return self.columns(place["parameters"], rows, step, start, place["piece_rows"], out, width)
