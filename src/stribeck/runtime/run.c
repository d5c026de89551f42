/* ---- One trajectory. ---------------------------------------------------------------------------------------------- */

/* What Python and C share; the same fields in the same order stand in simulation/native.py. */
typedef struct {
    const double *parameters;   /* the fields of Parameters */
    const double *atol;         /* absolute tolerance of each state */
    double *x;                  /* the state at t, advanced in place */
    const double *piece_start;  /* the signal's straight pieces: when each begins, its value then, its slope */
    const double *piece_value;
    const double *piece_slope;
    double *out;                /* rows of states */
    double *event_time;         /* slip and stick instants */
    int8_t *event_rises;        /* 1 where |v| rises through the threshold (slip), 0 where it falls (stick) */
    double rtol, t, t_end, h, h_limit, step, threshold;
    double h_smallest, h_largest;
    double last_h, last_root;   /* of the last accepted step; last_h 0: none yet */
    int64_t pieces, piece, rows, row, event_room, events;
    int64_t accepted, rejected, rates, jacobians, attempts_left;
    int64_t held, restart;      /* held: the last attempt was rejected */
} Run;

enum { DONE = 0, MORE = 1, EVENTS_FULL = 2, STEP_TOO_SMALL = -1, NOT_FINITE = -2 };

EXPORT int64_t stribeck_run_size(void) { return (int64_t)sizeof(Run); }
EXPORT int64_t stribeck_states(void) { return N; }

/* The rows within the step from run->t to t_new, of length h. */
static void write_rows(Run *run, double h, double t_new, double k[STAGES][N], const double *x_new)
{
    double d[N][3];
    for (int i = 0; i < N; i++) dense(k, i, d[i]);
    for (double t; run->row < run->rows && (t = (double)run->row * run->step) <= t_new; run->row++) {
        const double s = (t - run->t) / h;
        for (int i = 0; i < N; i++)
            run->out[run->row * N + i] = interpolate(s, run->x[i], x_new[i], d[i][0], d[i][1], d[i][2]);
    }
}

/* Note where |v| passes the threshold within the step from run->t. */
static inline void note_events(Run *run, double h, double k[STAGES][N], const double *x_new)
{
#if V_STATE >= 0
    if (!(run->threshold > 0)) return;
    double d[3], s[MOST_EVENTS];
    int8_t rises[MOST_EVENTS];
    dense(k, V_STATE, d);
    const int count = events_within(run->threshold, run->x[V_STATE], x_new[V_STATE], d[0], d[1], d[2], s, rises);
    for (int i = 0; i < count; i++) {
        run->event_time[run->events] = run->t + s[i] * h;
        run->event_rises[run->events++] = rises[i];
    }
#else
    (void)run, (void)h, (void)k, (void)x_new;
#endif
}

/* Go on to the pieces that have begun at run->t. */
static void next_piece(Run *run)
{
    while (run->piece + 1 < run->pieces && run->piece_start[run->piece + 1] <= run->t) {
        const int64_t q = run->piece++;
        const double end = run->piece_value[q] + run->piece_slope[q] * (run->t - run->piece_start[q]);
        const int why = restart_between(end, run->piece_slope[q], run->piece_value[q + 1], run->piece_slope[q + 1]);
        if (why == JUMP || !run->restart) run->restart = why;
    }
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
    if (run->row == 0 && run->rows > 0) { /* the first call: the first row is kept whatever comes after */
        for (int i = 0; i < N; i++) run->out[i] = run->x[i];
        run->row = 1;
    }
    while (run->t < run->t_end) {
        if (run->attempts_left-- <= 0) return MORE;
        if (run->events + MOST_EVENTS > run->event_room) return EVENTS_FULL;
        const int64_t n = run->piece;
        const Segment piece = {run->piece_start[n], run->piece_value[n], run->piece_slope[n]};
        const double t_stop = n + 1 < run->pieces ? smaller(run->piece_start[n + 1], run->t_end) : run->t_end;
        if (run->restart) {
            const double ease = run->restart == CORNER ? CORNER_EASE : 1;
            const double room = t_stop - run->t;
            run->h = smaller(run->h, ease * first_step(run->atol, run->rtol, p, c, &piece, run->t, run->x, room));
            run->rates += 2;
            run->restart = run->held = 0;
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
        const double error =
            attempt(run->atol, run->rtol, p, c, &piece, &jac, f0, df_dt, run->t, run->x, h, k, x_new);
        run->rates += STAGES - 1;
        if (!(error <= 1)) {
            run->rejected++;
            run->held = 1;
            run->h = h * (error < 1e30 ? growth(steering(error)) : 0.1);
            if (run->t + run->h * 0.25 <= run->t || run->h < 1e-290) return error < 1e30 ? STEP_TOO_SMALL : NOT_FINITE;
            continue;
        }
        const double t_new = last ? t_stop : run->t + h;
        if (run->row < run->rows && (double)run->row * run->step <= t_new) write_rows(run, h, t_new, k, x_new);
        note_events(run, h, k, x_new);
        run->accepted++;
        if (h > run->h_largest) run->h_largest = h;
        if (h < run->h_smallest && !last) run->h_smallest = h;
        const double root = steering(error);
        double factor = run->last_h > 0 ? predictive_growth(root, h, run->last_root, run->last_h) : growth(root);
        if (run->held) factor = smaller(factor, 1.0);
        run->held = 0;
        run->last_h = h;
        run->last_root = remembered(root);
        run->h = last ? larger(run->h, h * factor) : h * factor;
        for (int i = 0; i < N; i++) run->x[i] = x_new[i];
        run->t = t_new;
        fresh = 0;
        next_piece(run);
    }
    return DONE;
}
