"""The modules of a page against ``run`` and the laws, without a browser."""

from base64 import b64encode
from gzip import compress

import numpy as np
import pytest

pytest.importorskip("wasmtime")

from stribeck import Scenario, examples, parameter_sets, simulate
from stribeck.explorer.appendix import CLAIMS, appendix, columns
from stribeck.explorer.page import layout, shape
from stribeck.explorer.variants import subject, under, variants
from stribeck.laws import builtin, find
from stribeck.simulation.promise import step_share
from stribeck.simulation.wasm import with_functions
from tests.explorer.module import Module


def module_of(scenario):
    """The module of a scenario that is on no page."""
    built = with_functions(scenario.system, appendix(scenario))
    law = {
        "wasm": b64encode(compress(built.module)), "shape": shape(built),
        "parameters": [".".join(x) for x in scenario.system.parameters],
        "states": [s.name for s in scenario.system.states], "columns": [{"name": c.name} for c in columns(scenario.system)],
    }  # fmt: skip
    return Module(law, layout())


@pytest.mark.parametrize("law", ["lugre_majorant", "elastoplastic"])
def test_a_module_computes_what_run_computes(law, scenario, data):
    scenario = scenario if law == scenario.law.name else under(scenario, find(law))
    module, solution = Module(data["laws"][law], data["layout"]), simulate(scenario)
    assert module.imports == []
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
        module.call("system_setup", p, changed.solve.rtol, out)
        share = step_share(changed)
        wanted = [*(share * x for x in changed.atol().values()), share, np.inf]
        assert module.read(out, n + 2) == pytest.approx(wanted, rel=1e-12)
        module.call("system_claims", p, out)
        guarantees = law.guarantees()
        assert list(module.read(out, 5)) == [float(guarantees[claim]) for claim in CLAIMS]
        v = np.logspace(-8, 1, 40)
        force = module.room(320)
        for i, speed in enumerate(v):
            module.call("system_steady", p, speed, 1.0, force + 8 * i)
        assert module.read(force, len(v)) == pytest.approx(law.steady_force(v), rel=1e-9)


@pytest.mark.share(5)
@pytest.mark.parametrize("law", builtin())
def test_every_law_is_offered_and_runs(law):
    for name in ("stick_slip", "hysteresis", "limit_cycle"):
        scenario = subject(str(examples.path(name)), {}, True)
        short = variants(scenario, [law])[law].with_changes({"solve.t_end": 1.0})
        columns_found, solution = module_of(short).run(short), simulate(short)
        for column, peak in solution.peaks.items():
            assert np.max(abs(columns_found[column] - solution[column])) <= 1e-6 * peak, column


def test_a_law_takes_from_a_set_what_the_scenarios_own_law_has_not():
    own = {"sigma_0": 2e5, "F_c": 1.2}
    data = Scenario.load(examples.path("stick_slip")).data
    scenario = Scenario({**data, "law": {"name": "dahl", "parameters": own}})
    assert under(scenario, find("lugre")).law.p.numbers == {**parameter_sets.load("canudas1995").values, **own}
    small = Scenario({**data, "law": {"name": "dahl", "parameters": {"sigma_0": 2e5, "F_c": 0.1}}})
    law = under(small, find("elastoplastic_majorant")).law
    assert 0.5 * 0.1 < law.p.z_ba * law.p.sigma_0 < 0.1


def test_a_sine_moves_with_its_numbers():
    scenario = Scenario.load(examples.path("sine_force"), {"solve.rtol": 1e-10, "solve.t_end": 2.0})
    changed = scenario.with_changes({"drive.signal.frequency": 3.0, "drive.signal.amplitude": 1.4})
    result, solution = module_of(scenario).run(changed), simulate(changed)
    for name, peak in solution.peaks.items():
        assert np.max(abs(result[name] - solution[name])) <= 1e-9 * peak, name
