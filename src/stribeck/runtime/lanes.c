/* ---- Many trajectories in the lanes of vectors: each with its own time and step, its lane refilled when it is done. - */

/* What Python and C share; the same fields in the same order stand in simulation/lanes.py. Arrays of several numbers a
   trajectory hold them one trajectory after the other. */
typedef struct {
    const double *parameters;     /* the fields of Parameters */
    const double *atol;           /* absolute tolerance of each state */
    const double *x0;             /* the state at t = 0 */
    const double *threshold;      /* the speed of slip and stick, 0 for none */
    const double *h_limit;
    const int64_t *piece_first, *piece_end; /* where a trajectory's pieces begin and end in the arrays below */
    const double *piece_start, *piece_value, *piece_slope;
    double *out;                  /* rows of states */
    int64_t *rows_reached, *status, *accepted, *rejected, *slips, *sticks;
    double *t_reached;
    int64_t *queue;               /* shared by all threads: the next trajectory, how many are finished, whether to stop */
    double rtol, t_end, step;
    int64_t count, rows, most_attempts;
} Batch;

enum { DONE = 0, GAVE_UP = 1, STEP_TOO_SMALL = -1, NOT_FINITE = -2 };

EXPORT int64_t stribeck_batch_size(void) { return (int64_t)sizeof(Batch); }
EXPORT int64_t stribeck_lanes(void) { return LANES; }

/* For tests: an operation on LANES numbers in place. */
#define EXPORT_OPERATION(name, operation) \
    EXPORT void name(double *x) \
    { \
        real values; \
        for (int lane = 0; lane < LANES; lane++) values[lane] = x[lane]; \
        values = operation(values); \
        for (int lane = 0; lane < LANES; lane++) x[lane] = values[lane]; \
    }
EXPORT_OPERATION(stribeck_exp, exp_of)
EXPORT_OPERATION(stribeck_atan, atan_of)

typedef struct {
    Parameters p;
    Coefficients c;
    Segment piece;
    real atol[N], x[N], t, h, h_limit, t_stop, last_h, last_root;
    real level, row_t;                 /* what to look out for: the speed of slip and stick, the time of the next row */
    mask accepted, rejected, held;     /* counts; held: the last attempt was rejected */
    int64_t index[LANES], piece_at[LANES], row[LANES]; /* index -1: no trajectory left for this lane */
    int restart[LANES];
    int64_t alive;
} Lanes;

static void enter_piece(const Batch *b, Lanes *l, int lane, int64_t i)
{
    const int64_t q = l->piece_at[lane];
    l->piece.start[lane] = b->piece_start[q];
    l->piece.value[lane] = b->piece_value[q];
    l->piece.slope[lane] = b->piece_slope[q];
    const int more = q + 1 < b->piece_end[i] && b->piece_start[q + 1] < b->t_end;
    l->t_stop[lane] = more ? b->piece_start[q + 1] : b->t_end;
}

/* Put the next trajectory into a lane; a lane for which none is left repeats the last one, unheard. */
static void refill(const Batch *b, Lanes *l, int lane)
{
    const int64_t next = __atomic_fetch_add(&b->queue[0], 1, __ATOMIC_RELAXED);
    const int none = next >= b->count;
    const int64_t i = none ? b->count - 1 : next;
    l->alive += !none - (l->index[lane] >= 0);
    const size_t width = sizeof(Parameters) / sizeof(real);
    double *p = (double *)&l->p;
    for (size_t m = 0; m < width; m++) p[m * LANES + (size_t)lane] = b->parameters[(size_t)i * width + m];
    for (int n = 0; n < N; n++) {
        l->atol[n][lane] = b->atol[i * N + n];
        l->x[n][lane] = b->x0[i * N + n];
        if (!none && b->rows > 0) b->out[i * b->rows * N + n] = b->x0[i * N + n];
    }
    if (!none) b->slips[i] = b->sticks[i] = 0;
    l->t[lane] = 0;
    l->h[lane] = 1e300;
    l->h_limit[lane] = b->h_limit[i];
    l->last_h[lane] = 0;
    l->last_root[lane] = 1;
    l->accepted[lane] = l->rejected[lane] = l->held[lane] = 0;
    l->level[lane] = !none && b->threshold[i] > 0 ? b->threshold[i] : NAN;
    l->row[lane] = 1;
    l->row_t[lane] = !none && b->rows > 1 ? b->step : 1e300;
    l->index[lane] = none ? -1 : i;
    l->piece_at[lane] = b->piece_first[i];
    enter_piece(b, l, lane, i);
    l->restart[lane] = JUMP;
}

static void finish(const Batch *b, Lanes *l, int lane, int status)
{
    const int64_t i = l->index[lane];
    if (i >= 0) {
        b->status[i] = status;
        b->rows_reached[i] = l->row[lane];
        b->t_reached[i] = l->t[lane];
        b->accepted[i] = l->accepted[lane];
        b->rejected[i] = l->rejected[lane];
        __atomic_fetch_add(&b->queue[1], 1, __ATOMIC_RELAXED);
    }
    refill(b, l, lane);
}

static void write_rows(const Batch *b, Lanes *l, int lane, double h, double t_new, real k[STAGES][N], const real *x_new)
{
    const int64_t i = l->index[lane];
    double d[N][3];
    for (int n = 0; n < N; n++)
        for (int m = 0; m < 3; m++) {
            d[n][m] = 0;
            for (int s = 0; s < STAGES; s++) d[n][m] += DENSE[m][s] * k[s][n][lane];
        }
    double t = l->row_t[lane];
    for (; l->row[lane] < b->rows && (t = (double)l->row[lane] * b->step) <= t_new; l->row[lane]++) {
        const double s = (t - l->t[lane]) / h;
        double *row = b->out + (i * b->rows + l->row[lane]) * N;
        for (int n = 0; n < N; n++)
            row[n] = interpolate(s, l->x[n][lane], x_new[n][lane], d[n][0], d[n][1], d[n][2]);
    }
    l->row_t[lane] = l->row[lane] < b->rows ? t : 1e300;
}

/* After an accepted step that ended at a breakpoint: go on in the next piece, or finish. */
static void next_piece(const Batch *b, Lanes *l, int lane)
{
    const int64_t i = l->index[lane] < 0 ? b->count - 1 : l->index[lane];
    if (l->t[lane] >= b->t_end) {
        finish(b, l, lane, DONE);
        return;
    }
    while (l->piece_at[lane] + 1 < b->piece_end[i] && b->piece_start[l->piece_at[lane] + 1] <= l->t[lane]) {
        const int64_t q = l->piece_at[lane]++;
        const double end = b->piece_value[q] + b->piece_slope[q] * (l->t[lane] - b->piece_start[q]);
        const int why = restart_between(end, b->piece_slope[q], b->piece_value[q + 1], b->piece_slope[q + 1]);
        if (why == JUMP || !l->restart[lane]) l->restart[lane] = why;
    }
    enter_piece(b, l, lane, i);
}

/* Steps of lanes that start anew or come out of a breakpoint. */
static void restart(const Batch *b, Lanes *l)
{
    prepare(&l->p, &l->c);
    const real h = first_step(l->atol, b->rtol, &l->p, &l->c, &l->piece, l->t, l->x, l->t_stop - l->t);
    for (int lane = 0; lane < LANES; lane++)
        if (l->restart[lane]) {
            const double wanted = h[lane] * (l->restart[lane] == CORNER ? CORNER_EASE : 1);
            l->h[lane] = wanted < l->h[lane] ? wanted : l->h[lane];
            l->last_h[lane] = 0;
            l->held[lane] = 0;
            l->restart[lane] = 0;
        }
}

/* What happened to single lanes in a step: rows to write, events, breakpoints, failures. */
static void attend(const Batch *b, Lanes *l, mask rows, mask events, mask last, mask failed, real h, real t_new,
                   real error, real k[STAGES][N], const real *x_new, const real *d)
{
    for (int lane = 0; lane < LANES; lane++) {
        if (failed[lane]) {
            const int few = l->accepted[lane] + l->rejected[lane] < b->most_attempts;
            finish(b, l, lane, !few ? GAVE_UP : error[lane] < 1e30 ? STEP_TOO_SMALL : NOT_FINITE);
            continue;
        }
        if (rows[lane]) write_rows(b, l, lane, h[lane], t_new[lane], k, x_new);
#if V_STATE >= 0
        if (events[lane]) {
            double s[MOST_EVENTS];
            int8_t rises[MOST_EVENTS];
            const int64_t i = l->index[lane];
            const int count = events_within(l->level[lane], l->x[V_STATE][lane], x_new[V_STATE][lane], d[0][lane],
                                            d[1][lane], d[2][lane], s, rises);
            for (int e = 0; e < count; e++) *(rises[e] ? &b->slips[i] : &b->sticks[i]) += 1;
        }
#else
        (void)events;
        (void)d;
#endif
        if (last[lane]) {
            for (int n = 0; n < N; n++) l->x[n][lane] = x_new[n][lane];
            l->t[lane] = t_new[lane];
            next_piece(b, l, lane);
        }
    }
}

/* Solve trajectories of the batch until none is left; several threads may do so at once. */
EXPORT void stribeck_solve_batch(const Batch *b)
{
    Lanes lanes = {.alive = 0}, *l = &lanes;
    for (int lane = 0; lane < LANES; lane++) {
        l->index[lane] = -1;
        refill(b, l, lane);
    }
    real k[STAGES][N], x_new[N], f0[N], df_dt[N], d[3] = {splat(0), splat(0), splat(0)};
    Jacobian jac;
    int anew = 1;
    while (l->alive > 0 && !__atomic_load_n(&b->queue[2], __ATOMIC_RELAXED)) {
        if (anew) restart(b, l);
        anew = 0;
        rates(&l->p, &l->c, &l->piece, l->t, l->x, f0);
        jacobian(&l->p, &l->c, &l->piece, l->t, l->x, &jac, df_dt);
        const real wanted = smaller(l->h, l->h_limit);
        const mask last = l->t + wanted * 1.000001 >= l->t_stop;
        const real h = choose(last, l->t_stop - l->t, wanted), t_new = choose(last, l->t_stop, l->t + h);
        const real error =
            attempt(l->atol, b->rtol, &l->p, &l->c, &l->piece, &jac, f0, df_dt, l->t, l->x, h, k, x_new);
        const mask good = error <= 1, finite = error < 1e30;
        const real root = steering(error), plain = growth(root);
        real factor = choose(l->last_h > 0, predictive_growth(root, h, l->last_root, l->last_h), plain);
        factor = choose(l->held & (factor > 1), splat(1), factor);
        const real grown = h * choose(good, factor, choose(finite, plain, splat(0.1)));
        const real next_h = choose(good & last, larger(l->h, grown), grown);
        mask events = good & 0;
#if V_STATE >= 0
        dense(k, V_STATE, d);
        const real v0 = l->x[V_STATE], v1 = x_new[V_STATE]; /* a quartic strays from its chord by at most this: */
        const real stray = 0.25 * (abs_of(d[0]) + abs_of(d[1]) + abs_of(d[2]));
        const real low = smaller(v0, v1) - stray, high = larger(v0, v1) + stray;
        events = good & (((low <= l->level) & (high >= l->level)) | ((low <= -l->level) & (high >= -l->level)));
#endif
        const mask rows = good & (t_new >= l->row_t), ends = good & last;
        const mask tried = l->accepted + l->rejected;
        const mask failed = (~good & ((l->t + next_h * 0.25 <= l->t) | (next_h < 1e-290))) | (tried >= b->most_attempts);
        l->accepted -= good; /* true is -1 */
        l->rejected -= ~good;
        l->h = next_h;
        l->held = ~good;
        l->last_h = choose(good, h, l->last_h);
        l->last_root = choose(good, remembered(root), l->last_root);
        const mask attention = rows | events | ends | failed;
        if (any(attention)) {
            attend(b, l, rows, events, ends, failed, h, t_new, error, k, x_new, d);
            for (int lane = 0; lane < LANES; lane++) anew |= l->restart[lane];
        }
        const mask moves = good & ~ends & ~failed; /* the others were moved, or given another trajectory, above */
        for (int n = 0; n < N; n++) l->x[n] = choose(moves, x_new[n], l->x[n]);
        l->t = choose(moves, t_new, l->t);
    }
}
