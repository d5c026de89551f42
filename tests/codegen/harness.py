"""The functions of generated C, one by one: the source plus a few exported wrappers, compiled without optimization."""

import ctypes
import subprocess

from stribeck.codegen import source
from stribeck.simulation import compiler

_WRAPPERS = """
/* n steps of length h, accepted whatever their error: no step control. */
EXPORT void test_steps(Run *run, double h, int n, double s, double *inside)
{
    const Parameters *p = (const Parameters *)run->parameters;
    const Segment piece = {0, run->piece_rows[1], 0};
    Coefficients c;
    prepare(p, &c);
    for (int step = 0; step < n; step++) {
        double k[STAGES][N], x_new[N], d[3];
        Attempt now;
        rates(p, &c, &piece, run->t, run->x, now.f0);
        jacobian(p, &c, &piece, run->t, run->x, &now.jac, now.df_dt);
        begin_attempt(p, &c, h, &now);
        for (int stage_ = 0; stage_ < STAGES; stage_++) stage(stage_, p, &c, &piece, run->t, run->x, &now, k, x_new);
        end_attempt(run->atol, run->rtol, run->x, k, x_new);
        for (int i = 0; i < N; i++) {
            dense(k, i, d);
            inside[step * N + i] = interpolate(s, run->x[i], x_new[i], d[0], d[1], d[2]);
        }
        for (int i = 0; i < N; i++) run->x[i] = x_new[i];
        run->t += h;
    }
}

#if WATCHES > 0
EXPORT int test_events(double level, double v0, double v1, const double *d, double *s, int8_t *what)
{
    double b[5];
    bernstein_of_dense(v0, v1, d[0], d[1], d[2], b);
    return events_within(level, b, s, what);
}
EXPORT void test_values(const double *f, double *b) { bernstein_of_values(f, b); }
#endif
"""


def compiled(system, folder):
    """The source of a system with the wrappers, loaded."""
    code, library = folder / "system.c", folder / "system.so"
    code.write_text(source(system) + _WRAPPERS)
    chosen = compiler.find()
    subprocess.run([*chosen.command, "-O0", "-fPIC", "-shared", "-o", library, code, "-lm"], check=True)
    return ctypes.CDLL(str(library))
