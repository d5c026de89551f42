"""A solver for machine files on equations written from shared/design/machine.md alone: every law, element and sample.

Nothing of stribeck is used, so that a mistake in its equations, code or solver cannot stand on both sides. The equations
of a machine are put together as vectors: an element that sees d = ratio y_from - y_to adds its force times the vector b of
its direction; ties, driven bodies and the power that goes in are read off from that vector. SciPy integrates from one
breakpoint, sample or output to the next.
"""

from math import copysign, cos, floor, inf, pi, sin

import numpy as np
from scipy.integrate import odeint, solve_ivp
from scipy.linalg import expm
from scipy.optimize import brentq

from tests.reference.apart_parts import STATIC, Signal, constants, friction, steady

# -- the machine -----------------------------------------------------------------------------------------------------


class Apart:
    """The equations of one file."""

    def __init__(self, data):
        self.data = data
        for n in ("bodies", "links", "contacts", "loads", "motors", "controllers"):
            setattr(self, n, data.get(n, {}))
        self.t_end, self.step = data["solve"]["t_end"], data["output"]["step"]
        self.led = {}  # body: (leader, how far it moves by it)
        for n in self.bodies:
            at, by = n, 1.0
            while "tied_to" in self.bodies[at]:
                by *= self.bodies[at].get("ratio", 1.0)
                at = self.bodies[at]["tied_to"]
            self.led[n] = at, by
        self.leaders = [n for n, b in self.bodies.items() if "tied_to" not in b]
        self.free = [n for n in self.leaders if "velocity" not in self.bodies[n]]
        self.mass = dict.fromkeys(self.leaders, 0.0)
        for n, b in self.bodies.items():
            leader, by = self.led[n]
            self.mass[leader] += by * by * (b.get("mass", 0.0) + b.get("inertia", 0.0))
        self.sampled = [n for n, c in self.controllers.items() if "sampling" in c]
        self.names = [f"{n}.y" for n in self.leaders] + [f"{n}.v" for n in self.free]
        self.names += [f"{n}.z" for n, c in self.contacts.items() if c["law"]["name"] not in STATIC]
        self.names += [f"{n}.i" for n, m in self.motors.items() if "L" in m]
        self.names += [f"{n}.{x}" for n in self.controllers if n not in self.sampled for x in ("I", "zh")]
        self.names += ["E_in", "E_dissipated"]
        self.place = {n: i for i, n in enumerate(self.names)}
        self.signals, self.breaks = {}, set()
        for place, table, turns in self._tables():
            self.signals[place] = signal = Signal(table)
            cuts = signal.knots + (signal.turns(self.t_end) if turns else [])
            if signal.kind == "spline":
                cuts = [*cuts, *(float(x) for x in signal.poly.x)]
            self.breaks |= {t for t in cuts if 0 < t < self.t_end}
        self.held = dict.fromkeys(self.sampled, 0.0)
        self.begin(0.0)

    def _tables(self):
        for n, b in self.bodies.items():
            if "velocity" in b:
                yield n, b["velocity"]["signal"], False
        for n, link in self.links.items():
            if not isinstance(link["from"], str):
                yield n, link["from"]["signal"], False
        for n, c in self.contacts.items():
            for of, f in c.get("factors", {}).items():
                if "signal" in f:
                    yield (n, of), f["signal"], False
        for group in (self.loads, self.motors, self.controllers):
            for n, x in group.items():
                if "signal" in x:
                    yield n, x["signal"], x.get("compensation", {}).get("speed") == "reference"

    def columns(self):
        """The names of the columns after t, in the order of machine.md."""
        parts = ((self.bodies, "yv"), (self.contacts, "zFw"), (self.links, "f"), (self.loads, "f"),
                 (self.motors, ("i", "V", "torque")), (self.controllers, "ru"))  # fmt: skip
        return [f"{n}.{x}" for group, what in parts for n in group for x in what] + ["E_in", "E_stored", "E_dissipated"]

    def begin(self, now):
        """The pieces that have begun by ``now``."""
        self.now = {place: signal.piece(now) for place, signal in self.signals.items()}

    def direction(self, n, x, t, y, v):
        """d and w of an element; and what its force is multiplied by at each body."""
        ratio = x.get("ratio", 1.0)
        if isinstance(x["from"], str):
            b, d, w = [(x["from"], -ratio)], ratio * y[x["from"]], ratio * v[x["from"]]
        else:
            r, dr, _ = self.now[n](t)
            b, d, w = [], ratio * r, ratio * dr
        if (to := x.get("to", "ground")) != "ground":
            b, d, w = [*b, (to, 1.0)], d - y[to], w - v[to]
        return d, w, b

    def all(self, t, x):
        """Every column, the rates of the states, and what events are told by."""
        s, k, rate = dict(zip(self.names, x, strict=True)), {}, {}
        y, v, force = {}, {}, dict.fromkeys(self.bodies, 0.0)
        for n in self.bodies:
            leader, by = self.led[n]
            y[n] = by * s[leader + ".y"]
            v[n] = by * (s[leader + ".v"] if leader in self.free else self.now[leader](t)[0])
            k[n + ".y"], k[n + ".v"] = y[n], v[n]
        e_in = lost = 0.0
        stored = sum(
            (b.get("mass", 0.0) + b.get("inertia", 0.0)) * v[n] ** 2 / 2
            for n, b in self.bodies.items() if self.led[n][0] in self.free
        )  # fmt: skip
        pull, watch = {}, {}
        for n, load in self.loads.items():
            at = load["on"]
            if load["kind"] == "pendulum":
                angle = y[at] + load.get("phase", 0.0)
                f = -load["amplitude"] * sin(angle)
                stored += load["amplitude"] * (1 - cos(angle))
            else:
                f = self.now[n](t)[0] if load["kind"] == "signal" else waves(load, y[at])
                e_in += f * v[at]
            force[at] += f
            pull[n] = k[n + ".f"] = f
        self.far = 0.0
        for n, link in self.links.items():
            d, w, b = self.direction(n, link, t, y, v)
            half = link.get("gap", 0.0) / 2
            e = d - min(max(d, -half), half)
            spring, damper = link["stiffness"] * e, link.get("damping", 0.0) * w
            if half:
                damper = min(max(damper, -abs(spring)), abs(spring))
                watch[n] = d, half, ("flank_up", "flank_up_left", "flank_down", "flank_down_left")
            pull[n] = k[n + ".f"] = f = spring + damper
            stored += link["stiffness"] * e * e / 2
            lost += damper * w
            for body, by in b:
                force[body] += by * f
            if not isinstance(link["from"], str):
                e_in += f * link.get("ratio", 1.0) * self.now[n](t)[1]
                self.far += link["stiffness"] * e * e / 2
        for n, c in self.controllers.items():
            if n in self.held:
                u = self.held[n]
            else:
                at = self.measured(c)
                raw, further, rates = self.law(c, t, self.now[n](t), y[at], v[at], s[n + ".I"], s[n + ".zh"])
                limit = c.get("limit", inf)
                if abs(raw) > limit and further * raw > 0:
                    rates[0] *= min(max(1 - (abs(raw) - limit) / (1e-7 * limit), 0.0), 1.0)
                rate[n + ".I"], rate[n + ".zh"] = rates
                u = min(max(raw, -limit), limit)
                if limit < inf:
                    watch[n] = raw, limit * (1 - 1e-6), ("limit_reached", "limit_left") * 2
            k[n + ".r"], k[n + ".u"] = self.now[n](t)[0], u
            if c["on"] in self.bodies:
                force[c["on"]] += u
                e_in += u * v[c["on"]]
        for n, m in self.motors.items():
            i, V, di = self.motor(n, m, t, v[m["on"]], s.get(n + ".i"), k)
            k[n + ".i"], k[n + ".V"], k[n + ".torque"] = i, V, m["K"] * i
            rate[n + ".i"] = di
            pull[n] = m["K"] * i
            force[m["on"]] += m["K"] * i
            e_in += m["K"] * i * v[m["on"]]
        for n, contact in self.contacts.items():
            d, w, b = self.direction(n, contact, t, y, v)
            law, c = contact["law"]["name"], self.now_constants(n, contact, d, t, pull)
            z = s.get(n + ".z", 0.0)
            dz, F = friction(law, c, w, z)
            k[n + ".z"], k[n + ".F"], k[n + ".w"] = z, F, w
            rate[n + ".z"] = dz
            stiff = c.get("sigma_0", 0.0) if law not in STATIC else 0.0
            stored += stiff * z * z / 2
            lost += F * w - stiff * z * dz
            for body, by in b:
                force[body] += by * F
            if level := constants(contact["law"]).get("v_s", 0.0):
                watch[n] = w, level, ("slip", "stick") * 2
        total = dict.fromkeys(self.leaders, 0.0)
        for n, f in force.items():
            leader, by = self.led[n]
            total[leader] += by * f
        for n in self.leaders:
            rate[n + ".y"] = v[n]
            if n in self.free:
                rate[n + ".v"] = total[n] / self.mass[n]
            else:
                e_in -= total[n] * v[n]
        rate["E_in"], rate["E_dissipated"] = e_in, lost
        k |= {"E_in": s["E_in"], "E_stored": stored, "E_dissipated": s["E_dissipated"]}
        return k, [rate[n] for n in self.names], watch

    def now_constants(self, n, contact, d, t, pull):
        c = dict(constants(contact["law"]))
        level = 1.0
        for of, f in contact.get("factors", {}).items():
            by = self.now[n, of](t)[0] if "signal" in f else 1 + waves(f, d)
            if of == "level":
                level = by
            else:
                c[of] = c[of] * by
        for load in contact.get("loads", ()):
            source = {load["force"]: 1.0} if isinstance(load["force"], str) else load["force"]
            f = abs(sum(weight * pull[name] for name, weight in source.items()))
            for name in ("F_c", "F_s"):
                if name in c:
                    c[name] += load.get(name, 0.0) * f
        for name in ("F_c", "F_s"):
            if name in c:
                c[name] *= level
        return c

    def measured(self, c):
        return c.get("measures") or (c["on"] if c["on"] in self.bodies else self.motors[c["on"]]["on"])

    def law(self, c, t, reference, y, v, integral, zh):
        """The output without its limit; dI/dt times its gain; the rates of I and z_hat."""
        r, dr, ddr = reference
        if c["kind"] == "pid":
            rate, gain = y - r, -c.get("K_i", 0.0)
            u = -c["K_p"] * (y - r) + gain * integral - c.get("K_d", 0.0) * v
        else:
            rate = c["K_p"] * (r - y) + dr - v
            gain = c["K_v"] / c["T_i"] if "T_i" in c else 0.0
            u = c["K_v"] * rate + gain * integral
        if "feedforward" in c:
            u += c["feedforward"]["inertia"] * ddr
        dzh = 0.0
        if "compensation" in c:
            own = c["compensation"]
            table = own.get("law") or self.contacts[own["contact"]]["law"]
            if own["speed"] == "reference":
                F = steady(table["name"], constants(table), dr) if abs(dr) > 1e-12 else self._at_rest(table, dr)
            else:
                dzh, F = friction(table["name"], constants(table), v, zh)
            u += own.get("share", 1.0) * F
        if "dither" in c:
            turns = c["dither"]["frequency"] * t
            square = 1.0 if (turns + 1e-9) % 1 < 0.5 else -1.0
            u += c["dither"]["amplitude"] * (square if c["dither"].get("kind") == "square" else sin(2 * pi * turns))
        return u, gain * rate, [rate, dzh]

    @staticmethod
    def _at_rest(table, dr):
        return copysign(steady(table["name"], constants(table), 1e-12), dr) if dr else 0.0

    def motor(self, n, m, t, v, i, k):
        top, K, R = m.get("voltage", inf), m["K"], m["R"]
        by = [c for c, x in self.controllers.items() if x["on"] == n]
        want = k[by[0] + ".u"] / K if by else None
        if "L" in m:
            V = (
                self.now[n](t)[0]
                if want is None
                else R * want + K * v + m["L"] * (want - i) / m.get("current_time", 1e-3)
            )
            V = min(max(V, -top), top)
            return i, V, (V - R * i - K * v) / m["L"]
        if want is None:
            V = min(max(self.now[n](t)[0], -top), top)
            return (V - K * v) / R, V, 0.0
        i = min(max(want, (-top - K * v) / R), (top - K * v) / R)
        return i, R * i + K * v, 0.0


def waves(table, x):
    phases = table.get("phase") or [0.0] * len(table["waves"])
    return sum(a * sin(w * x + p) for a, w, p in zip(table["amplitude"], table["waves"], phases, strict=True))


class Sampler:
    """A controller that samples."""

    def __init__(self, machine, name):
        self.m, self.name, self.c = machine, name, machine.controllers[name]
        s = self.c["sampling"]
        self.T, self.delay = s["period"], s.get("delay", 0.0)
        self.k, self.I, self.zh, self.last, self.filter = 0, 0.0, 0.0, None, None
        count = int(machine.t_end / self.T) + 3
        self.noise = s.get("noise", 0.0) * np.random.default_rng(s.get("seed", 0)).standard_normal(count)

    def sample(self, x):
        m, c, s = self.m, self.c, self.c["sampling"]
        t = self.k * self.T
        y = m.all(t, x)[0][m.measured(c) + ".y"] + self.noise[self.k]
        if s.get("resolution"):
            self.margin = abs(y / s["resolution"] % 1 - 0.5)
            y = floor(y / s["resolution"] + 0.5) * s["resolution"]
        if self.last is None:
            self.last, self.filter = y, np.array([y, 0.0])
        v = (y - self.last) / self.T
        self.last = y
        if (w := s.get("bandwidth")) is not None:
            v = self.filter[1]
            A = np.array([[0.0, 1.0], [-w * w, -2 * w]])
            self.filter = np.array([y, 0.0]) + expm(A * self.T) @ (self.filter - [y, 0.0])
        u, further, (rate, _) = m.law(c, t, m.now[self.name](t), y, v, self.I, self.zh)
        limit = c.get("limit", inf)
        if not (abs(u) > limit and further * u > 0):
            self.I += self.T * rate
        if c.get("compensation", {}).get("speed") == "measured":
            table = c["compensation"].get("law") or m.contacts[c["compensation"]["contact"]]["law"]
            own = constants(table)
            rate = lambda t, z: [friction(table["name"], own, v, z[0])[0]]  # noqa: E731
            solution = solve_ivp(rate, (0, self.T), [self.zh], "LSODA", rtol=1e-11, atol=1e-16)
            self.zh = float(solution.y[0, -1])
        self.k += 1
        return min(max(u, -limit), limit)


def solve(data, rtol=1e-10):
    """The columns at the file's rows."""
    return solve_with_events(data, 0, rtol)[0]


def solve_with_events(data, fine, rtol=1e-10, method="odeint"):
    """The columns at the file's rows, and the events by element and kind (with ``fine`` points in each row's step)."""
    m = Apart(data)
    count = floor(m.t_end / m.step * (1 + 1e-12))
    rows = np.arange(count + 1) * m.step
    grid = np.arange(count * max(fine, 1) + 1) * (m.step / max(fine, 1))
    samplers = [Sampler(m, n) for n in m.sampled]
    calls = [(k * s.T, 1, s) for s in samplers for k in range(int(m.t_end / s.T * (1 + 1e-12)) + 1)]
    acts = [(t + s.delay, 0, s) for t, _, s in calls if t + s.delay <= m.t_end]
    edges = sorted({0.0, m.t_end, *m.breaks, *(t for t, *_ in calls), *(t for t, *_ in acts)})
    edges = [t for t, after in zip(edges, [*edges[1:], inf], strict=True) if after - t > 1e-11 * max(t, 1e-3)]
    x = np.zeros(len(m.names))
    for n in m.leaders:
        for name, value in m.bodies[n].get("initial", {}).items():
            x[m.place[f"{n}.{name}"]] = value
    queue, table, course, size = {s.name: [] for s in samplers}, {}, [], np.maximum(np.abs(x), 1e-10)
    near = lambda a, b: abs(a - b) <= 2e-11 * max(abs(b), 1e-3)  # noqa: E731
    i = 0
    for j, t in enumerate(edges):
        before = m.all(t, x) and m.far
        m.begin(t)
        m.all(t, x)
        x[m.place["E_in"]] += m.far - before if j else 0.0
        for s in samplers:
            if near(s.k * s.T, t):
                queue[s.name].append((s.k * s.T + s.delay, s.sample(x)))
        for n, waiting in queue.items():
            while waiting and (waiting[0][0] < t or near(waiting[0][0], t)):
                m.held[n] = waiting.pop(0)[1]
        course.append((t, m.all(t, x)[2]))
        end = edges[j + 1] if j + 1 < len(edges) else None
        inside = []
        while i < len(grid) and (end is None or (grid[i] < end and not near(grid[i], end))):
            inside.append(grid[i])
            i += 1
        if end is None:
            states, times = [x] * len(inside), inside
        else:
            times = [u for u in inside if u > t and not near(u, t)]
            all_rates = lambda t, x: m.all(t, x)[1]  # noqa: E731
            wanted = [t, *times, end]
            if method == "odeint":
                result, info = odeint(
                    all_rates, x, wanted, tfirst=True, rtol=rtol, atol=rtol * 1e-2 * size, mxstep=10**6,
                    tcrit=[end], full_output=True,
                )  # fmt: skip
                assert info["message"] == "Integration successful.", info["message"]
            else:
                done = solve_ivp(all_rates, (t, end), x, method, wanted, rtol=rtol, atol=rtol * 1e-2 * size)
                assert done.success, done.message
                result = done.y.T
            states = ([x] if len(inside) > len(times) else []) + list(result[1:-1])
            times, size = inside, np.maximum(size, np.abs(result).max(axis=0))
        for u, state in zip(times, states, strict=True):
            columns, _, watch = m.all(u, state)
            course.append((u, watch))
            row = round(u / m.step)
            if near(rows[min(row, count)], u):
                table[min(row, count)] = columns
        if end is not None:
            x = result[-1]
            course.append((end, m.all(end, x)[2]))
    assert sorted(table) == list(range(len(rows)))
    columns = {n: np.array([table[i][n] for i in range(len(rows))]) for n in m.columns()}
    return {"t": rows, **columns}, events(course) if fine else {}


def events(course):
    """Where a watched quantity passes its level, from what it was at close times."""
    result = {n: {kind: [] for kind in dict.fromkeys(kinds)} for n, (_, _, kinds) in course[0][1].items()}
    t = np.array([u for u, _ in course])
    for n in result:
        q = np.array([watch[n][0] for _, watch in course])
        level, kinds = course[0][1][n][1:]
        for sign, (rise, fall) in ((1, kinds[:2]), (-1, kinds[2:])):
            above = sign * q > level
            for i in np.flatnonzero(above[1:] != above[:-1]):
                if t[i + 1] == t[i]:
                    at = t[i]
                else:  # three close points before and after, as far as no jump lies between
                    low, high = i, i + 1
                    while low > 0 and i - low < 2 and t[low - 1] < t[low]:
                        low -= 1
                    while high < len(t) - 1 and high - i < 3 and t[high + 1] > t[high]:
                        high += 1
                    span = slice(low, high + 1)
                    poly = np.polynomial.Polynomial.fit(t[span], sign * q[span] - level, high - low)
                    a, b = poly(t[i]), poly(t[i + 1])
                    at = brentq(poly, t[i], t[i + 1]) if a * b < 0 else t[i + (abs(b) < abs(a))]
                result[n][rise if above[i + 1] else fall].append(at)
    return {n: {kind: sorted(times) for kind, times in kinds.items()} for n, kinds in result.items()}
