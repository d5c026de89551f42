/* ---- The answer of a law to a measured velocity: the same for every law. ---------------------------------------

   Between two samples v is a parabola, cut where it passes through 0, because |v| has a corner there. Each piece is
   integrated by RODAS3, an L-stable Rosenbrock method of order 3 with an embedded method of order 2 (Sandu, Verwer,
   Blom, Spee, Carmichael, Potra, Atmospheric Environment 31(20):3459-3472, 1997).

   Every lane has parameters of its own. All lanes take the steps that lane 0 needs for its tolerance: the differences
   between lanes are then those of one smooth function, and finite differences between them are free of noise.        */

EXPORT int64_t stribeck_parameters(void) { return PARAMETERS; }

/* One step of one lane from z, over h, while v goes from v0 to v1, at first with dv/dt h = dv; the error to *error. */
static inline double step(const double *p, double v0, double v1, double dv, double h, double z, double *error)
{
    double f, f_z, f_v;
    /* a derivative by v exactly on a corner would belong to neither side */
    linearise(p, v0 == 0 ? 1e-9 * v1 : v0, z, &f_z, &f_v);
    f = rate(p, v0, z);
    const double slope_h = f_v * dv, inv_h = 1 / h; /* h df/dt */
    const double k = 1 / (2 * inv_h - f_z);
    const double k1 = (f + 0.5 * slope_h) * k;
    const double k2 = (f + 1.5 * slope_h + 4 * inv_h * k1) * k;
    const double k3 = (rate(p, v1, z + 2 * k1) + inv_h * (k1 - k2)) * k;
    const double k4 = (rate(p, v1, z + 2 * k1 + k3) + inv_h * (k1 - k2 - (8.0 / 3) * k3)) * k;
    *error = fabs(k4);
    return z + 2 * k1 + k3 + k4;
}

/* Advance all lanes from the share s to the share end of an arc that takes dt; v is 0 exactly where zero_at says (0: at
   the start, 1: at the end, else nowhere). h is the step to begin with, then the one to go on with. */
static int advance(int64_t lanes, const double *p, const Arc *arc, double dt, double s, double end, int zero_at,
                   double tolerance, double *z, double *h, int64_t *left)
{
    double v = zero_at == 0 ? 0 : at(arc, s);
    while (s < end) {
        if ((*left)-- <= 0) return TOO_MANY_STEPS;
        const int last = s * dt + *h * 1.000001 >= end * dt;
        const double now = last ? (end - s) * dt : *h, next = last ? end : s + now / dt;
        const double v_next = last && zero_at == 1 ? 0 : at(arc, next), dv = slope_at(arc, s) * (now / dt);
        double error, unused;
        const double z_new = step(p, v, v_next, dv, now, z[0], &error);
        if (!(error < 1e30)) {
            if (now < 1e-12 * dt) return NOT_FINITE;
            *h = 0.1 * now;
            continue;
        }
        double growth = 0.9 * cbrt(tolerance / (error + 1e-3 * tolerance));
        growth = growth < 0.2 ? 0.2 : growth > 5 ? 5 : growth;
        if (error > tolerance) {
            *h = now * growth;
            continue;
        }
        z[0] = z_new;
        for (int64_t i = 1; i < lanes; i++) z[i] = step(p + i * PARAMETERS, v, v_next, dv, now, z[i], &unused);
        s = next;
        v = v_next;
        if (!last || now * growth > *h) *h = now * growth;
    }
    return DONE;
}

/* Where an arc passes through zero, for ends of different signs. */
static double zero_of(const Arc *arc)
{
    double s = arc->first / (arc->first - arc->last);
    for (int i = 0; i < 3; i++) {
        const double better = s - at(arc, s) / slope_at(arc, s);
        if (!(better > 0 && better < 1)) break;
        s = better;
    }
    return s;
}

/* The friction force of each lane at each of n times; z holds each lane's deflection at the first and then at the last
   time. shift, where it is given, is what each lane's parameters grow by at each time, times gain: friction that varies
   with load, pressure or place; it holds from its sample to the next. */
EXPORT int stribeck_respond(int64_t n, const double *t, const double *v, const double *bend, int64_t lanes,
                            const double *parameters, const double *shift, const double *gain, double tolerance,
                            int64_t steps, double *present, double *z, double *force_out)
{
    double h = INFINITY;
    const int64_t count = lanes * PARAMETERS;
    for (int64_t j = 0; j < count; j++) present[j] = parameters[j];
    for (int64_t i = 0; i < n; i++) {
        if (shift)
            for (int64_t j = 0; j < count; j++)
                present[j] = parameters[j] + gain[j % PARAMETERS] * shift[j / PARAMETERS * n + i];
        for (int64_t j = 0; j < lanes; j++)
            force_out[j * n + i] = force(present + j * PARAMETERS, v[i], z[j]);
        if (i + 1 == n) break;
        const double dt = t[i + 1] - t[i];
        if (!(h > 0)) h = dt;
        const Arc arc = {v[i], v[i + 1], bend[i]};
        int status;
        if (v[i] * v[i + 1] < 0) {
            const double cut = zero_of(&arc);
            status = advance(lanes, present, &arc, dt, 0, cut, 1, tolerance, z, &h, &steps);
            if (status == DONE) status = advance(lanes, present, &arc, dt, cut, 1, 0, tolerance, z, &h, &steps);
        } else
            status = advance(lanes, present, &arc, dt, 0, 1, -1, tolerance, z, &h, &steps);
        if (status != DONE) return status;
    }
    return DONE;
}
