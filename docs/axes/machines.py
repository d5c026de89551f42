"""Three axes as files of Stribeck: what is known of each before it is measured, and what is true of its friction."""

from __future__ import annotations

from typing import Any

SAMPLING = {"period": 5e-4, "delay": 2.5e-4, "resolution": 1e-6}
SOLVE = {"solve": {"t_end": 1.0}, "output": {"step": 2e-3}}


def _law(sigma_0: float, sigma_1: float, sigma_2: float, F_c: float, F_s: float, v_s: float) -> dict[str, Any]:
    numbers = {"sigma_0": sigma_0, "sigma_1": sigma_1, "sigma_2": sigma_2, "F_c": F_c, "F_s": F_s, "v_s": v_s}
    return {"name": "lugre", "parameters": numbers}


def joint() -> dict[str, Any]:
    """A robot joint: a motor's rotor, a harmonic gear as a stiff spring, an arm; the encoder is on the rotor."""
    move = {"kind": "point_to_point", "t": [0.05, 0.35, 0.7], "value": [0.0, 60.0, 0.0]}
    return {
        "schema": 2, "name": "joint",
        "bodies": {"rotor": {"inertia": 6e-5}, "arm": {"inertia": 0.25}},
        "links": {"gear": {"from": "rotor", "to": "arm", "ratio": 0.01, "stiffness": 2e4, "damping": 30.0}},
        "contacts": {"bearing": {"from": "rotor", "law": _law(4.0, 4e-3, 2e-5, 0.012, 0.018, 1.5)}},
        "controllers": {"axis": {
            "kind": "cascade", "on": "rotor", "measures": "rotor", "K_p": 25.0, "K_v": 8e-3, "limit": 1.0, "signal": move,
            "sampling": {**SAMPLING, "resolution": 2e-3}, "feedforward": {"inertia": 8.5e-5},
        }},
        **SOLVE,
    }  # fmt: skip


def stage() -> dict[str, Any]:
    """A linear stage: the slide of a screw's nut, and a table that it carries with play."""
    move = {"kind": "point_to_point", "t": [0.05, 0.4, 0.8], "value": [0.0, 0.05, 0.0]}
    return {
        "schema": 2, "name": "stage",
        "bodies": {"nut": {"mass": 6.0}, "table": {"mass": 2.0}},
        "links": {"play": {"from": "nut", "to": "table", "stiffness": 2e6, "damping": 400.0, "gap": 2e-5}},
        "contacts": {
            "guide": {"from": "nut", "law": _law(8e5, 2500.0, 40.0, 14.0, 20.0, 5e-3)},
            "seal": {"from": "table", "law": _law(1e5, 400.0, 5.0, 1.0, 1.2, 5e-3)},
        },
        "controllers": {"axis": {
            "kind": "cascade", "on": "nut", "measures": "nut", "K_p": 40.0, "K_v": 1200.0, "limit": 400.0, "signal": move,
            "sampling": SAMPLING, "feedforward": {"inertia": 8.0},
        }},
        **SOLVE,
    }  # fmt: skip


def belt() -> dict[str, Any]:
    """A belt axis: the pulley with the motor, as the mass that it is along the belt, and a carriage on the belt's spring."""
    move = {"kind": "point_to_point", "t": [0.05, 0.45, 0.9], "value": [0.0, 0.2, 0.0]}
    return {
        "schema": 2, "name": "belt",
        "bodies": {"pulley": {"mass": 3.0}, "carriage": {"mass": 2.0}},
        "links": {"belt": {"from": "pulley", "to": "carriage", "stiffness": 3e5, "damping": 250.0}},
        "contacts": {"rail": {"from": "pulley", "law": _law(2e5, 900.0, 25.0, 11.0, 15.0, 1e-2)}},
        "controllers": {"axis": {
            "kind": "cascade", "on": "pulley", "measures": "pulley", "K_p": 30.0, "K_v": 600.0, "limit": 300.0, "signal": move,
            "sampling": {**SAMPLING, "resolution": 5e-6}, "feedforward": {"inertia": 5.0},
        }},
        **SOLVE,
    }  # fmt: skip


MACHINES = {"joint": joint, "stage": stage, "belt": belt}
