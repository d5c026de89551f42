/* A mass on a LuGre contact under a PID controller, by equations written apart from Stribeck's: RODAS, a method of Rosenbrock
   type of order 4 (Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.7), whose embedded method of order
   3 gives the error of a step. */
#include <math.h>
#include <string.h>

enum { N = 4, STAGES = 6, QUEUE = 256 };

typedef struct {
    double m, sigma_0, sigma_1, sigma_2, F_c, F_s, v_s;                 /* of mass and contact */
    double K_p, K_i, K_d, r, limit, period, delay, resolution;          /* of the controller; period 0: continuous */
    double t, x[N];                                                     /* time; position, speed, deflection, integral */
    double low, high;                                                   /* of the position, at the solver's steps */
    double h, u, total, last, taken;                                    /* of the solver and the sampled controller */
    double act[QUEUE], asked[QUEUE], first, count;                      /* outputs that are computed, but not yet applied */
} Loop;

static double sign(double x) { return (x > 0) - (x < 0); }

/* The state's rates, and their derivatives J by position, speed, deflection and integral. */
static void rates(const Loop *p, const double *x, double *dx, double J[N][N])
{
    const double v = x[1], z = x[2], held = p->period > 0, w = v / p->v_s;
    const double bend = (p->F_s - p->F_c) * exp(-w * w), g = p->F_c + bend, fall = p->sigma_0 * fabs(v) / g;
    const double u = held ? p->u : -p->K_p * (x[0] - p->r) - p->K_i * x[3] - p->K_d * v;
    dx[0] = v;
    dx[2] = v - fall * z;
    dx[1] = (u - p->sigma_0 * z - p->sigma_1 * dx[2] - p->sigma_2 * v) / p->m;
    dx[3] = x[0] - p->r;
    if (!J) return;
    memset(J, 0, sizeof(double) * N * N);
    J[0][1] = J[3][0] = 1;
    J[2][1] = 1 - p->sigma_0 * z / g * (sign(v) + fabs(v) * bend / g * 2 * w / p->v_s);
    J[2][2] = -fall;
    J[1][1] = (-p->sigma_1 * J[2][1] - p->sigma_2 - (held ? 0 : p->K_d)) / p->m;
    J[1][2] = (-p->sigma_0 + p->sigma_1 * fall) / p->m;
    if (!held) J[1][0] = -p->K_p / p->m, J[1][3] = -p->K_i / p->m;
}

/* One step of h; returns the error in units of what is allowed. */
static double step(const Loop *p, double h, double *y)
{
    static const double A[STAGES][STAGES] = {
        {0}, {1.544}, {0.9466785280815826, 0.2557011698983284},
        {3.314825187068521, 2.896124015972201, 0.9986419139977817},
        {1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950},
        {1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950, 1}};
    static const double C[STAGES][STAGES] = {
        {0}, {-5.6688}, {-2.430093356833875, -0.2063599157091915},
        {-0.1073529058151375, -9.594562251023355, -20.47028614809616},
        {7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160},
        {8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136, -6.058818238834054}};
    static const double ALLOWED[N] = {1e-11, 1e-11, 1e-13, 1e-11};
    double J[N][N], W[N][N], k[STAGES][N], dx[N], error = 0;
    rates(p, p->x, dx, J);
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++) W[i][j] = (i == j) / (0.25 * h) - J[i][j];
    for (int i = 0; i < N; i++) /* no pivots: for the small h that follow from the error, the diagonal leads */
        for (int j = i + 1; j < N; j++) {
            W[j][i] /= W[i][i];
            for (int l = i + 1; l < N; l++) W[j][l] -= W[j][i] * W[i][l];
        }
    for (int s = 0; s < STAGES; s++) {
        double *b = k[s];
        for (int i = 0; i < N; i++) {
            y[i] = p->x[i];
            for (int q = 0; q < s; q++) y[i] += A[s][q] * k[q][i];
        }
        if (s) rates(p, y, dx, 0);
        for (int i = 0; i < N; i++) {
            b[i] = dx[i];
            for (int q = 0; q < s; q++) b[i] += C[s][q] * k[q][i] / h;
            for (int j = 0; j < i; j++) b[i] -= W[i][j] * b[j];
        }
        for (int i = N; i-- > 0;) {
            for (int j = i + 1; j < N; j++) b[i] -= W[i][j] * b[j];
            b[i] /= W[i][i];
        }
    }
    for (int i = 0; i < N; i++) {
        y[i] += k[STAGES - 1][i];
        error = fmax(error, fabs(k[STAGES - 1][i]) / (ALLOWED[i] + 1e-8 * fmax(fabs(y[i]), fabs(p->x[i]))));
    }
    return error;
}

static void solve_to(Loop *p, double end)
{
    while (p->t < end) {
        const int ends = p->t + 1.0001 * p->h >= end;
        const double h = ends ? end - p->t : p->h;
        double y[N];
        const double error = step(p, h, y), factor = fmin(5, fmax(0.1, 0.9 * pow(error + 1e-12, -0.25)));
        if (error <= 1) {
            memcpy(p->x, y, sizeof y);
            p->t = ends ? end : p->t + h;
            p->low = fmin(p->low, y[0]), p->high = fmax(p->high, y[0]);
        }
        if (!(error <= 1) || !ends || factor < 1) p->h = h * (error >= 0 ? factor : 0.1);
        else p->h = fmax(p->h, h * factor);
        if (!(p->h > 1e-15 * (1 + p->t))) return;
    }
}

/* The controller's output from its next sample, whose integral and difference of positions are its own. */
static double sampled_output(Loop *p)
{
    const double y = p->resolution > 0 ? p->resolution * nearbyint(p->x[0] / p->resolution) : p->x[0], e = y - p->r;
    const double v = p->taken > 0 ? (y - p->last) / p->period : 0, u = -p->K_p * e - p->K_i * p->total - p->K_d * v;
    p->last = y;
    if (!(fabs(u) > p->limit && -p->K_i * e * u > 0)) p->total += p->period * e;
    return fmin(p->limit, fmax(-p->limit, u));
}

/* Over the next seconds: positions and outputs' integral parts (continuous), or positions and outputs at the samples. Returns how
   many were written. */
int march(Loop *p, double seconds, int rows, double *positions, double *outputs)
{
    const double begun = p->t, end = p->t + seconds;
    int row = 0;
    p->low = p->high = p->x[0];
    if (!(p->period > 0)) {
        for (; row < rows; row++) {
            solve_to(p, begun + seconds * row / (rows - 1));
            positions[row] = p->x[0], outputs[row] = p->K_i * p->x[3];
        }
        return row;
    }
    while (p->t < end && fabs(p->x[0]) < 1e8 && row < rows) {
        const double sample = p->taken * p->period, act = p->count > 0 ? p->act[(int)p->first] : INFINITY;
        solve_to(p, fmin(sample, act));
        if (sample <= act) {
            const int to = ((int)p->first + (int)p->count++) % QUEUE;
            if (p->count > QUEUE) return -1;
            p->act[to] = p->t + p->delay;
            p->asked[to] = sampled_output(p);
            p->taken++;
            positions[row] = p->x[0], outputs[row++] = p->asked[to];
        } else {
            p->u = p->asked[(int)p->first];
            p->first = ((int)p->first + 1) % QUEUE, p->count--;
        }
    }
    return row;
}
