"""The servo of the example, with changes."""

from stribeck import Scenario, examples, simulate

COLUMNS = ("y", "v", "p_1", "p_2", "z", "z_hat", "e", "s", "p_err", "u", "F", "F_hat", "V")


def data():
    return Scenario.load(examples.path("servo")).data


def servo(law=None, observer=None, **changes):
    """The example's data with another law, observer and values at paths (__ for the dot)."""
    new = data()
    if law:
        new["law"] = {**law, "parameters": new["law"]["parameters"]}
    if observer:
        new["drive"] = {**new["drive"], "observer": observer}
    return Scenario(new).with_changes({key.replace("__", "."): value for key, value in changes.items()})


def solved(*args, **changes):
    solution = simulate(servo(*args, **changes))
    assert solution.status == "done", solution.reason
    return solution


def last(solution):
    """The largest error of the last quarter."""
    return abs(solution["e"][len(solution.t) * 3 // 4 :]).max()
