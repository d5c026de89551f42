"""The exported C against the law in Python, against equations written anew, and against everything a user may feed it."""

import shutil
import subprocess

import mpmath
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stribeck
from stribeck.exports.c.ccode import LawCode
from stribeck.exports.c.selftest import terms
from stribeck.laws import BristleLaw, Claims
from tests.exports.harness import ELASTOPLASTIC, LAWS, LINEAR, SANITIZE, STATIC, STRICT, _exported, law, need, program

EPS, EPS_FLOAT = 2.0**-52, 2.0**-23
# a form of equations each, under sanitizers: every law with every compiler takes minutes and finds no more
SANITIZED = (
    ("lugre_majorant", "gcc", False), ("lugre_majorant", "clang", True), ("elastoplastic_majorant", "gcc", True),
    ("elastoplastic", "clang", False), ("dahl", "gcc", True), ("makkar", "clang", False), ("stribeck", "gcc", False),
)  # fmt: skip
ARM = ("qemu-arm", "-L", "/usr/arm-linux-gnueabihf")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("c")


def inputs(name, single, rng, n=300):
    """Random v over 12 decades and both signs, and the extremes; random z within the bound of the law."""
    chosen = law(name)
    v = 10 ** rng.uniform(-9, 3, n) * rng.choice([-1, 1], n)
    v = np.concatenate([v, [0.0, -0.0, 1e-300, -1e-300, 1e6, -1e6, 5e-324]])
    z = rng.uniform(-1, 1, v.size) * chosen.scales(chosen.p).length * (name not in STATIC)
    return (v.astype(np.float32).astype(float), z.astype(np.float32).astype(float)) if single else (v, z)


def disagreement(name, run, single):
    """The largest error of F and dz/dt in eps times the sum of the absolute terms."""
    chosen, rng = law(name), np.random.default_rng(7)
    v, z = inputs(name, single, rng)
    size = terms(LawCode(chosen), ("rate", "force"))
    scale = np.array([size(*row) for row in zip(v, z, strict=True)]).T
    if name == "elastoplastic":
        assert size(1e-3, 1e-6)[0] == 1e-3  # below z_ba it is elastic: the terms of the other case are not there
    eps = EPS_FLOAT if single else EPS
    worst = 0.0
    for op, expected, by in (("r", chosen.rate(v, z), scale[0]), ("f", chosen.force(v, z), scale[1])):
        status, result, _ = run(op, z, v)
        assert (status == 0).all()
        worst = max(worst, np.max(abs(result - expected) / (eps * by + (1e-37 if single else 0) + 5e-324)))
    return worst


@pytest.mark.share(4)
@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("single", [False, True], ids=["double", "float"])
def test_agrees_with_python(name, single, folder):
    assert disagreement(name, program(name, folder, single=single), single) <= 4


@pytest.mark.share(3)
@pytest.mark.parametrize("name", ["lugre_majorant", "elastoplastic_majorant", "makkar"])
@pytest.mark.parametrize("single", [False, True], ids=["double", "float"])
def test_agrees_on_32_bit_arm(name, single, folder):
    run = program(name, folder, cc="arm-linux-gnueabihf-gcc", single=single, run=ARM)
    assert disagreement(name, run, single) <= 4


@pytest.mark.parametrize("cc", ["gcc", "clang"])
def test_no_warnings(cc, folder):
    need(cc)
    sources = [_exported(name, folder) / f"{name}{end}.c" for name in LAWS for end in ("", "_test")]
    for defines in (["-DDOUBLE"], [f"-D{name.upper()}_FLOAT" for name in LAWS]):
        words = [cc, *STRICT, "-fsyntax-only", *defines, *sources]
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize(("name", "cc", "single"), SANITIZED)
def test_self_test_under_sanitizers(name, cc, single, folder):
    need(cc)
    source, define = _exported(name, folder), f"-D{name.upper()}_FLOAT" if single else "-DDOUBLE"
    words = [cc, "-std=c99", *SANITIZE, define, f"{name}.c", f"{name}_test.c", "-o", "self", "-lm"]
    subprocess.run(words, cwd=source, check=True)
    done = subprocess.run(["./self"], cwd=source, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "all checks passed\n", "")


def test_self_test_can_fail(folder):
    source = _exported("lugre", folder)
    wrong = (source / "lugre.c").read_text().replace("R(100000.0)", "R(100000.1)")
    (source / "wrong.c").write_text(wrong)
    command = ["gcc", str(source / "wrong.c"), str(source / "lugre_test.c"), "-o", str(source / "wrong"), "-lm"]
    need("gcc")
    subprocess.run(command, check=True)
    assert subprocess.run([str(source / "wrong")], capture_output=True, check=False).returncode == 1


@pytest.mark.share(3)
@pytest.mark.parametrize("name", ["lugre_majorant", "elastoplastic", "dahl", "makkar"])
def test_nothing_traps(name, folder):
    """Every function with inf, nan and huge arguments everywhere, under the sanitizers: an error code, no crash."""
    run = program(name, folder, flags=SANITIZE)
    nasty = np.array([np.nan, np.inf, -np.inf, 1e308, -1e308, 1e-300, 0.0, -1.0])
    grid = np.meshgrid(nasty, nasty, nasty)
    for op in "frst" + "dco" * (name == "lugre_majorant"):
        status, F, z = run(op, *grid, 0.5, 1e-6)
        z_in, v, dt = (x.ravel() for x in grid)
        bad = ~np.isfinite(v) | (~np.isfinite(z_in) & (op != "s"))
        assert (status[bad] != 0).all()
        assert np.isfinite(F).all()
        assert ((z == z_in) | (np.isnan(z) & np.isnan(z_in)) | (status == 0)).all()  # unchanged on an error
        if op == "t":
            assert (status[~(dt > 0)] != 0).all()
    v = np.array([1.0, np.nan, 1e308, 0.0])
    status = run("b", *(x.ravel() for x in np.meshgrid(v, v, v, v)), 1.0)[0]
    assert set(status) <= {0, 1, 2, 3, 5}


@pytest.mark.share(4)
@pytest.mark.parametrize("name", LAWS)
def test_check_names_the_bad_constant(name, folder):
    run, chosen = program(name, folder), law(name)
    constants = [n for n, x in chosen.values.items() if x is not None]
    least = [(i, x) for i, n in enumerate(constants, 1) if (x := chosen.constants()[n].at_least) is not None]
    assert not any(run("p", *changed)[0] for changed in [(0,), *least])
    for i, key in enumerate(constants):
        for value in (np.nan, np.inf, -1.0):
            assert run("p", i + 1, value)[0] == 6 + i, (key, value)
    if "F_s" in constants:
        assert run("p", 1 + constants.index("F_s"), 0.5)[0] == 6 + constants.index("F_s")  # less than F_c


def exact_hold(name, z, v, dt):
    """z after dt with v held, to 40 digits, from the equations of theory.md written anew."""
    with mpmath.workdps(40):
        q = {n: mpmath.mpf(x) for n, x in law(name).values.items() if x is not None}
        v, z, dt = mpmath.mpf(v), mpmath.mpf(z), mpmath.mpf(dt)
        if name == "dahl":
            a, b = -q["sigma_0"] / q["F_c"] * abs(v), v
        else:
            g = (q["F_c"] + (q["F_s"] - q["F_c"]) * mpmath.exp(-((v / q["v_s"]) ** 2))) / q["sigma_0"]
            S = 2 / mpmath.pi * mpmath.atan(q["k_v"] * v) if "k_v" in q else 0
            speed, b = {
                "lugre": (abs(v), v), "lugre_arctan": (v * S, v), "lugre_sobczyk": (v * S, S * S * v),
                "lugre_majorant": (v * S + 2 / (mpmath.pi * q.get("k_v", 1)), v),
            }[name]  # fmt: skip
            a = -speed / g
        if a == 0:
            return float(z + dt * b), float(abs(z) + abs(dt * b))
        grown, driven = mpmath.exp(a * dt) * z, mpmath.expm1(a * dt) / a * b
        return float(grown + driven), float(abs(grown) + abs(driven))


@pytest.mark.share(2)
@pytest.mark.parametrize("name", LINEAR)
@pytest.mark.parametrize("dt", [1e-7, 4e-3, 10.0])
@pytest.mark.parametrize("single", [False, True], ids=["double", "float"])
def test_step_is_the_exact_hold(name, dt, single, folder):
    v, z = inputs(name, single, np.random.default_rng(3), n=30)
    dt = float(np.float32(dt)) if single else dt
    status, F, after = program(name, folder, single=single)("t", z, v, dt)
    assert (status == 0).all()
    expected, scale = np.array([exact_hold(name, *row, dt) for row in zip(z, v, strict=True)]).T
    eps, least = (EPS_FLOAT, 1e-38) if single else (EPS, 1e-320)
    assert np.max(abs(after - expected) / (eps * scale + least)) <= 4
    assert pytest.approx(law(name).force(v, after), rel=0, abs=eps * 16 * np.max(abs(v)) * 1e4) == F


@pytest.mark.share(3)
@pytest.mark.parametrize("name", ELASTOPLASTIC)
def test_a_short_step_has_order_two_and_a_long_one_is_divided(name, folder):
    run, chosen, v = program(name, folder), law(name), 1e-3
    z, long = np.linspace(-1.2e-5, 1.2e-5, 25), 0.02
    rule = [_step(chosen, x, v, long / 400) for x in z]
    assert run("t", z, v, long / 400)[2] == pytest.approx(rule, rel=0, abs=1e-17)
    exact = [
        solve_ivp(lambda t, x: [chosen.rate(v, x[0])], (0, long), [x], method="LSODA", rtol=1e-11, atol=1e-18).y[0, -1]
        for x in z
    ]
    assert run("t", z, v, long)[2] == pytest.approx(exact, rel=0, abs=2.5e-3 * 1.5e-5)


def _step(chosen, z, v, h):
    x = h * float(chosen.jacobian(v, z)[1])
    return z + h * (np.expm1(x) / x if abs(x) > 1e-14 else 1.0) * float(chosen.rate(v, z))


@pytest.mark.share(3)
@pytest.mark.parametrize("name", ["lugre", "lugre_majorant", "dahl", "elastoplastic_majorant"])
@pytest.mark.parametrize("single", [False, True], ids=["double", "float"])
def test_z_never_leaves_its_bound(name, single, folder):
    chosen, rng = law(name), np.random.default_rng(11)
    bound = float(np.float32(chosen.z_bound(chosen.p))) if single else chosen.z_bound(chosen.p)
    n = 5000
    v = 10 ** rng.uniform(-9, 3, n) * rng.choice([-1, 1], n)
    z = bound * np.clip(rng.uniform(-1.2, 1.2, n), -1, 1)
    status, _, after = program(name, folder, single=single)("t", z, v, 10 ** rng.uniform(-7, 0, n))
    assert (status == 0).all()
    assert (abs(after) <= bound * (1 + 2 * EPS_FLOAT * single)).all()


@pytest.mark.skipif(shutil.which("cc") is None, reason="needs a C compiler")
def test_the_self_test_of_a_high_static_friction_passes(tmp_path):
    """One step there crosses from all elastic to all slipping: 32 parts missed by 2.9e-3 of F_s/sigma_0."""
    chosen = stribeck.law("elastoplastic_majorant", "canudas1995", k_v=1e6, z_ba=7e-6, F_s=3.0)
    stribeck.export(chosen, "c", tmp_path, self_test=True)
    run = subprocess.run(
        "cc -O1 *.c -o test -lm && ./test", shell=True, cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stdout


@pytest.mark.parametrize("name", LAWS)
def test_steady_force(name, folder):
    v = np.concatenate([[0.0, 1e-300, -1e-300, 1e6], 10 ** np.random.default_rng(2).uniform(-8, 2, 50)])
    status, F, _ = program(name, folder)("s", 0.0, v)
    assert (status == 0).all()
    assert pytest.approx(law(name).steady_force(v), rel=1e-12) == F


@pytest.mark.parametrize("name", ["lugre_sobczyk", "lugre_majorant", "elastoplastic_majorant", "makkar"])
def test_force_rate(name, folder):
    v, z = inputs(name, False, np.random.default_rng(4), n=200)
    status, result, _ = program(name, folder)("d", z, v, 0.3)
    assert (status == 0).all()
    expected = law(name).force_rate(v, z, 0.3)
    assert result == pytest.approx(expected, rel=1e-9, abs=1e-9 * np.max(abs(expected[abs(v) < 1])))


@pytest.mark.parametrize("name", ["lugre_sobczyk", "elastoplastic_majorant"])
def test_observer(name, folder):
    """Eq. 15 over one sample, by SciPy."""
    chosen, sigma_0 = law(name), 1e5
    for z, v, s, K, dt in ((3e-6, 2e-4, 0.02, 1e-6, 1e-3), (-8e-6, 3e-3, -0.5, 1e-7, 2e-4)):
        rate = lambda t, x: [chosen.rate(v, x[0]) - K * sigma_0 * s]  # noqa: B023, E731
        exact = solve_ivp(rate, (0, dt), [z], method="LSODA", rtol=1e-11, atol=1e-17).y[0, -1]
        status, F, after = program(name, folder)("o", z, v, dt, s, K)
        assert status == 0
        assert after == pytest.approx(exact, abs=1e-9 * 1.5e-5 if name == "lugre_sobczyk" else 2e-3 * 1.5e-5)
        expected = sigma_0 * after + 316.22776601683796 * (chosen.rate(v, after) - K * sigma_0 * s) + 0.4 * v
        assert pytest.approx(expected, rel=1e-12) == F


def test_compensation(folder):
    run = program("lugre", folder)
    F = run("t", 1e-6, 1e-3, 1e-3)[1]
    assert run("c", 1e-6, 1e-3, 1e-3, 0.8)[1] == pytest.approx(0.8 * F, rel=1e-15)
    assert run("c", 1e-6, 1e-3, 1e-3, -0.1)[0] == 4
    assert run("c", 1e-6, 1e-3, 0.0, 0.8)[0] == 2


@pytest.mark.parametrize("name", ["lugre", "elastoplastic_majorant"])
def test_a_compensation_that_fails_changes_nothing(name, folder):
    """The force is finite, gain times the force is not: z must stay where it was."""
    run = program(name, folder)
    status, F, z = run("c", 1e-6, 10.0, 1e-3, 1.7e308)
    assert (status, F, z) == (1, 0.0, 1e-6)


@pytest.mark.parametrize("name", ELASTOPLASTIC)
@pytest.mark.parametrize("single", [False, True], ids=["double", "float"])
def test_no_step_goes_on_for_ever(name, single, folder):
    """dt/32 is 0 in floating point, and the rates are not finite: that was a loop without end."""
    run, tiny = program(name, folder, single=single), 1e-44 if single else 3e-323
    huge = [1e-3, 1e30, 3e38] if single else [1e-3, 1e30, 1e300, -1e300, 1.7e308]
    z, v, dt = np.meshgrid([0.0, 1e-5, *huge[1:]], huge, [tiny, 7 * tiny, 1e-3, 1e30])
    status, F, after = run("t", z, v, dt)
    assert set(status) <= {0, 1}
    assert np.isfinite(after[status == 0]).all()
    assert np.isfinite(F[status == 0]).all()
    assert (after[status == 1] == z.ravel()[status == 1].astype(np.float32 if single else float)).all()


# -- mass and bristle together ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["lugre", "lugre_majorant", "elastoplastic", "dahl", "stribeck", "makkar"])
@pytest.mark.parametrize(("dt", "size"), [(1e-4, 1.0), (4e-3, 1.0), (1.0, 1.0), (4e-3, 1e-6)])
def test_body_step_solves_its_equations(name, dt, size, folder):
    """(v1 - v)/dt = u - F, y1 = y + dt v1 and z1 = z + dt dz/dt(v1, z1), with the law's own force."""
    chosen, rng = law(name), np.random.default_rng(6)
    run, u = program(name, folder), size * (3 * np.sin(np.arange(60) / 5) + rng.normal(size=60))
    y = v = z = 0.0
    for effort in u:
        before = y, v, z
        (status,), (F,), (z,), (v,), (y,) = run("b", z, v, dt, effort, 1.0, y)
        assert status == 0
        assert y == pytest.approx(before[0] + dt * v, rel=1e-12, abs=1e-18)
        assert (v - before[1]) / dt == pytest.approx(effort - F, rel=1e-9, abs=1e-9 * size)
        if name not in STATIC:
            assert z == pytest.approx(before[2] + dt * chosen.rate(v, z), rel=1e-6, abs=1e-10 * 1e-5)
        if name != "stribeck":  # at rest its force is any of a range
            assert chosen.force(v, z) == pytest.approx(F, rel=1e-6, abs=1e-6)


def test_a_law_that_claims_nothing_has_a_time_derivative_where_it_shows_it():
    """It is looked at with a deflection too: |v| z has a derivative at z = 0 only."""

    class Unclaimed(BristleLaw):
        """LuGre without claims."""

        claims = Claims()

        @staticmethod
        def dz_dt(p, v, z):
            return v - abs(v) / p.F_s * p.sigma_0 * z

    own = {"sigma_0": 1e5, "sigma_1": 300.0, "sigma_2": 0.4, "F_c": 1.0, "F_s": 1.5, "v_s": 1e-3}
    assert not Unclaimed(own).differentiable
