/* ---- The solver: the same for every system. -----------------------------------------------------------------------

   Rodas5P: an L-stable Rosenbrock method of order 5 with an embedded method of order 4 and dense output of order 4
   (G. Steinebach, Construction of Rosenbrock-Wanner method Rodas5P and numerical benchmarks within the Julia
   Differential Equations package, BIT Numerical Mathematics 63:27, 2023), in the form that needs no product with the
   Jacobian (Hairer, Wanner, Solving Ordinary Differential Equations II, section IV.7):

       (I/(h gamma) - J) k_i = f(t + c_i h, x + sum A_ij k_j) + sum (C_ij/h) k_j + h d_i df/dt                      */

#define STAGES 8
#if defined(__clang__)
#define UNROLL _Pragma("unroll")
#elif defined(__GNUC__)
#define UNROLL _Pragma("GCC unroll 8")
#else
#define UNROLL
#endif
#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

static const double GAMMA = 0.21193756319429014;
static const double NODE[STAGES] = {
    0, 0.6358126895828704, 0.4095798393397535, 0.9769306725060716, 0.4288403609558664, 1, 1, 1};
static const double TIME[STAGES] = {
    0.21193756319429014, -0.42387512638858027, -0.3384627126235924, 1.8046452872882734, 2.325825639765069, 0, 0, 0};
static const double A[STAGES][STAGES] = {
    {0},
    {3.0},
    {2.849394379747939, 0.45842242204463923},
    {-6.954028509809101, 2.489845061869568, -10.358996098473584},
    {2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641},
    {-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946},
    {-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946, 1.0},
    {-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946, 1.0, 1.0}};
static const double C[STAGES][STAGES] = {
    {0},
    {-14.155112264123755},
    {-17.97296035885952, -2.859693295451294},
    {147.12150275711716, -1.41221402718213, 71.68940251302358},
    {165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306},
    {24.854864614690072, -3.0009227002832186, 47.4931110020768, 5.5814197821558125, -0.6610691825249471},
    {30.91273214028599, -3.1208243349937974, 77.79954646070892, 34.28646028294783, -19.097331116725623,
     -28.087943162872662},
    {37.80277123390563, -3.2571969029072276, 112.26918849496327, 66.9347231244047, -40.06618937091002,
     -54.66780262877968, -9.48861652309627}};
static const double DENSE[3][STAGES] = {
    {25.948786856663858, -2.5579724845846235, 10.433815404888879, -2.3679251022685204, 0.524948541321073,
     1.1241088310450404, 0.4272876194431874, -0.17202221070155493},
    {-9.91568850695171, -0.9689944594115154, 3.0438037242978453, -24.495224566215796, 20.176138334709044,
     15.98066361424651, -6.789040303419874, -6.710236069923372},
    {11.419903575922262, 2.8879645146136994, 72.92137995996029, 80.12511834622643, -52.072871366152654,
     -59.78993625266729, -0.15582684282751913, 4.883087185713722}};

/* What Python and C share; the same fields in the same order stand in simulation/native.py. */
typedef struct {
    const double *parameters;   /* the fields of Parameters */
    const double *atol;         /* absolute tolerance of each state */
    double *x;                  /* the state at t, advanced in place */
    const double *piece_start;  /* the signal's straight pieces: when each begins, its value then, its slope */
    const double *piece_value;
    const double *piece_slope;
    double *out;                /* rows of states, row i at time i * step */
    double *event_time;         /* slip and stick instants */
    int8_t *event_rises;        /* 1 where |v| rises through the threshold (slip), 0 where it falls (stick) */
    double rtol, t, t_end, h, h_limit, step, threshold;
    double h_smallest, h_largest;
    double last_h, last_error;  /* of the last accepted step */
    int64_t pieces, piece, rows, row, event_room, events;
    int64_t accepted, rejected, rates, jacobians, attempts_left;
    int64_t rejected_last, restart;
} Run;

enum { JUMP = 1, CORNER = 2 }; /* why a run restarts with a step of unknown length */

enum { DONE = 0, MORE = 1, EVENTS_FULL = 2, STEP_TOO_SMALL = -1, NOT_FINITE = -2 };

EXPORT int64_t stribeck_run_size(void) { return (int64_t)sizeof(Run); }
EXPORT int64_t stribeck_states(void) { return N; }

static inline double larger(double a, double b) { return a > b ? a : b; }
static inline double smaller(double a, double b) { return a < b ? a : b; }

/* Mean square of values, each in units of its tolerance for magnitudes between |x0| and |x1|. */
static inline double scaled_square(const Run *run, const double *x0, const double *x1, const double *values)
{
    double sum = 0;
    for (int i = 0; i < N; i++) {
        const double scale = run->atol[i] + run->rtol * larger(fabs(x0[i]), fabs(x1[i]));
        const double ratio = values[i] / scale;
        sum += ratio * ratio;
    }
    return sum * (1.0 / N);
}

/* A first step after a start or a jump (Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, II.4). */
static double first_step(const Run *run, const Parameters *p, const Coefficients *c, const Segment *piece, double room)
{
    double zero[N], f0[N], f1[N], x1[N];
    for (int i = 0; i < N; i++) zero[i] = 0;
    rates(p, c, piece, run->t, run->x, f0);
    const double d0 = sqrt(scaled_square(run, run->x, run->x, run->x)), d1 = sqrt(scaled_square(run, run->x, zero, f0));
    double h0 = (d0 < 1e-5 || d1 < 1e-5) ? 1e-6 : 0.01 * d0 / d1;
    h0 = smaller(h0, room);
    for (int i = 0; i < N; i++) x1[i] = run->x[i] + h0 * f0[i];
    rates(p, c, piece, run->t + h0, x1, f1);
    for (int i = 0; i < N; i++) f1[i] -= f0[i];
    const double d2 = sqrt(scaled_square(run, run->x, zero, f1)) / h0, d = larger(d1, d2);
    const double h1 = d <= 1e-15 ? larger(1e-6, h0 * 1e-3) : pow(0.01 / d, 0.2);
    const double h = smaller(smaller(100 * h0, h1), room);
    return h > 0 && isfinite(h) ? h : smaller(1e-6, room);
}

/* Coefficients of the dense output x(t + s h) = (1-s) x0 + s (x1 + (1-s) (d0 + s (d1 + s d2))). */
static inline void dense(double k[STAGES][N], int i, double d[3])
{
    UNROLL for (int m = 0; m < 3; m++)
    {
        double sum = 0;
        UNROLL for (int s = 0; s < STAGES; s++) sum += DENSE[m][s] * k[s][i];
        d[m] = sum;
    }
}

static inline double interpolate(double s, double x0, double x1, const double d[3])
{
    return (1 - s) * x0 + s * (x1 + (1 - s) * (d[0] + s * (d[1] + s * d[2])));
}

#if V_STATE >= 0
/* Find every s in (s0, s1] where the quartic with Bernstein coefficients b passes through zero, in order; b's first and
   last values lie at s0 and s1. A polynomial stays between its coefficients, so an interval without a change of sign
   among them holds no root, and one with a single change holds exactly one (Descartes). */
static int crossings(const double b[5], double noise, double s0, double s1, int depth, double *found, int8_t *rises,
                     int count)
{
    int changes = 0, flat = 1;
    for (int i = 0; i < 4; i++) changes += (b[i] >= 0) != (b[i + 1] >= 0);
    for (int i = 0; i < 5; i++) flat &= fabs(b[i]) <= noise; /* rounding has signs of its own */
    if (changes == 0 || count >= 8) return count;
    if (flat || depth > 50 || (changes == 1 && s1 - s0 < 1e-14)) {
        if ((b[0] >= 0) != (b[4] >= 0)) {
            found[count] = s1;
            rises[count++] = b[4] >= 0;
        }
        return count;
    }
    double left[5], right[5], w[5];
    for (int i = 0; i < 5; i++) w[i] = b[i];
    for (int level = 0; level < 5; level++) { /* de Casteljau at the middle */
        left[level] = w[0];
        right[4 - level] = w[4 - level];
        for (int i = 0; i < 4 - level; i++) w[i] = 0.5 * (w[i] + w[i + 1]);
    }
    const double middle = 0.5 * (s0 + s1);
    count = crossings(left, noise, s0, middle, depth + 1, found, rises, count);
    return crossings(right, noise, middle, s1, depth + 1, found, rises, count);
}

/* Note where |v| passes the threshold within the step from t to t + h. */
static void note_events(Run *run, double t, double h, double v0, double v1, const double d[3])
{
    double b[5] = {v0, v0 + 0.25 * (v1 - v0) + 0.25 * d[0], 0.5 * (v0 + v1) + d[0] / 3 + d[1] / 6,
                   v0 + 0.75 * (v1 - v0) + 0.25 * (d[0] + d[1] + d[2]), v1};
    double lowest = b[0], highest = b[0];
    for (int i = 1; i < 5; i++) {
        lowest = smaller(lowest, b[i]);
        highest = larger(highest, b[i]);
    }
    const double level = run->threshold, noise = 1e-14 * larger(level, larger(fabs(lowest), fabs(highest)));
    if (!(highest - lowest < 1e100)) return; /* a run that is about to fail */
    if ((lowest > -level && highest < level) || lowest >= level || highest <= -level) return;
    double s[16], shifted[5];
    int8_t rises[16];
    for (int i = 0; i < 5; i++) shifted[i] = b[i] - level;
    int count = crossings(shifted, noise, 0, 1, 0, s, rises, 0);
    const int upper = count;
    for (int i = 0; i < 5; i++) shifted[i] = -b[i] - level;
    count += crossings(shifted, noise, 0, 1, 0, s + upper, rises + upper, 0);
    for (int i = 1; i < count; i++) { /* two sorted lists into one */
        const double si = s[i];
        const int8_t ri = rises[i];
        int at = i;
        for (; at > 0 && s[at - 1] > si; at--) {
            s[at] = s[at - 1];
            rises[at] = rises[at - 1];
        }
        s[at] = si;
        rises[at] = ri;
    }
    for (int i = 0; i < count; i++) {
        run->event_time[run->events] = t + s[i] * h;
        run->event_rises[run->events++] = rises[i];
    }
}
#endif

/* One attempt at a step of length h from run->x: the stages, the new state and its error against the tolerances. */
static inline double attempt(const Run *run, const Parameters *p, const Coefficients *c, const Segment *piece,
                             const Jacobian *jac, const double *f0, const double *df_dt, double h, double k[STAGES][N],
                             double *x_new)
{
    Factors fac;
    const double shift = 1 / (GAMMA * h), inv_h = 1 / h;
    factorise(p, c, jac, shift, &fac);
    UNROLL for (int s = 0; s < STAGES; s++)
    {
        double right[N];
        if (s == 0) {
            for (int i = 0; i < N; i++) right[i] = f0[i];
        } else {
            for (int i = 0; i < N; i++) {
                double x = run->x[i];
                UNROLL for (int j = 0; j < s; j++) x += A[s][j] * k[j][i];
                x_new[i] = x;
            }
            rates(p, c, piece, run->t + NODE[s] * h, x_new, right);
            for (int i = 0; i < N; i++) {
                double sum = 0;
                UNROLL for (int j = 0; j < s; j++) sum += C[s][j] * k[j][i];
                right[i] += sum * inv_h;
            }
        }
        if (TIME[s] != 0)
            for (int i = 0; i < N; i++) right[i] += TIME[s] * h * df_dt[i];
        solve(p, c, jac, shift, &fac, right, k[s]);
    }
    for (int i = 0; i < N; i++) x_new[i] += k[STAGES - 1][i];
    return scaled_square(run, run->x, x_new, k[STAGES - 1]);
}

/* Factor for the next step from the squared error of this one: 0.9 error^(-1/5) within [0.2, 5]. */
static inline double growth(double square)
{
    return smaller(5.0, larger(0.2, 0.9 * (double)powf((float)larger(square, 1e-20), -0.1f)));
}

/* Advance the run until it is done, fails, or has used its attempts; call again to go on. */
EXPORT int stribeck_advance(Run *run)
{
    const Parameters parameters = *(const Parameters *)run->parameters, *p = &parameters;
    Coefficients coefficients, *c = &coefficients;
    prepare(p, c);
    double k[STAGES][N], x_new[N], f0[N], df_dt[N];
    Jacobian jac;
    int fresh = 0; /* f0 and the Jacobian belong to the present state */
    while (run->t < run->t_end) {
        if (run->attempts_left-- <= 0) return MORE;
        if (run->events + 16 > run->event_room) return EVENTS_FULL;
        const int64_t n = run->piece;
        const Segment piece = {run->piece_start[n], run->piece_value[n], run->piece_slope[n]};
        double t_stop = n + 1 < run->pieces ? smaller(run->piece_start[n + 1], run->t_end) : run->t_end;
        if (run->restart) {
            /* a long step over a corner would damp the fast motion it sets off, and nothing would tell */
            const double ease = run->restart == CORNER ? 16 : 1;
            run->h = smaller(run->h, ease * first_step(run, p, c, &piece, t_stop - run->t));
            run->rates += 2;
            run->restart = run->rejected_last = 0;
            run->last_h = 0;
        }
        if (!fresh) {
            rates(p, c, &piece, run->t, run->x, f0);
            jacobian(p, c, &piece, run->t, run->x, &jac, df_dt);
            run->rates++;
            run->jacobians++;
            fresh = 1;
        }
        double h = smaller(run->h, run->h_limit);
        const int last = run->t + h * 1.000001 >= t_stop;
        if (last) h = t_stop - run->t;
        const double error = attempt(run, p, c, &piece, &jac, f0, df_dt, h, k, x_new);
        run->rates += STAGES - 1;
        if (!(error <= 1)) {
            run->rejected++;
            run->rejected_last = 1;
            run->h = h * (error < 1e30 ? growth(error) : 0.1);
            if (run->t + run->h * 0.25 <= run->t || run->h < 1e-290) return error < 1e30 ? STEP_TOO_SMALL : NOT_FINITE;
            continue;
        }
        const double t_new = last ? t_stop : run->t + h;
        const int wants_rows = run->row < run->rows && (double)run->row * run->step <= t_new;
        if (wants_rows) {
            double d[N][3];
            for (int i = 0; i < N; i++) dense(k, i, d[i]);
            for (double t; run->row < run->rows && (t = (double)run->row * run->step) <= t_new; run->row++) {
                const double s = (t - run->t) / h;
                for (int i = 0; i < N; i++) run->out[run->row * N + i] = interpolate(s, run->x[i], x_new[i], d[i]);
            }
        }
#if V_STATE >= 0
        if (run->threshold > 0) {
            double d[3];
            dense(k, V_STATE, d);
            note_events(run, run->t, h, run->x[V_STATE], x_new[V_STATE], d);
        }
#endif
        run->accepted++;
        if (h > run->h_largest) run->h_largest = h;
        if (h < run->h_smallest && !last) run->h_smallest = h;
        double factor = growth(error);
        if (run->last_h > 0) { /* errors that grow from step to step go on growing: Gustafsson's predictive control */
            const double ratio = (double)powf((float)(run->last_error / larger(error, 1e-20)), 0.1f);
            factor = smaller(factor, larger(0.2, factor * ratio * h / run->last_h));
        }
        if (run->rejected_last) factor = smaller(factor, 1.0);
        run->rejected_last = 0;
        run->last_h = h;
        run->last_error = larger(error, 1e-4);
        run->h = last ? larger(run->h, h * factor) : h * factor;
        for (int i = 0; i < N; i++) run->x[i] = x_new[i];
        run->t = t_new;
        fresh = 0;
        while (run->piece + 1 < run->pieces && run->piece_start[run->piece + 1] <= run->t) {
            const int64_t q = run->piece++;
            const double before = run->piece_value[q] + run->piece_slope[q] * (run->t - run->piece_start[q]);
            const double jump = fabs(run->piece_value[q + 1] - before);
            if (jump > 1e-12 * larger(fabs(before), fabs(run->piece_value[q + 1]))) run->restart = JUMP;
            else if (!run->restart && run->piece_slope[q + 1] != run->piece_slope[q]) run->restart = CORNER;
        }
    }
    return DONE;
}
