"""A second solver for machines, on equations written anew: plain floats, SciPy's LSODA from one instant to the next.

Nothing of stribeck is used here but the data of the file, so that a mistake in its equations, code or solver cannot stand
on both sides.
"""

from bisect import bisect_right
from collections import deque
from math import copysign, cos, exp, pi, sin

import numpy as np
from scipy.integrate import odeint

from tests.simulation.independent import friction

NAMES = ("bodies", "links", "contacts", "loads", "motors", "controllers")


class Signal:
    """Value, rate and second derivative; ``breaks`` are the times at which it changes its equation."""

    def __init__(self, table, turns=False, t_end=0.0):
        self.table, kind = table, table["kind"]
        if kind == "step":
            self.t, self.value = [table["time"]] * 2, [0.0, table["value"]]
        elif kind in ("points", "point_to_point"):
            self.t, self.value = table["t"], table["value"]
        else:
            self.t, self.value = [], []
        self.breaks = sorted(set(self.t))
        if turns and kind == "sine":
            f, phase = table["frequency"], table.get("phase", 0.0)
            self.breaks = [((n + 0.5) * pi - phase) / (2 * pi * f) for n in range(-8, int(2 * f * t_end) + 9)]

    def at(self, t, now):
        """(r, dr/dt, d2r/dt2) in the piece that has begun at ``now``."""
        table = self.table
        if table["kind"] == "ramp":
            return table["rate"] * t, table["rate"], 0.0
        if table["kind"] == "sine":
            w, a = 2 * pi * table["frequency"], table["amplitude"]
            x = w * t + table.get("phase", 0.0)
            return table.get("offset", 0.0) + a * sin(x), a * w * cos(x), -a * w * w * sin(x)
        i = bisect_right(self.t, now + 1e-12 * abs(now)) - 1
        if i < 0 or i + 1 >= len(self.t):
            return self.value[max(i, 0)] if i + 1 < len(self.t) or i < 0 else self.value[-1], 0.0, 0.0
        t0, t1, a, b = self.t[i], self.t[i + 1], self.value[i], self.value[i + 1]
        s, h = (t - t0) / (t1 - t0), t1 - t0
        if table["kind"] == "points":
            return a + (b - a) * s, (b - a) / h, 0.0
        move = s**4 * (35 + s * (-84 + s * (70 - 20 * s)))
        rate = 140 * s**3 * (1 - s) ** 3
        return a + (b - a) * move, (b - a) * rate / h, (b - a) * 420 * s**2 * (1 - s) ** 2 * (1 - 2 * s) / h**2


def constants(law):
    own = {k: v for k, v in law.items() if k not in ("name", "parameters")}
    return {**law["parameters"], **own}


def steady_level(p, v):
    """sigma_0 g: F_c + (F_s - F_c) exp(-(v/v_s)^2)."""
    return p["F_c"] + (p["F_s"] - p["F_c"]) * exp(-min((v / p["v_s"]) ** 2, 700.0))


def waves(table, x):
    return sum(a * sin(w * x + q) for a, w, q in zip(table["amplitude"], table["waves"], table["phase"], strict=True))


class Machine:
    """The equations of machine.md, sections 2 to 4, for the tables of a file."""

    def __init__(self, data):
        self.data = data
        for name in NAMES:
            setattr(self, name, data.get(name, {}))
        self.t_end = data["solve"]["t_end"]
        self.signals = {}
        self.free = [n for n, b in self.bodies.items() if "velocity" not in b and "tied_to" not in b]
        self.driven = [n for n, b in self.bodies.items() if "velocity" in b]
        self.states = [f"{n}.y" for n in (*self.free, *self.driven)] + [f"{n}.v" for n in self.free]
        self.states += [f"{n}.z" for n in self.contacts] + [f"{n}.i" for n, m in self.motors.items() if "L" in m]
        self.sampled = [n for n, c in self.controllers.items() if "sampling" in c]
        for n in self.controllers:
            if n not in self.sampled:
                self.states += [f"{n}.I", f"{n}.z_hat"]
        self.states += ["E_in", "E_dissipated"]
        self.held = dict.fromkeys(self.sampled, 0.0)
        self.now = 0.0
        for place, table in self._signal_tables():
            turns = place in self.controllers and "compensation" in self.controllers[place]
            self.signals[place] = Signal(table, turns, self.t_end)

    def _signal_tables(self):
        for n, b in self.bodies.items():
            if "velocity" in b:
                yield n, b["velocity"]["signal"]
        for n, x in self.links.items():
            if isinstance(x["from"], dict):
                yield n, x["from"]["signal"]
        for n, c in self.contacts.items():
            for of, f in c.get("factors", {}).items():
                if "signal" in f:
                    yield (n, of), f["signal"]
        for group in (self.loads, self.motors, self.controllers):
            for n, x in group.items():
                if "signal" in x:
                    yield n, x["signal"]

    def ratio(self, name):
        total = 1.0
        while "tied_to" in self.bodies[name]:
            total *= self.bodies[name].get("ratio", 1.0)
            name = self.bodies[name]["tied_to"]
        return name, total

    def span(self, table, y, v, t):
        ratio, start, end = table.get("ratio", 1.0), table["from"], table.get("to", "ground")
        if isinstance(start, dict):
            r, dr, _ = self.signals[self._of(table)].at(t, self.now)
            d, w = ratio * r, ratio * dr
        else:
            d, w = ratio * y[start], ratio * v[start]
        return (d, w) if end == "ground" else (d - y[end], w - v[end])

    def _of(self, table):
        return next(n for n, x in self.links.items() if x is table)

    def quantities(self, t, x):
        """Every column, and the rates of the states."""
        s = dict(zip(self.states, x, strict=True))
        k, rates, net, y, v = dict(s), {}, dict.fromkeys(self.bodies, 0.0), {}, {}
        for n in self.bodies:
            leader, ratio = self.ratio(n)
            y[n] = ratio * s[f"{leader}.y"]
            v[n] = ratio * (s[f"{leader}.v"] if leader in self.free else self.signals[leader].at(t, self.now)[0])
            k[f"{n}.y"], k[f"{n}.v"] = y[n], v[n]
        power, lost, stored, forces = 0.0, 0.0, 0.0, {}
        for n, load in self.loads.items():
            if load["kind"] == "pendulum":
                angle = y[load["on"]] + load.get("phase", 0.0)
                f = -load["amplitude"] * sin(angle)
                stored += load["amplitude"] * (1 - cos(angle))
            else:
                f = self.signals[n].at(t, self.now)[0] if load["kind"] == "signal" else waves(load, y[load["on"]])
                power += f * v[load["on"]]
            net[load["on"]] += f
            forces[n] = k[f"{n}.f"] = f
        for n, link in self.links.items():
            d, w = self.span(link, y, v, t)
            half = link.get("gap", 0.0) / 2
            e = d - min(max(d, -half), half)
            f_c, f_d = link["stiffness"] * e, link.get("damping", 0.0) * w
            if half:
                f_d = min(max(f_d, -abs(f_c)), abs(f_c))
            forces[n] = k[f"{n}.f"] = f_c + f_d
            stored += link["stiffness"] * e * e / 2
            lost += f_d * w
            power += self.act(link, net, f_c + f_d, t)
        for n, c in self.controllers.items():
            u = self.controller(n, c, t, y, v, s, rates)
            k[f"{n}.r"], k[f"{n}.u"] = self.signals[n].at(t, self.now)[0], u
            if c["on"] in self.bodies:
                net[c["on"]] += u
                power += u * v[c["on"]]
        for n, m in self.motors.items():
            forces[n] = self.motor(n, m, t, v, s, k, rates)
            net[m["on"]] += forces[n]
            power += forces[n] * v[m["on"]]
        for n, c in self.contacts.items():
            d, w = self.span(c, y, v, t)
            p = self.level(n, c, d, forces, t)
            z = s[f"{n}.z"]
            dz, F = friction(c["law"]["name"], p)(w, z)
            rates[f"{n}.z"] = dz
            k[f"{n}.F"], k[f"{n}.w"] = F, w
            sigma_0 = c["law"]["parameters"]["sigma_0"]
            stored += sigma_0 * z * z / 2
            lost += F * w - sigma_0 * z * dz
            power += self.act(c, net, F, t)
        inertia, force = dict.fromkeys(self.bodies, 0.0), dict.fromkeys(self.bodies, 0.0)
        for n, b in self.bodies.items():
            leader, ratio = self.ratio(n)
            m = b.get("mass", b.get("inertia", 0.0))
            inertia[leader] += ratio**2 * m
            force[leader] += ratio * net[n]
            stored += m * v[n] ** 2 / 2
        for n in self.free:
            rates[f"{n}.y"], rates[f"{n}.v"] = v[n], force[n] / inertia[n]
        for n in self.driven:
            rates[f"{n}.y"] = v[n]
            power -= force[n] * v[n]
        k["E_stored"] = stored
        rates |= {"E_in": power, "E_dissipated": lost}
        return k, rates

    def act(self, table, net, f, t):
        """Put a force on both ends; the power of an end that a signal moves."""
        ratio, power = table.get("ratio", 1.0), 0.0
        if isinstance(table["from"], dict):
            power = ratio * f * self.signals[self._of(table)].at(t, self.now)[1]
        else:
            net[table["from"]] -= ratio * f
        if table.get("to", "ground") != "ground":
            net[table["to"]] += f
        return power

    def level(self, n, c, d, forces, t):
        p = constants(c["law"])
        factors = {}
        for of, f in c.get("factors", {}).items():
            factors[of] = self.signals[n, of].at(t, self.now)[0] if "signal" in f else 1 + waves(f, d)
        level = factors.pop("level", 1.0)
        for of, factor in factors.items():
            p[of] *= factor
        for entry in c.get("loads", []):
            force = entry["force"]
            weights = {force: 1.0} if isinstance(force, str) else force
            size = abs(sum(x * forces[m] for m, x in weights.items()))
            p["F_c"] += entry.get("F_c", 0.0) * size
            p["F_s"] += entry.get("F_s", 0.0) * size
        p["F_c"] *= level
        p["F_s"] *= level
        return p

    def motor(self, n, m, t, v, s, k, rates):
        K, R, top, speed = m["K"], m["R"], m.get("voltage", float("inf")), v[m["on"]]
        asked = [c for c in self.controllers if self.controllers[c]["on"] == n]
        wanted = k[f"{asked[0]}.u"] / K if asked else None
        if "L" in m:
            i = s[f"{n}.i"]
            V = self.signals[n].at(t, self.now)[0] if wanted is None else None
            V = R * wanted + K * speed + m["L"] * (wanted - i) / m.get("current_time", 1e-3) if V is None else V
            V = min(max(V, -top), top)
            rates[f"{n}.i"] = (V - R * i - K * speed) / m["L"]
        elif wanted is None:
            V = min(max(self.signals[n].at(t, self.now)[0], -top), top)
            i = (V - K * speed) / R
        else:
            i = min(max(wanted, (-top - K * speed) / R), (top - K * speed) / R)
            V = R * i + K * speed
        k[f"{n}.i"], k[f"{n}.V"], k[f"{n}.torque"] = i, V, K * i
        return K * i

    def measures(self, c):
        return c.get("measures") or (c["on"] if c["on"] in self.bodies else self.motors[c["on"]]["on"])

    def law_of(self, c):
        table = c["compensation"].get("law") or self.contacts[c["compensation"]["contact"]]["law"]
        return table["name"], constants(table)

    def output(self, n, c, reference, y, v, integral, z_hat):
        """The unlimited output, the rate of the integral, that times its gain, and the rate of z_hat."""
        r, dr, ddr = reference
        if c["kind"] == "pid":
            u = -c["K_p"] * (y - r) - c.get("K_i", 0.0) * integral - c.get("K_d", 0.0) * v
            rate, gain = y - r, -c.get("K_i", 0.0)
        else:
            rate = c["K_p"] * (r - y) + dr - v
            gain = c["K_v"] / c["T_i"] if "T_i" in c else 0.0
            u = c["K_v"] * rate + gain * integral + c.get("feedforward", {}).get("inertia", 0.0) * ddr
        dz_hat = 0.0
        if "compensation" in c:
            law, p = self.law_of(c)
            share = c["compensation"].get("share", 1.0)
            if c["compensation"]["speed"] == "reference":
                u += share * copysign(self.steady(law, p, abs(dr)), dr) if dr else 0.0
            else:
                dz_hat, F = friction(law, p)(v, z_hat)
                u += share * F
        return u, rate, gain * rate, dz_hat

    @staticmethod
    def dither(c, t):
        if "dither" not in c:
            return 0.0
        wave = sin(2 * pi * c["dither"]["frequency"] * t)
        if c["dither"].get("kind") == "square":
            wave = 1.0 if (c["dither"]["frequency"] * t + 1e-9) % 1 < 0.5 else -1.0
        return c["dither"]["amplitude"] * wave

    @staticmethod
    def steady(law, p, v):
        rate = friction(law, p)
        a, b = rate(v, 0.0)[0], rate(v, 1e-6)[0]
        z = -a / ((b - a) / 1e-6)  # linear in z
        return p["sigma_0"] * z + p["sigma_2"] * v

    def controller(self, n, c, t, y, v, s, rates):
        limit = c.get("limit", float("inf"))
        if n in self.held:
            return self.held[n]
        at = self.measures(c)
        u, rate, push, dz_hat = self.output(
            n, c, self.signals[n].at(t, self.now), y[at], v[at], s[f"{n}.I"], s[f"{n}.z_hat"]
        )
        u += self.dither(c, t)
        if abs(u) > limit and push * u > 0:
            rate *= min(max(1 - (abs(u) - limit) / (1e-7 * limit), 0.0), 1.0)
        rates[f"{n}.I"], rates[f"{n}.z_hat"] = rate, dz_hat
        return min(max(u, -limit), limit)

    # -- sampling ------------------------------------------------------------------------------------------------

    def sample(self, n, k, x, memory):
        """The output of a controller at its k-th instant."""
        c, m = self.controllers[n], memory[n]
        T = c["sampling"]["period"]
        s = dict(zip(self.states, x, strict=True))
        leader, ratio = self.ratio(self.measures(c))
        y = ratio * s[f"{leader}.y"]
        if "noise" in m:
            y += c["sampling"]["noise"] * m["noise"][k]
        if step := c["sampling"].get("resolution", 0.0):
            y = step * round(y / step)
        w = c["sampling"].get("bandwidth")
        if not k:
            m |= {"last": y, "filter": (y, 0.0), "I": 0.0, "z_hat": 0.0}
        v = (y - m["last"]) / T if w is None else m["filter"][1]
        m["last"] = y
        if w is not None:  # x'' = w^2 (y - x) - 2 w x', y held
            a, b = m["filter"][0] - y, m["filter"][1]
            decay = exp(-w * T)
            m["filter"] = y + (a + (b + w * a) * T) * decay, (b - w * (b + w * a) * T) * decay
        r = self.signals[n].at(k * T, k * T)
        u, rate, push, _ = self.output(n, c, r, y, v, m["I"], m["z_hat"])
        u += self.dither(c, k * T)
        limit = c.get("limit", float("inf"))
        if not (abs(u) > limit and push * u > 0):
            m["I"] += T * rate
        if "compensation" in c and c["compensation"]["speed"] == "measured":
            law, p = self.law_of(c)
            rate_of = friction(law, p)
            fine = odeint(
                lambda z, t: [rate_of(v, z[0])[0]], [m["z_hat"]], [0, T], rtol=1e-12, atol=1e-16, mxstep=10**6
            )
            m["z_hat"] = float(fine[-1, 0])
        return min(max(u, -limit), limit)


def solve(data, rtol=1e-11):
    """The columns of a machine at its rows, from one breakpoint, sample, output or row to the next."""
    machine = Machine(data)
    step, t_end = data["output"]["step"], data["solve"]["t_end"]
    rows = np.arange(int(t_end / step + 1e-9) + 1) * step
    breaks = {b for s in machine.signals.values() for b in s.breaks if 0 < b < t_end}
    x = np.zeros(len(machine.states))
    for n, b in machine.bodies.items():
        for name, value in b.get("initial", {}).items():
            x[machine.states.index(f"{n}.{name}")] = value
    memory, queue, samples = {n: {} for n in machine.sampled}, {n: deque() for n in machine.sampled}, set()
    for n in machine.sampled:
        c = machine.controllers[n]["sampling"]
        count = int(t_end / c["period"]) + 2
        samples |= {(k * c["period"], n, k) for k in range(count)}
        if c.get("noise"):
            memory[n]["noise"] = np.random.default_rng(c.get("seed", 0)).standard_normal(count)
    outputs = {t + machine.controllers[n]["sampling"].get("delay", 0.0) for t, n, _ in samples}
    instants = sorted({0.0, *rows, *breaks, *(t for t, _, _ in samples), *outputs})
    merged = [instants[0]]
    for t in instants[1:]:
        if t - merged[-1] > 1e-11 * max(t, 1e-3):
            merged.append(t)
    samples, table, row = deque(sorted(samples)), [], 0
    peak = np.maximum(np.abs(x), 1e-9)
    for i, t in enumerate(merged):
        if t > rows[-1] * (1 + 1e-9):
            break
        before = machine.quantities(t, x)[0]["E_stored"]
        machine.now = t
        if any(isinstance(link["from"], dict) for link in machine.links.values()):
            x[-2] += machine.quantities(t, x)[0]["E_stored"] - before
        while samples and samples[0][0] <= t + 1e-11 * max(t, 1e-3):
            _, n, k = samples.popleft()
            c = machine.controllers[n]["sampling"]
            queue[n].append((k * c["period"] + c.get("delay", 0.0), machine.sample(n, k, x, memory)))
        for n in machine.sampled:
            while queue[n] and queue[n][0][0] <= t + 1e-11 * max(t, 1e-3):
                machine.held[n] = queue[n].popleft()[1]
        if row < len(rows) and abs(t - rows[row]) <= 1e-10 * max(t, 1e-3):
            table.append({"t": rows[row], **machine.quantities(t, x)[0]})
            row += 1
        if i + 1 == len(merged):
            break

        def rates(t, x):
            found = machine.quantities(t, x)[1]
            return [found.get(name, 0.0) for name in machine.states]

        found, info = odeint(
            rates, x, [t, merged[i + 1]], tfirst=True, rtol=rtol, atol=1e-13 * peak, mxstep=10**6, full_output=True,
            tcrit=[merged[i + 1]],
        )  # fmt: skip
        assert info["message"] == "Integration successful."
        x = found[-1]
        peak = np.maximum(peak, np.abs(x))
    return {name: np.array([row[name] for row in table]) for name in table[0]}
