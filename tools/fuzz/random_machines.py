"""Machines that nobody chose: random bodies, ties, links, contacts, loads, motors and controllers, sane in proportion."""

from __future__ import annotations

import math

import numpy as np

LAWS = (
    "dahl", "lugre", "lugre_arctan", "lugre_sobczyk", "lugre_majorant", "elastoplastic", "elastoplastic_majorant",
    "coulomb_viscous", "stribeck", "stribeck_tanh",
)  # fmt: skip
SMOOTH = ("lugre_arctan", "lugre_sobczyk", "lugre_majorant", "elastoplastic_majorant", *LAWS[-3:])
ROWS = 60


def random_machine(seed: int) -> dict:
    """The data of a machine file."""
    return _Made(np.random.default_rng(seed)).data


class _Made:
    """A chain of bodies and what acts on them, in the scales of one mass, one length and one time."""

    def __init__(self, random):
        self.random = random
        self.mass = self.scaled(0.1, 10)
        self.length, self.time = self.scaled(1e-3, 1), self.scaled(1e-2, 1)
        self.speed, self.force = self.length / self.time, self.mass * self.length / self.time**2
        self.t_end = self.time * self.between(4, 10)
        self.data = {"schema": 2, "name": "random", "solve": {"t_end": self.t_end}}
        self.data["output"] = {"step": self.t_end / ROWS, "energy": True}
        self.bodies()
        for part, most, least in (
            ("links", 2, 0),
            ("contacts", 3, 1),
            ("loads", 2, 0),
            ("motors", 1, 0),
            ("controllers", 1, 0),
        ):
            for i in range(int(random.integers(least, most + 1))):
                if built := getattr(self, part)():
                    self.data.setdefault(part, {})[f"{part}{i}"] = built
        self.load_levels()

    def between(self, low, high):
        return float(self.random.uniform(low, high))

    def scaled(self, low, high):
        return float(10 ** self.random.uniform(math.log10(low), math.log10(high)))

    def sign(self):
        return float(self.random.choice([-1, 1]))

    def pick(self, choice):
        return choice[int(self.random.integers(len(choice)))]

    def chance(self, share):
        return bool(self.random.random() < share)

    def bodies(self):
        kind, bodies = self.pick(["mass", "inertia"]), {}
        for i in range(int(self.random.integers(1, 4))):
            bodies[f"b{i}"] = {kind: self.mass * self.scaled(0.3, 3)}
            if self.chance(0.5):
                y, v = self.between(-1, 1) * self.length, self.between(-1, 1) * self.speed
                bodies[f"b{i}"]["initial"] = {"y": y, "v": v}
        if self.chance(0.3):
            ratio = self.sign() * self.scaled(0.5, 2)
            bodies["tied"] = {kind: self.mass * self.scaled(0.1, 1), "tied_to": "b0", "ratio": ratio}
        if self.chance(0.3):
            bodies["belt"] = {"velocity": {"signal": self.signal(self.speed, smooth=True)}}
        self.data["bodies"] = bodies
        self.moving = [name for name in bodies if name != "belt"]

    def ends(self):
        """The ends of a link or a contact, which are not one rigid thing."""
        begin = self.pick(self.moving)
        same = {"b0", "tied"} if begin in ("b0", "tied") else {begin}
        end = self.pick([name for name in (*self.data["bodies"], "ground") if name not in same])
        result = {"from": begin, "to": end}
        return result | ({"ratio": self.sign() * self.scaled(0.5, 2)} if self.chance(0.3) else {})

    def signal(self, size, smooth=False):
        """A signal of about this size; ``smooth``: its value does not jump."""
        kind = self.pick(["sine", "points", "spline", "point_to_point", "ramp", *([] if smooth else ["step"])])
        if kind == "ramp":
            return {"kind": kind, "rate": size / self.t_end * self.between(-2, 2)}
        if kind == "sine":
            rest = {"phase": self.between(-3, 3), "offset": size * self.between(-0.3, 0.3)}
            return {"kind": kind, "amplitude": size, "frequency": self.between(1, 3) / self.t_end, **rest}
        if kind == "step":
            return {"kind": kind, "value": size * self.between(-1, 1), "time": self.between(0, 0.5) * self.t_end}
        t = (np.arange(5) + self.random.uniform(0.1, 0.9, 5)) * self.t_end / 5
        return {"kind": kind, "t": t.tolist(), "value": (size * self.random.uniform(-1, 1, 5)).tolist()}

    def links(self):
        result = self.ends()
        k = self.mass / self.time**2 * self.scaled(1, 20)
        result |= {"stiffness": k, "damping": self.between(0.05, 0.5) * math.sqrt(k * self.mass)}
        if self.chance(0.3):
            result["gap"] = self.length * self.between(0.01, 0.3)
        if self.chance(0.3):
            result["from"] = {"signal": self.signal(self.length, smooth=True)}
            result["to"] = self.pick(self.moving)
        return result

    def contacts(self):
        result, name = self.ends(), self.pick(LAWS)
        F_c, v_s = self.force * self.scaled(0.03, 0.5), self.speed * self.scaled(0.02, 0.2)
        sigma_0 = F_c / (self.length * self.scaled(2e-3, 2e-2))
        parameters = {
            "sigma_0": sigma_0, "sigma_1": self.between(0.3, 1.5) * math.sqrt(sigma_0 * self.mass),
            "sigma_2": self.scaled(1e-3, 3e-1) * F_c / self.speed, "F_c": F_c, "F_s": F_c * self.between(1, 1.6), "v_s": v_s,
        }  # fmt: skip
        wanted = {"dahl": ("sigma_0", "F_c"), "coulomb_viscous": ("F_c", "sigma_2")}.get(name, tuple(parameters))
        if name.startswith("stribeck"):
            wanted = ("F_c", "F_s", "v_s", "sigma_2")
        law = {"name": name, "parameters": {key: parameters[key] for key in wanted}}
        if name in SMOOTH:
            law["k_v"] = self.scaled(5, 100) / v_s
        if name == "lugre_majorant":
            law["smooth_abs"] = self.pick(["atan", "sqrt", "compact"])
        if name.startswith("elastoplastic"):
            law["z_ba"] = self.between(0.2, 0.8) * F_c / sigma_0
        result["law"] = law
        factors = {key: self.factor() for key in ("level", "sigma_2", "k_v") if self.chance(0.15)}
        factors = {key: x for key, x in factors.items() if key == "level" or key in law or key in wanted}
        return result | ({"factors": factors} if factors else {})

    def factor(self):
        """By how much a constant rises and falls, with the place or with time."""
        if self.chance(0.5):
            return {"amplitude": [self.between(0.1, 0.4)], "waves": [self.scaled(0.5, 5) / self.length]}
        t = np.linspace(0, self.t_end, 4)
        return {"signal": {"kind": "points", "t": t.tolist(), "value": self.random.uniform(0.6, 1.5, 4).tolist()}}

    def loads(self):
        kind, result = self.pick(["signal", "pendulum", "ripple"]), {"on": self.pick(self.moving)}
        size = self.force * self.scaled(0.2, 2)
        if kind == "signal":
            return result | {"kind": kind, "signal": self.signal(size)}
        if kind == "pendulum":
            return result | {"kind": kind, "amplitude": size, "phase": self.between(-3, 3)}
        waves = [self.scaled(0.5, 5) / self.length for _ in range(2)]
        return result | {"kind": kind, "amplitude": [size * 0.3, size * 0.2], "waves": waves, "phase": [0.4, -1.0]}

    def motors(self):
        K, R = self.scaled(0.05, 5), self.scaled(0.1, 10)
        result = {"on": self.pick(self.moving), "K": K, "R": R, "voltage": 3 * (self.force * R / K + K * self.speed)}
        if self.chance(0.5):
            result |= {"L": R * self.time * self.scaled(0.02, 0.1), "current_time": self.time * self.scaled(0.02, 0.1)}
        if self.chance(0.4):
            result["signal"] = self.signal(result["voltage"] * 0.5)
            result.pop("current_time", None)
        return result

    def controllers(self):
        motor = next((n for n, m in self.data.get("motors", {}).items() if "signal" not in m), None)
        on = motor or self.pick(self.moving)
        k = self.mass / self.time**2 * self.scaled(1, 10)
        result = {"on": on, "signal": self.signal(self.length, smooth=True), "kind": self.pick(["pid", "cascade"])}
        if result["kind"] == "pid":
            result |= {
                "K_p": k,
                "K_i": k / self.time * self.between(0, 0.3),
                "K_d": self.between(0.7, 2) * math.sqrt(k * self.mass),
            }
        else:
            result |= {"K_p": self.between(0.5, 3) / self.time, "K_v": self.mass / self.time * self.between(1, 6)}
            result |= {"T_i": self.time * self.between(0.5, 3)} if self.chance(0.5) else {}
        if self.chance(0.4):
            result["limit"] = self.force * self.between(1, 5)
        if self.chance(0.5):
            sampling = {"period": self.time * self.between(0.03, 0.06)}
            sampling |= {"delay": sampling["period"] * self.between(0, 1.5)} if self.chance(0.5) else {}
            sampling |= {"bandwidth": self.between(5, 30) / self.time} if self.chance(0.5) else {}
            sampling |= {"resolution": self.length * 1e-3} if self.chance(0.3) else {}
            sampling |= {"noise": self.length * 1e-4, "seed": 3} if self.chance(0.3) else {}
            result["sampling"] = sampling
        return result

    def load_levels(self):
        """Levels that forces raise; a motor that nobody drives is taken away."""
        data = self.data
        driven = {c["on"] for c in data.get("controllers", {}).values()}
        for name, motor in list(data.get("motors", {}).items()):
            if "signal" not in motor and name not in driven:
                motor["signal"] = self.signal(motor["voltage"] * 0.5)
                motor.pop("current_time", None)
        forces = [*data.get("links", {}), *data.get("loads", {}), *data.get("motors", {})]
        for contact in data["contacts"].values():
            if forces and self.chance(0.3):
                level = {key: self.between(0.05, 0.3) for key in ("F_s", "F_c") if key in contact["law"]["parameters"]}
                if "F_s" in level:
                    level["F_c"] = min(level["F_c"], level["F_s"])
                contact["loads"] = [{"force": self.pick(forces), **level}]
