"""Saves the progress of a fit on disk, so that an interrupted fit continues."""

from __future__ import annotations

import json
from hashlib import sha256
from pathlib import Path
from typing import Any

from stribeck.files import json_of, write_sealed
from stribeck.identify.actuator.problem import Keep
from stribeck.identify.actuator.recordings import Logs
from stribeck.scenario import Scenario

NAME = "fit.partial.json"


class Kept:
    """The best values by stage, under a digest of all inputs of the fit."""

    def __init__(self, folder: Path | None, scenario: Scenario, logs: Logs) -> None:
        self.path = None if folder is None else folder / NAME
        inputs = sha256(json.dumps(scenario.data, sort_keys=True, default=str).encode())
        for r in logs.recordings:
            inputs.update(repr((r.file, r.known, r.hold_out, r.window)).encode())
            for name, c in {**r.outputs, **r.inputs}.items():
                inputs.update(repr((name, c.noise, c.held)).encode() + c.t.tobytes() + c.x.tobytes())
        inputs.update(repr((logs.sought, logs.laws)).encode())
        self.digest = inputs.hexdigest()
        saved = None if self.path is None else json_of(self.path, sealed=True)
        self.stages: dict[str, Any] = saved["stages"] if saved is not None and saved["digest"] == self.digest else {}

    def load(self, stage: str) -> dict[str, float] | None:
        """The saved best values of a stage; None if there are none."""
        values: dict[str, float] | None = self.stages.get(stage, {}).get("values")
        return values

    def saver(self, stage: str) -> Keep:
        """A function that saves the best values of a stage."""

        def save(values: dict[str, float], cost: float) -> None:
            self.stages[stage] = {"values": values, "cost": cost}
            if self.path is not None:
                self.path.parent.mkdir(parents=True, exist_ok=True)
                write_sealed(self.path, {"digest": self.digest, "stages": self.stages})

        return save

    def done(self) -> None:
        """Delete the saved progress."""
        if self.path is not None:
            self.path.unlink(missing_ok=True)
