"""The modules of a page against ``run`` and the laws, without a browser."""

from base64 import b64encode
from gzip import compress

import numpy as np
import pytest

pytest.importorskip("wasmtime")

from stribeck import Scenario, examples, simulate
from stribeck.codegen import source
from stribeck.explore import wasm
from stribeck.explore.appendix import CLAIMS, appendix, columns
from stribeck.explore.variants import subject, under, variants
from stribeck.laws import builtin, find
from stribeck.simulation.native import step_share
from tests.explore.module import Module


@pytest.mark.parametrize("law", ["lugre_majorant", "elastoplastic"])
def test_a_module_computes_what_run_computes(law, scenario, data):
    scenario = scenario if law == scenario.law.name else under(scenario, find(law))
    module, solution = Module(data["laws"][law], data["layout"]), simulate(scenario)
    assert module.imports == []
    assert module.call("stribeck_run_size") == data["layout"]["_size"][0]
    columns = module.run(scenario)
    for name, peak in solution.peaks.items():
        assert np.max(abs(columns[name] - solution[name])) <= 1e-9 * peak, name


@pytest.mark.parametrize(("F_s", "sigma_2"), [(1.5, 0.4), (1.0, 200.0), (1.5, 200.0)])
def test_tolerances_claims_and_curve_are_the_laws_own(F_s, sigma_2, scenario, data):
    for name in ("lugre_majorant", "elastoplastic"):
        changed = under(scenario, find(name)).with_changes(
            {"law.parameters.F_s": F_s, "law.parameters.sigma_2": sigma_2, "plant.mass": 1e-3}
        )
        module, law, n = Module(data["laws"][name], data["layout"]), changed.law, 3
        p, out = module.values(changed), module.room(800)
        module.call("stribeck_setup", p, changed.solve.rtol, out)
        share = step_share(changed)
        wanted = [*(share * x for x in changed.atol().values()), share, np.inf]
        assert module.read(out, n + 2) == pytest.approx(wanted, rel=1e-12)
        module.call("stribeck_claims", p, out)
        guarantees = law.guarantees()
        assert list(module.read(out, 5)) == [float(guarantees[claim]) for claim in CLAIMS]
        v = np.logspace(-8, 1, 40)
        force, speeds = module.room(320), module.put(v)
        module.call("stribeck_steady", p, len(v), speeds, force)
        assert module.read(force, len(v)) == pytest.approx(law.steady_force(v), rel=1e-9)


@pytest.mark.parametrize("law", builtin())
def test_every_law_is_offered_and_written(law):
    """The C of each law, and of the drives, is made without compiling it."""
    for name in ("stick_slip", "hysteresis", "limit_cycle"):
        scenario = subject(str(examples.path(name)), {}, True)
        found = variants(scenario, [law])[law]
        text = source(found.system) + appendix(found)
        assert all(name in text for name in ("stribeck_table", "stribeck_claims"))


def test_a_sine_moves_with_its_numbers():
    scenario = Scenario.load(examples.path("sine_force"), {"solve.rtol": 1e-10, "solve.t_end": 2.0})
    module = wasm.modules([f"{source(scenario.system)}\n\n{appendix(scenario)}"])[0]
    law = {
        "wasm": b64encode(compress(module)), "parameters": [".".join(x) for x in scenario.system.parameters],
        "states": [s.name for s in scenario.system.states], "columns": [{"name": c.name} for c in columns(scenario.system)],
    }  # fmt: skip
    changed = scenario.with_changes({"drive.signal.frequency": 3.0, "drive.signal.amplitude": 1.4})
    found, solution = Module(law, wasm.layout()).run(changed), simulate(changed)
    for name, peak in solution.peaks.items():
        assert np.max(abs(found[name] - solution[name])) <= 1e-9 * peak, name
