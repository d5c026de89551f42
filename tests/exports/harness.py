"""Exported C, compiled with a driver that reads calls from its input and prints what they return."""

import shutil
import subprocess
from functools import lru_cache

import numpy as np
import pytest

import stribeck
from stribeck import laws

STRICT = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror")
SANITIZE = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g")
MAKKAR = {"g1": 0.25, "g2": 100.0, "g3": 10.0, "g4": 0.1, "g5": 100.0, "g6": 0.01}
LINEAR = ("lugre", "lugre_arctan", "lugre_sobczyk", "lugre_majorant", "dahl")
ELASTOPLASTIC = ("elastoplastic", "elastoplastic_sobczyk", "elastoplastic_majorant")
STATIC = ("coulomb_viscous", "stribeck", "makkar")
LAWS = (*LINEAR, *ELASTOPLASTIC, *STATIC)

_DRIVER = """
#include <stdio.h>
#include <stdlib.h>
#include "@.h"
int main(void)
{
    char line[512];
    while (fgets(line, sizeof line, stdin)) {
        double a[6] = {0, 0, 0, 0, 0, 0};
        @_real x[6], F = 0;
        @_parameters p;
        @_state s = {0};
        char *at = line + 1;
        int status = -1;
        @_defaults(&p);
        for (int i = 0; i < 6; ++i) a[i] = strtod(at, &at);
        for (int i = 0; i < 6; ++i) x[i] = (@_real)a[i];
        s.z = x[0];
        switch (line[0]) {
        case 'f': status = @_force(&p, x[1], x[0], &F); break;
        case 'r': status = @_rate(&p, x[1], x[0], &F); break;
        case 's': status = @_steady_force(&p, x[1], &F); break;
        case 't': status = @_step(&p, &s, x[1], x[2], &F); break;
        case 'c': {
            const @_compensator c = { x[3], x[2] };
            status = @_compensate(&p, &c, &s, x[1], &F);
            break;
        }
#ifdef SMOOTH
        case 'd': status = @_force_rate(&p, x[1], x[0], x[2], &F); break;
#endif
#ifdef OBSERVER
        case 'o': status = @_observer_step(&p, &s, x[1], x[3], x[4], x[2], &F); break;
#endif
        case 'b': {
            @_body b;
            b.y = x[5]; b.v = x[1]; b.z = x[0];
            status = @_body_step(&p, &b, x[4], x[3], x[2], &F);
            printf("%d %a %a %a %a\\n", status, (double)F, (double)b.z, (double)b.v, (double)b.y);
            continue;
        }
        case 'p':
            if (a[0] > 0) ((@_real *)&p)[(int)a[0] - 1] = x[1];
            status = @_check(&p);
            break;
        default: break;
        }
        printf("%d %a %a\\n", status, (double)F, (double)s.z);
    }
    return 0;
}
"""


def law(name, **changes):
    values = dict(stribeck.library().sets["canudas1995"].values)
    own = {"k_v": 1e7, "z_ba": 7e-6, **MAKKAR} | changes
    constants = laws.find(name).constants()
    if name == "stribeck":
        own.pop("k_v")
    return stribeck.law(name, {n: x for n, x in (values | own).items() if n in constants})


def need(*tools):
    for tool in tools:
        if shutil.which(tool) is None:
            pytest.skip(f"{tool} is not installed")


def output_of(folder, *sources, cc="gcc", flags=("-O2",), run=(), given=None, words=()):
    """What a program of these C files prints, which are compiled without a warning; ``run``: what runs it."""
    need(cc, *run[:1])
    command = [cc, *STRICT, *flags, *map(str, sources), "-o", "program", "-lm"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    command = [*run, str(folder / "program"), *words]
    return subprocess.run(command, input=given, capture_output=True, text=True, check=True).stdout


class Program:
    """A compiled export, to be called many times at once."""

    def __init__(self, command):
        self.command = command

    def __call__(self, op, *columns):
        """One row a call: status and results, for the arguments in the order of the driver."""
        columns = np.broadcast_arrays(*(np.asarray(c, float) for c in columns))
        rows = zip(*(c.ravel() for c in columns), strict=True)
        lines = "".join(f"{op} {' '.join(float(x).hex() if np.isfinite(x) else str(x) for x in row)}\n" for row in rows)
        done = subprocess.run(self.command, input=lines, capture_output=True, text=True, check=False, timeout=120)
        assert done.returncode == 0, done.stderr
        answers = [line.split() for line in done.stdout.splitlines()]
        return np.array([[int(status), *map(float.fromhex, rest)] for status, *rest in answers]).T


@lru_cache(maxsize=64)
def _exported(name, folder):
    stribeck.export(law(name), "c", folder / name, self_test=True)
    return folder / name


@lru_cache(maxsize=256)
def program(name, folder, cc="gcc", flags=("-O2",), single=False, run=()):
    """The law's export with the driver, compiled into ``folder``."""
    need(cc, *run[:1])
    source = _exported(name, folder)
    (source / "driver.c").write_text(_DRIVER.replace("@", name))
    defines = [f"-D{name.upper()}_FLOAT"] * single + ["-DOBSERVER"] * (name not in STATIC)
    defines += ["-DSMOOTH"] * ("_force_rate" in (source / f"{name}.h").read_text())
    target = source / f"driver-{cc}-{single}{'-'.join(flags).replace('/', '')[:40]}"
    sources = [str(source / f"{name}.c"), str(source / "driver.c")]
    done = subprocess.run(
        [cc, *STRICT, *flags, *defines, *sources, "-o", str(target), "-lm"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert not done.stderr
    return Program([*run, str(target)])
