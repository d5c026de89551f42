/* A body with friction, by equations written apart from Stribeck's: Radau IIA of order 5 in extended precision, the error
   of a step from two steps of half its length, and a step's end at every row. */
#include <math.h>
#include <string.h>

typedef long double real;
enum { MOST = 4 };
enum { LUGRE, ARCTAN, SOBCZYK, MAJORANT, ELASTIC, ELASTIC_SOBCZYK, ELASTIC_MAJORANT, DAHL, VISCOUS, STRIBECK };
enum { FORCE, SPRING, PID };
enum { STEP, SINE, RAMP };

typedef struct {
    double law, drive, signal, mass, sigma_0, sigma_1, sigma_2, F_c, F_s, v_s, k_v, z_ba;
    double stiffness, K_p, K_i, K_d, value, time, frequency, rate, t_end, tolerance, most;
} Problem;

static real sign(real x) { return (x > 0) - (x < 0); }
static const real PI = 3.14159265358979323846264338327950288L;

static int states(const Problem *p) { return p->drive == PID ? 4 : 3; }

static real signal_at(const Problem *p, real t, int late)
{
    if (p->signal == STEP) return late ? p->value : 0;
    return p->signal == SINE ? p->value * sinl(2 * PI * (real)p->frequency * t) : p->rate * t;
}

/* dz/dt and the friction force */
static void friction(const Problem *p, real v, real z, real *rate, real *F)
{
    const int law = (int)p->law;
    const real level = p->F_c + ((real)p->F_s - p->F_c) * expl(-(v / p->v_s) * (v / p->v_s));
    const real S = 2 / PI * atanl(p->k_v * v), major = v * S + 2 / (PI * p->k_v);
    if (law == VISCOUS || law == STRIBECK) {
        *rate = 0;
        *F = S * (law == VISCOUS ? (real)p->F_c : level) + p->sigma_2 * v;
        return;
    }
    const real g = (law == DAHL ? (real)p->F_c : level) / p->sigma_0;
    const int kind = law == ELASTIC ? LUGRE : law == ELASTIC_SOBCZYK ? SOBCZYK : law == ELASTIC_MAJORANT ? MAJORANT : law;
    const real fall = kind == LUGRE || kind == DAHL ? fabsl(v) : kind == MAJORANT ? major : v * S;
    real share = 1;
    if (law >= ELASTIC && law <= ELASTIC_MAJORANT) {
        real s = (fabsl(z) - p->z_ba) / (g - p->z_ba);
        s = s < 0 ? 0 : s > 1 ? 1 : s;
        share = law == ELASTIC_MAJORANT ? s * s * s * (10 - 15 * s + 6 * s * s) : 0.5L + 0.5L * sinl(PI * (s - 0.5L));
        if (law == ELASTIC && v * z <= 0) share = 0;
    }
    *rate = (kind == SOBCZYK ? S * S * v : v) - share * fall / g * z;
    *F = law == DAHL ? p->sigma_0 * z : p->sigma_0 * z + p->sigma_1 * *rate + p->sigma_2 * v;
}

static void rates(const Problem *p, real t, int late, const real *x, real *dx, real *F)
{
    const real value = signal_at(p, t, late);
    real u = value;
    friction(p, x[1], x[2], dx + 2, F);
    if (p->drive == SPRING) u = p->stiffness * (value - x[0]);
    if (p->drive == PID) {
        u = p->K_p * (value - x[0]) + p->K_i * x[3] - p->K_d * x[1];
        dx[3] = value - x[0];
    }
    dx[0] = x[1];
    dx[1] = (u - *F) / p->mass;
}

static int solve(real a[3 * MOST][3 * MOST + 1], int n)
{
    for (int i = 0; i < n; i++) {
        int best = i;
        for (int k = i; k < n; k++)
            if (fabsl(a[k][i]) > fabsl(a[best][i])) best = k;
        if (!(fabsl(a[best][i]) > 0)) return 0;
        for (int j = i; j <= n && best != i; j++) {
            const real swap = a[i][j];
            a[i][j] = a[best][j];
            a[best][j] = swap;
        }
        for (int k = i + 1; k < n; k++) {
            const real f = a[k][i] / a[i][i];
            if (f != 0)
                for (int j = i; j <= n; j++) a[k][j] -= f * a[i][j];
        }
    }
    for (int i = n; i-- > 0;) {
        for (int j = i + 1; j < n; j++) a[i][n] -= a[i][j] * a[j][n];
        a[i][n] /= a[i][i];
    }
    return 1;
}

/* One step of Radau IIA; 0 where Newton's method does not converge. */
static int step(const Problem *p, real t, real h, int late, const real *x, real *y)
{
    const real q = sqrtl(6.0L), c[3] = {(4 - q) / 10, (4 + q) / 10, 1};
    const real A[3][3] = {{(88 - 7 * q) / 360, (296 - 169 * q) / 1800, (-2 + 3 * q) / 225},
                          {(296 + 169 * q) / 1800, (88 + 7 * q) / 360, (-2 - 3 * q) / 225},
                          {(16 - q) / 36, (16 + q) / 36, 1.0L / 9}};
    const int n = states(p);
    real z[3][MOST] = {{0}}, f[3][MOST], a[3 * MOST][3 * MOST + 1], J[3][MOST][MOST], F, last = 1e300L;
    for (int turn = 0; turn < 30; turn++) {
        for (int i = 0; i < 3; i++) {
            real at[MOST], g[MOST];
            for (int j = 0; j < n; j++) at[j] = x[j] + z[i][j];
            rates(p, t + c[i] * h, late, at, f[i], &F);
            if (turn > 6 && turn % 4) continue;
            for (int k = 0; k < n; k++) {
                const real kept = at[k], scale = fabsl(kept) + fabsl(h * f[i][k]), d = 1e-9L * (scale > 0 ? scale : 1e-30L);
                at[k] = kept + d;
                rates(p, t + c[i] * h, late, at, g, &F);
                at[k] = kept;
                for (int j = 0; j < n; j++) J[i][j][k] = (g[j] - f[i][j]) / d;
            }
        }
        real size[MOST], change = 0;
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < n; j++) {
                real *row = a[i * n + j];
                for (int m = 0; m < 3; m++)
                    for (int k = 0; k < n; k++) row[m * n + k] = (i == m && j == k) - h * A[i][m] * J[m][j][k];
                row[3 * n] = -z[i][j];
                for (int m = 0; m < 3; m++) row[3 * n] += h * A[i][m] * f[m][j];
            }
        if (!solve(a, 3 * n)) return 0;
        for (int j = 0; j < n; j++) size[j] = fabsl(x[j]) + fabsl(z[0][j]) + fabsl(z[1][j]) + fabsl(z[2][j]);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < n; j++) {
                const real d = a[i * n + j][3 * n];
                z[i][j] += d;
                const real share = fabsl(d) / (size[j] + fabsl(z[i][j]) + 1e-4000L);
                if (!(share <= change)) change = share;
            }
        if (!(change < 1e30L)) return 0;
        if (change < 2e-18L || (change < 1e-15L && change >= last)) {
            for (int j = 0; j < n; j++) y[j] = x[j] + z[2][j];
            return 1;
        }
        last = change;
    }
    return 0;
}

/* Rows of t, y, v, z, F, and the peaks of the same over the motion, at each step; how many rows were reached. */
int reference(const Problem *p, int rows, double row_step, double *out, double *peaks)
{
    real x[MOST] = {0}, t = 0, h = (real)row_step * 1e-6L, peak[MOST] = {0}, peak_F = 0, F, dx[MOST];
    const int n = states(p);
    double left = p->most;
    int late = p->signal == STEP && p->time <= 0;
    for (int row = 0; row < rows; row++) {
        const real end = (real)row * (real)row_step;
        while (t < end) {
            real stop = end;
            if (p->signal == STEP && !late && p->time < end) stop = p->time;
            if (t >= stop) {
                late = 1;
                h = 1e-9L * (real)row_step;
                continue;
            }
            const int ends = t + h * 1.0001L >= stop;
            const real length = ends ? stop - t : h;
            real whole[MOST], half[MOST], two[MOST], F_whole, F_two, error = 0;
            if (left-- <= 0) return row;
            int good = step(p, t, length, late, x, whole) && step(p, t, length / 2, late, x, half);
            good = good && step(p, t + length / 2, length / 2, late, half, two);
            if (good) {
                rates(p, t + length, late, whole, dx, &F_whole);
                rates(p, t + length, late, two, dx, &F_two);
                for (int j = 0; j < n; j++) {
                    const real size = fmaxl(peak[j], fabsl(two[j])) + 1e-60L;
                    error = fmaxl(error, fabsl(two[j] - whole[j]) / size / p->tolerance);
                }
                error = fmaxl(error, fabsl(F_two - F_whole) / (fmaxl(peak_F, fabsl(F_two)) + 1e-60L) / (100 * p->tolerance));
                good = error <= 1;
                if (x[1] * two[1] < 0 && fabsl(x[1]) > p->v_s && fabsl(two[1]) > p->v_s && length > 1e-15L * t) {
                    h = length * x[1] / (x[1] - two[1]); /* a narrow Stribeck peak lies within */
                    continue;
                }
            } else
                error = 1e5L;
            if (good) {
                memcpy(x, two, sizeof x);
                t = ends ? stop : t + length;
                for (int j = 0; j < n; j++) peak[j] = fmaxl(peak[j], fabsl(x[j]));
                peak_F = fmaxl(peak_F, fabsl(F_two));
                peaks[0] = (double)t, peaks[4] = (double)peak_F;
                for (int j = 0; j < 3; j++) peaks[j + 1] = (double)peak[j];
            }
            real factor = 0.9L * powl(error + 1e-10L, -1.0L / 6);
            factor = fminl(4, fmaxl(0.1L, factor));
            if (!ends || !good || factor < 1) h = length * factor;
            if (!(h > 1e-17L * (t + length))) return row;
        }
        if (p->signal == STEP && !late && p->time <= t) late = 1, h = 1e-9L * (real)row_step; /* the value from then on */
        rates(p, t, late, x, dx, &F);
        double *to = out + 5 * row;
        to[0] = (double)t, to[1] = (double)x[0], to[2] = (double)x[1], to[3] = (double)x[2], to[4] = (double)F;
    }
    return rows;
}
