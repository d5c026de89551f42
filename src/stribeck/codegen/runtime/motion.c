/* ---- The motion of a body under a law's friction and a measured force: the same for every law. -------------------

   m dv/dt = net_force(F(t), friction(v, z)),   dz/dt = rate(v, z),   dy/dt = v

   Between two samples F, of each lane its own, is a parabola. The equations are integrated by RODAS3, an L-stable Rosenbrock method of order 3
   with an embedded method of order 2 (Sandu, Verwer, Blom, Spee, Carmichael, Potra, Atmospheric Environment
   31(20):3459-3472, 1997).

   Every lane has parameters of its own. All lanes take the steps that lane 0 needs for its tolerances: the differences
   between lanes are then those of one smooth function, and finite differences between them are free of noise.        */

typedef struct { double y, v, z; } State;

/* One step of one lane over h, while the force goes from F0 to F1, at first with dF/dt h = dF; its error. */
static inline State step(const double *p, double m, double F0, double F1, double dF, double h, State x, State *error)
{
    double r_v, r_z, f_v, f_z;
    linearise(p, x.v, x.z, &r_v, &r_z, &f_v, &f_z);
    const double a = 2 / h, b = 1 / h, w = 1 / m;
    const double by_F = -w * net_force_by_F(), vv = a + by_F * f_v, vz = by_F * f_z, zv = -r_v, zz = a - r_z;
    const double det = 1 / (vv * zz - vz * zv);
#define SOLVE(k, ry, rv, rz) \
    State k; \
    { \
        const double right_v = (rv), right_z = (rz); \
        k.v = (right_v * zz - vz * right_z) * det; \
        k.z = (vv * right_z - zv * right_v) * det; \
        k.y = ((ry) + k.v) / a; \
    }
    const double fv = w * net_force(F0, force(p, x.v, x.z)), fz = rate(p, x.v, x.z), ft = w * net_force_by_u() * dF;
    SOLVE(k1, x.v, fv + 0.5 * ft, fz)
    SOLVE(k2, x.v + 4 * b * k1.y, fv + 1.5 * ft + 4 * b * k1.v, fz + 4 * b * k1.z)
    const double v3 = x.v + 2 * k1.v, z3 = x.z + 2 * k1.z;
    SOLVE(k3, v3 + b * (k1.y - k2.y), w * net_force(F1, force(p, v3, z3)) + b * (k1.v - k2.v),
          rate(p, v3, z3) + b * (k1.z - k2.z))
    const double v4 = v3 + k3.v, z4 = z3 + k3.z, c = 8.0 / 3;
    SOLVE(k4, v4 + b * (k1.y - k2.y - c * k3.y), w * net_force(F1, force(p, v4, z4)) + b * (k1.v - k2.v - c * k3.v),
          rate(p, v4, z4) + b * (k1.z - k2.z - c * k3.z))
#undef SOLVE
    *error = k4;
    const State end = {x.y + 2 * k1.y + k3.y + k4.y, v4 + k4.v, z4 + k4.z};
    return end;
}

/* Advance all lanes over dt; h is the step to begin with, then the one to go on with. */
static int advance(int64_t lanes, const double *p, const double *mass, const Arc *arcs, double dt,
                   const double *tolerance, State *x, double *h, int64_t *left)
{
    double s = 0;
    while (s < 1) {
        if ((*left)-- <= 0) return TOO_MANY_STEPS;
        const int last = s * dt + *h * 1.000001 >= dt;
        const double now = last ? (1 - s) * dt : *h, next = last ? 1 : s + now / dt;
        State e, unused;
        const State end = step(p, mass[0], at(arcs, s), at(arcs, next), slope_at(arcs, s) * (now / dt), now, x[0], &e);
        const double ey = fabs(e.y) / tolerance[0], ev = fabs(e.v) / tolerance[1], ez = fabs(e.z) / tolerance[2];
        const double error = fmax(ey, fmax(ev, ez));
        if (!(ey + ev + ez < 1e30)) {
            if (now < 1e-9 * dt) return NOT_FINITE;
            *h = 0.1 * now;
            continue;
        }
        double growth = 0.9 / cbrt(error + 1e-3);
        growth = growth < 0.2 ? 0.2 : growth > 5 ? 5 : growth;
        if (error > 1 && now > 1e-9 * dt) {
            *h = now * growth;
            continue;
        }
        x[0] = end;
        for (int64_t i = 1; i < lanes; i++)
            x[i] = step(p + i * PARAMETERS, mass[i], at(arcs + i, s), at(arcs + i, next),
                        slope_at(arcs + i, s) * (now / dt), now, x[i], &unused);
        s = next;
        if (!last || now * growth > *h) *h = now * growth;
    }
    return DONE;
}

/* Position and velocity of each lane at each of n times, under the force F of each lane. At the sample first[k] window k begins, with the states of its
   lanes; a window ends where the next begins. tolerance: of y, v and z in a step. */
EXPORT int stribeck_move(int64_t n, const double *t, const double *F, const double *bend, int64_t lanes,
                         const double *parameters, const double *mass, int64_t windows, const int64_t *first,
                         const double *states, const double *tolerance, int64_t steps, double *work, Arc *arcs,
                         double *y, double *v)
{
    State *x = (State *)work;
    double h = INFINITY;
    int64_t window = 0;
    for (int64_t i = 0; i < n; i++) {
        if (window < windows && first[window] == i) {
            for (int64_t j = 0; j < lanes; j++) {
                const double *from = states + 3 * (window * lanes + j);
                x[j].y = from[0];
                x[j].v = from[1];
                x[j].z = from[2];
            }
            window++;
            h = INFINITY;
        }
        for (int64_t j = 0; j < lanes; j++) {
            y[j * n + i] = x[j].y;
            v[j * n + i] = x[j].v;
        }
        if (i + 1 == n || (window < windows && first[window] == i + 1)) continue;
        const double dt = t[i + 1] - t[i];
        if (!(h < 1e30)) h = dt;
        for (int64_t j = 0; j < lanes; j++) {
            const Arc arc = {F[j * n + i], F[j * n + i + 1], bend[j * n + i]};
            arcs[j] = arc;
        }
        const int status = advance(lanes, parameters, mass, arcs, dt, tolerance, x, &h, &steps);
        if (status != DONE) return status;
    }
    return DONE;
}
