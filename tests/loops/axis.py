"""A small axis: one mass, one contact, a controller."""

from tests.machine.machines import law, machine


def axis(t_end=2.0, contact=None, **controller):
    """A mass of 1 kg on a contact under a PID controller that goes to 0.05 m."""
    own = {"kind": "pid", "on": "a", "signal": {"kind": "step", "time": 0.1, "value": 0.05}, "K_p": 200.0, "K_d": 20.0}
    guide = {"from": "a", "law": contact or law("lugre", sigma_1=30.0, sigma_2=15.0)}
    controllers = {"hold": {**own, **controller}}
    return machine({"a": {"mass": 1.0}}, t_end, energy=False, contacts={"guide": guide}, controllers=controllers)
