"""Laws of the user's own and parameter sets in files, named by a scenario."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import pytest

from stribeck import InputError, Scenario, law
from stribeck.laws import find
from tests.scenario.valid_scenarios import CANUDAS, VALID, edited, toml

LAW = '''
from stribeck.constants import Constant
from stribeck.expressions.ops import tanh
from stribeck.laws import BristleLaw, StaticLaw
from stribeck.laws.terms import g


class Mine(BristleLaw):
    """LuGre with a smooth sign of another kind."""

    name = "mine"
    k = Constant("s/m", "steepness", above=0)

    @staticmethod
    def dz_dt(p, v, z):
        return v - v * tanh(p.k * v) / g(p, v) * z


class Unnamed(Mine):
    """Another one."""


class NoLaw:
    pass


def a_function():
    pass
'''


def load(folder, law_table, text=LAW):
    (folder / "mylaw.py").write_text(text)
    data = edited(VALID["force_points"], "law", value=law_table)
    path = folder / "scenario.toml"
    path.write_text(toml(data))
    return Scenario.load(path)


def refused(folder, law_table, text=LAW) -> str:
    with pytest.raises(InputError) as error:
        load(folder, law_table, text)
    assert len(error.value.problems) == 1
    line = error.value.problems[0]
    assert line.isprintable()
    assert len(line) <= 300
    return line


def test_a_law_of_ones_own(tmp_path, monkeypatch):
    scenario = load(tmp_path, {"name": "mylaw.py:Mine", "k": 1e6, "parameters": CANUDAS})
    assert scenario.law.name == "mine"
    assert scenario.law.p.k == 1e6
    assert load(tmp_path, {"name": "mylaw.py:mine", "k": 1e6, "parameters": CANUDAS}).law.name == "mine"
    assert load(tmp_path, {"name": "mylaw.py:Unnamed", "k": 1e6, "parameters": CANUDAS}).law.name == "Unnamed"
    monkeypatch.chdir(tmp_path)
    assert law("mylaw.py:Mine", "canudas1995", k=2.0).p.k == 2.0
    assert law(f"{tmp_path}/mylaw.py:Mine", "canudas1995", k=2.0).p.k == 2.0


def test_an_edited_file_is_read_anew(tmp_path):
    table = {"name": "mylaw.py:Mine", "k": 1e6, "parameters": CANUDAS}
    before = load(tmp_path, table).law.rate(1e-3, 1e-6)
    after = load(tmp_path, table, LAW.replace("return v -", "return 2 * v -")).law.rate(1e-3, 1e-6)
    assert after == pytest.approx(before + 1e-3)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("missing.py:Mine", "cannot read"),
        ("a\0b.py:Mine", "cannot read"),
        (".py:Mine", "cannot read"),
        ("mylaw.py:Yours", "has no law 'Yours' (it has Mine, Unnamed)"),
        ("mylaw.py:", "has no law ''"),
        ("mylaw.py:NoLaw", "NoLaw is no law: it must be derived from BristleLaw, StaticLaw or Law"),
        ("mylaw.py:a_function", "has no law 'a_function'"),
        ("mylaw.py:BristleLaw", "is no law"),
        ("mylaw.py", "no such law (known: "),
    ],
)
def test_a_law_that_is_not_there(name, said, tmp_path):
    line = refused(tmp_path, {"name": name, "parameters": CANUDAS})
    assert line.startswith("law.name: '")
    assert said in line


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("def f(:\n", "mylaw.py does not load: SyntaxError: invalid syntax"),
        ("\xa7", "does not load: SyntaxError"),
        ("import no_such_module_of_mine", "does not load: ModuleNotFoundError: No module named"),
        ("1 / 0", "does not load: ZeroDivisionError: division by zero"),
        ("raise SystemExit(3)", "does not load: SystemExit: 3"),
        ("raise ValueError('two\\nlines' + 300 * '.')", "does not load: ValueError: two lines"),
        (LAW.replace("return v - v *", "return u *"), "cannot be evaluated: NameError: name 'u' is not defined"),
        (LAW.replace("def dz_dt(p, v, z)", "def dz_dt(v, z)"), "cannot be evaluated: TypeError: Mine.dz_dt() takes 2"),
        (LAW.replace("    @staticmethod\n", ""), "cannot be evaluated: TypeError"),
        (LAW.replace("p.k *", "p.kk *"), "cannot be evaluated: AttributeError: "),
        (LAW.replace("return v -", "return 0 if v > 0 else v -"), "use where(condition, a, b)"),
        (LAW.replace("return v -", "return 0 if v == 0 else v -"), "equations cannot test for equality: use where"),
        (LAW.replace("import tanh", "import exp\nfrom numpy import tanh"), "cannot be evaluated: TypeError: "),
        (LAW.replace("return v - v *", "return"), None),
    ],
    ids=range(14),
)
def test_a_law_that_does_not_work(text, said, tmp_path):
    table = {"name": "mylaw.py:Mine", "k": 1e6, "parameters": CANUDAS}
    if said is None:
        assert load(tmp_path, table, text).law.name == "mine"
    else:
        line = refused(tmp_path, table, text)
        assert line.startswith("law.name: 'mylaw.py:Mine': ")
        assert said in line


def test_constants_of_a_law_of_ones_own(tmp_path):
    name = "mylaw.py:Mine"
    assert refused(tmp_path, {"name": name, "parameters": CANUDAS}).startswith("law.k: missing: law 'mine' needs it")
    line = refused(tmp_path, {"name": name, "k": 0, "parameters": CANUDAS})
    assert line == "law.k: 0: must be a finite number > 0"
    line = refused(tmp_path, {"name": name, "k": 1, "k_v": 1e6, "parameters": CANUDAS})
    assert line == "law.k_v: 1000000.0: law 'mine' has no such constant (it has k, v_d, delta)"


STATIC = """
from stribeck.laws import StaticLaw


class Viscous(StaticLaw):
    uses = ("sigma_2",)

    @staticmethod
    def friction(p, v, z, dz_dt):
        return p.sigma_2 * v
"""


def test_a_static_law_is_its_friction_only(tmp_path):
    (tmp_path / "mylaw.py").write_text(STATIC)
    data = edited(VALID["spring_ramp"], "law", value={"name": "mylaw.py:Viscous", "parameters": {"sigma_2": 2.0}})
    scenario = Scenario(data, folder=tmp_path)
    assert scenario.law.force(3.0) == 6.0
    assert all(tolerance > 0 for tolerance in scenario.atol().values())


def test_threads_load_a_law_once(tmp_path):
    (tmp_path / "mylaw.py").write_text("import time\ntime.sleep(0.2)\n" + LAW)
    with ThreadPoolExecutor(4) as pool:
        found = set(pool.map(lambda _: find("mylaw.py:Mine", tmp_path), range(4)))
    assert len(found) == 1


TABLE = "[parameters]\n" + "".join(f"{name} = {value}\n" for name, value in CANUDAS.items())
FLAT = "title = 'mine'\nsource = 'a test'\n" + TABLE.partition("\n")[2]
FITTED = "".join(f"[parameters.{n}]\nvalue = {x}\nlow = 0\nhigh = {2 * x}\nunit = 'SI'\n" for n, x in CANUDAS.items())


@pytest.mark.parametrize("text", [TABLE, FLAT, FITTED, TABLE + "k_v = 1e6\n", "\ufeff" + FLAT], ids=range(5))
def test_a_set_in_a_file_beside_the_scenario(text, tmp_path):
    (tmp_path / "x.toml").write_text(text, encoding="utf-8")
    found = load(tmp_path, {"name": "lugre", "parameters": "x.toml"}).law
    assert found.values == {**CANUDAS, "v_d": None, "delta": None}
    assert law("lugre", str(tmp_path / "x.toml")).values == found.values


def test_paths_that_are_no_files(tmp_path):
    for name in ("a\0b.toml", ".toml", "a/b/c.toml", "x" * 300 + ".toml"):
        assert refused(tmp_path, {"name": "lugre", "parameters": name}).startswith("law.parameters: ")
