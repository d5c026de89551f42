/* ---- One trajectory. ---------------------------------------------------------------------------------------------- */

/* What Python and C share: simulation/layout.py reads the fields from here. */
typedef struct {
    const double *parameters;   /* the fields of Parameters */
    const double *atol;         /* absolute tolerance of each state in a motion of the machine's natural scales */
    const double *fixed_atol;   /* the same of states whose tolerance does not follow the motion; 0 for the others */
    double *atol_now;           /* the absolute tolerances for the motion so far: see follow(); 0 at first */
    double *x;                  /* the state at t, advanced in place */
    const double *piece_start;  /* when each row of signal pieces begins */
    const double *piece_rows;   /* the rows: the first PIECE fields of Segment */
    double *out;                /* rows of states, held outputs and what is shown of the memory */
    double *event_time;
    const double *thresholds;   /* of the watched quantities; 0 for none */
    double *held;               /* the outputs of sampled controllers that act at t */
    double *memory;             /* what sampled controllers remember */
    double *queue;              /* their outputs that do not act yet: queue_room for each */
    const double *force_tolerance; /* how far a step may err in each friction force; NULL: as the states' tolerances say */
    double *largest;            /* MEASURES numbers: see below; NULL: not measured */
    double *carried;            /* what the errors of the steps so far amount to in each state: see carry_errors() */
    const double *noise;        /* standard normal numbers, noise_room for each controller */
    const int8_t *piece_restart; /* how the signals go on at the beginning of a row */
    int32_t *event_what;        /* which quantity (times 4), and what happened to it */
    int64_t *sampled, *acted;   /* of each sampled controller: how many samples it took, how many outputs acted */
    double rtol, t, t_end, h, h_limit, step;
    double size;                /* of the motion so far: see follow() */
    double h_smallest, h_largest;
    double last_h, last_root;   /* of the last accepted step; last_h 0: none yet */
    double output_h;            /* the step to begin with after an output; 0: not known yet */
    double carried_to;          /* the time up to which they are carried on */
    int64_t carried_steps;      /* the steps since then */
    int64_t pieces, piece, rows, row, event_room, events, queue_room, noise_room;
    int64_t accepted, rejected, rates, jacobians, attempts_left;
    int64_t held_back, restart; /* held_back: the last attempt was rejected */
    double t_looked;            /* where it was when it was last looked whether it gets on */
    int64_t rows_are_steps;     /* whether each row ends a step, so that none is interpolated */
    int64_t since, wild;        /* the attempts since then, and those that were not finite */
} Run;

enum { DONE = 0, MORE = 1, EVENTS_FULL = 2, STEP_TOO_SMALL = -1, NOT_FINITE = -2, STALLED = -4 };

EXPORT int64_t stribeck_run_size(void) { return (int64_t)sizeof(Run); }
EXPORT int64_t stribeck_states(void) { return N; }
EXPORT int64_t stribeck_event_room(void) { return MOST_EVENTS * (WATCHES + 1); } /* of one step: less never ends */

/* The signals' pieces and the held outputs that act now, in the order of Segment. */
static inline void present(const Run *run, double *fields)
{
    for (int i = 0; i < PIECE; i++) fields[i] = run->piece_rows[run->piece * PIECE + i];
    for (int i = 0; i < HELD; i++) fields[PIECE + i] = run->held[i];
    if (PIECE + HELD == 0) fields[0] = 0;
}

static inline void put_row(Run *run, const double *x)
{
    double *row = run->out + run->row++ * (N + HELD + SHOWN);
    for (int i = 0; i < N; i++) row[i] = x[i];
    for (int i = 0; i < HELD; i++) row[N + i] = run->held[i];
    for (int i = 0; i < SHOWN; i++) row[N + HELD + i] = run->memory[i];
}

#if MAY_WATCH
static void note(Run *run, int which, int what, double t)
{
    if (run->events < run->event_room) {
        run->event_time[run->events] = t;
        run->event_what[run->events++] = 4 * which + what;
    }
}
#endif

/* Note where watched quantities pass their thresholds within the step from run->t. */
static inline void note_events(Run *run, const Parameters *p, const Coefficients *c, const Segment *piece, double h,
                               double k[STAGES][N], const double *x_new)
{
#if MAY_WATCH
    if (!MAY_CROSS(p, c, piece, run->t, run->x, h, x_new, k, run->thresholds)) return;
    double d[3][N], dw[3][WATCHES], w0[WATCHES], w1[WATCHES];
    for (int i = 0; i < WATCHED; i++) {
        double of_state[3];
        dense(k, WATCHED_STATES[i], of_state);
        for (int m = 0; m < 3; m++) d[m][WATCHED_STATES[i]] = of_state[m];
    }
    watch(p, c, piece, run->t, run->x, w0);
    watch(p, c, piece, run->t + h, x_new, w1);
    for (int m = 0; m < 3; m++) watch_dense(p, c, d[m], dw[m]);
#if MAY_CURVE
    double inside[3][WATCHES], x[N];
    for (int i = 0; i < N; i++) x[i] = run->x[i];
    for (int q = 0; CURVED && q < 3; q++) {
        const double s = 0.25 * (q + 1);
        for (int i = 0; i < WATCHED; i++) {
            const int n = WATCHED_STATES[i];
            x[n] = interpolate(s, run->x[n], x_new[n], d[0][n], d[1][n], d[2][n]);
        }
        watch(p, c, piece, run->t + s * h, x, inside[q]);
    }
#endif
    for (int j = 0; j < WATCHES; j++) {
        if (!(run->thresholds[j] > 0)) continue;
        double b[5], s[MOST_EVENTS];
        int8_t what[MOST_EVENTS];
        bernstein_of_dense(w0[j], w1[j], dw[0][j], dw[1][j], dw[2][j], b);
#if MAY_CURVE
        if (IS_CURVED[j])
            bernstein_of_values((const double[5]){w0[j], inside[0][j], inside[1][j], inside[2][j], w1[j]}, b);
#endif
        const int count = events_within(run->thresholds[j], b, s, what);
        for (int i = 0; i < count; i++) note(run, j, what[i], run->t + s[i] * h);
    }
#else
    (void)run, (void)p, (void)c, (void)piece, (void)h, (void)k, (void)x_new;
#endif
}

#if MAY_HOLD
static inline double next_output(const Run *run, const double *timing)
{
    double t = INFINITY;
    for (int i = 0; i < HELD; i++) {
        const double next = (double)run->acted[i] * timing[i] + timing[HELD + i];
        t = next < t ? next : t;
    }
    return t;
}

/* The samples before t_before within the step from run->t: their states lie on the dense output. */
static void take_samples(Run *run, const Parameters *p, const Coefficients *c, const Segment *piece,
                         const double *timing, double h, double t_before, double k[STAGES][N], const double *x_new)
{
    for (int i = 0; i < HELD; i++)
        for (double t; (t = (double)run->sampled[i] * timing[i]) < t_before;) {
            double x[N], d[3], u;
            const double s = h > 0 ? larger((t - run->t) / h, 0.0) : 0;
            for (int n = 0; n < N; n++) {
                x[n] = run->x[n];
                if (h > 0) {
                    dense(k, n, d);
                    x[n] = interpolate(s, run->x[n], x_new[n], d[0], d[1], d[2]);
                }
            }
            const int64_t q = run->sampled[i]++;
            const double noise = q < run->noise_room ? run->noise[i * run->noise_room + q] : 0;
            sample(i, p, c, piece, t, x, noise, (Memory *)run->memory, &u);
            run->queue[i * run->queue_room + q % run->queue_room] = u;
        }
}

/* The outputs that are due at t begin to act; whether one changed. */
static int act(Run *run, const double *timing, double t)
{
    int changed = 0;
    for (int i = 0; i < HELD; i++)
        while (run->acted[i] < run->sampled[i]
               && (double)run->acted[i] * timing[i] + timing[HELD + i] <= t * (1 + SAME_TIME)) {
            const double u = run->queue[i * run->queue_room + run->acted[i]++ % run->queue_room];
            changed |= u != run->held[i];
            run->held[i] = u;
        }
    return changed;
}
#endif

/* What the run's largest numbers are so far: of the states, of the friction forces, of what a step's error, and the last term of
   the dense output within a step, amount to in them, and of the terms that they are sums of; of the errors carried on, in the
   states and in the friction forces. */
#define MEASURES (2 * N + 5 * FORCES)
static inline void keep_larger(double *largest, double x)
{
    if (!(fabs(x) <= *largest)) *largest = fabs(x); /* nan is kept, too */
}

/* Carry on the errors of the steps so far. The interval has the Jacobian's time, run->t, in its middle. Errors of many steps add
   up, and grow where neighbouring motions part. Sampled controllers would pull them back, but their outputs are held in these
   equations: such systems are left out. */
static inline void carry_errors(Run *run, const Parameters *p, const Coefficients *c, const Work *work)
{
    const double half = run->t - run->carried_to;
    double *carried = run->carried, *largest = run->largest + N + 4 * FORCES;
    if (HELD || !(half > 0) || ++run->carried_steps < CARRIED_STEPS) return;
    run->carried_steps = 0;
    carry(p, c, work, 2 * half, carried);
    run->carried_to = run->t + half;
    for (int i = 0; i < N; i++) {
        carried[i] += copysign(ROUNDING * run->x[i], carried[i]);
        keep_larger(largest + i, carried[i]);
    }
#if MAY_OBSERVE
    double F[FORCES + 1], F_error[FORCES + 1], F_terms[FORCES + 1];
    observed(p, c, work, carried, F, F_error, F_terms);
    for (int q = 0; q < FORCES; q++) keep_larger(largest + N + q, F_error[q]);
#endif
}

/* The rows within the step from run->t that come before t_before or at t_new; h is the step's length. */
static void write_rows(Run *run, const Parameters *p, const Coefficients *c, const Segment *piece, const Work *work,
                       double h, double t_new, double t_before, double k[STAGES][N], const double *x_new)
{
    double d[N][3], x[N];
    all_dense(k, d);
    if (run->largest && (double)run->row * run->step < t_new) {
#if MAY_OBSERVE
        double last[N], F[FORCES + 1], F_last[FORCES + 1], size[FORCES + 1];
        for (int i = 0; i < N; i++) last[i] = 27.0 / 256 * d[i][2]; /* s^3 (1 - s) is at most 27/256 */
        observed(p, c, work, last, F, F_last, size);
        for (int q = 0; q < FORCES; q++) keep_larger(run->largest + N + 2 * FORCES + q, F_last[q]);
#endif
    }
    (void)work;
#if MAY_SHOW
    double timing[2 * HELD + 1];
    find_timing(p, timing);
#else
    (void)p, (void)c, (void)piece;
#endif
    for (double t; run->row < run->rows && (t = (double)run->row * run->step) <= t_new && t < t_before;) {
        const double s = (t - run->t) / h;
        within_step(s, run->x, x_new, d, x);
#if MAY_SHOW
        take_samples(run, p, c, piece, timing, h, smaller(t * (1 + SAME_TIME), t_before), k, x_new);
#endif
        put_row(run, x);
    }
}

/* Go on to the pieces that have begun at run->t, and to the outputs of controllers; note what jumps there. */
static void pass(Run *run, const Parameters *p, const Coefficients *c, int first)
{
    const double now = run->t * (1 + SAME_TIME);
    const int64_t before = run->piece;
    PRESENT(old)
    while (run->piece + 1 < run->pieces && run->piece_start[run->piece + 1] <= now) {
        const int why = run->piece_restart[++run->piece];
        if (why == JUMP || !run->restart) run->restart = why;
    }
#if MAY_HOLD
    PRESENT(between)
    double timing[2 * HELD + 1];
    find_timing(p, timing);
    take_samples(run, p, c, between, timing, 0, now + (now > 0 ? 0 : 1e-300), NULL, NULL);
    if (act(run, timing, run->t) && !run->restart) run->restart = OUTPUT;
#endif
    if (first) return;
    PRESENT(new)
    (void)before, (void)old, (void)new, (void)p, (void)c;
#if MAY_MOVE
    if (MOVED >= 0 && run->piece != before)
        run->x[MOVED] += moved_energy(p, c, new, run->t, run->x) - moved_energy(p, c, old, run->t, run->x);
#endif
#if MAY_WATCH
    if (!WATCHES || (run->restart != JUMP && run->restart != OUTPUT)) return;
    double w0[WATCHES], w1[WATCHES];
    watch(p, c, old, run->t, run->x, w0);
    watch(p, c, new, run->t, run->x, w1);
    for (int j = 0; j < WATCHES; j++) {
        const double threshold = run->thresholds[j];
        if (!(threshold > 0)) continue;
        if ((w0[j] >= threshold) != (w1[j] >= threshold)) note(run, j, !(w1[j] >= threshold), run->t);
        if ((-w0[j] >= threshold) != (-w1[j] >= threshold)) note(run, j, AT_MINUS | !(-w1[j] >= threshold), run->t);
    }
#endif
}

/* The first step of what begins anew. */
static inline void restart_step(Run *run, const Parameters *p, const Coefficients *c, const Segment *piece, double room)
{
    if (run->restart == OUTPUT && run->output_h > 0)
        run->h = smaller(run->h, run->output_h);
    else {
        const double ease = run->restart == CORNER ? CORNER_EASE : 1;
        run->h = smaller(run->h, ease * first_step(run->atol_now, run->rtol, p, c, piece, run->t, run->x, room));
        run->rates += 2;
    }
    run->held_back = 0;
    run->last_h = 0;
}

/* Advance the run until it is done, fails, or has used its attempts. */
static NOINLINE int advance(Run *run)
{
    WORKPLACE(run)
    prepare(p, c);
#if MAY_HOLD
    double timing[2 * HELD + 1];
    find_timing(p, timing);
#endif
    double x_new[N];
    int fresh = 0;        /* f0 and the Jacobian belong to the present state */
    int after_output = 0; /* the present step is the first after an output */
    run->size = larger(run->size, LEAST_SIZE);
    if (run->row == 0 && run->rows > 0) { /* the first call: the first row is kept whatever comes after */
        pass(run, p, c, 1);
        put_row(run, run->x);
        run->restart = JUMP;
    }
    while (run->t < run->t_end) {
        if (run->attempts_left-- <= 0) return MORE;
        if (run->events + stribeck_event_room() > run->event_room) return EVENTS_FULL;
        const int64_t n = run->piece;
        PRESENT(piece)
        double t_stop = n + 1 < run->pieces ? smaller(run->piece_start[n + 1], run->t_end) : run->t_end;
#if MAY_HOLD
        t_stop = smaller(t_stop, next_output(run, timing));
#endif
        if (run->rows_are_steps && run->row < run->rows && (double)run->row * run->step > run->t)
            t_stop = smaller(t_stop, (double)run->row * run->step);
        if (!fresh) follow(run->atol, run->fixed_atol, run->rtol, run->x, &run->size, run->atol_now);
        if (run->restart) {
            after_output = run->restart == OUTPUT;
            restart_step(run, p, c, piece, t_stop - run->t);
            run->restart = 0;
        }
        if (!fresh) {
            linearise(p, c, piece, run->t, run->x, work);
            run->rates++;
            run->jacobians++;
            fresh = 1;
        }
        double h = smaller(run->h, run->h_limit);
        const int last = run->t + h * 1.000001 >= t_stop;
        if (last) h = t_stop - run->t;
        double error = attempt(p, c, piece, run->t, run->x, h, work, k, x_new, run->atol_now, run->rtol);
#if MAY_OBSERVE
        double F[FORCES + 1], F_error[FORCES + 1], F_terms[FORCES + 1];
        observed(p, c, work, k[STAGES - 1], F, F_error, F_terms);
        for (int q = 0; run->force_tolerance && q < FORCES; q++) {
            const double ratio = F_error[q] / run->force_tolerance[q];
            if (ratio * ratio > error || ratio != ratio) error = ratio * ratio;
        }
#endif
        run->rates += STAGES - 1;
#if MAY_WATCH
        if (error <= 1 && MAY_CROSS(p, c, piece, run->t, run->x, h, x_new, k, run->thresholds)) {
            double w0[WATCHES], w1[WATCHES];
            watch(p, c, piece, run->t, run->x, w0);
            watch(p, c, piece, run->t + h, x_new, w1);
            const double share = share_to_zero(run->thresholds, w0, w1);
            if (share < 1 && run->t + share * h * 0.25 > run->t) {
                run->rejected++;
                run->held_back = 1;
                run->h = share * h;
                continue;
            }
        }
#endif
        if (!(error <= 1)) {
            run->rejected++;
            run->wild += !(error < 1e30);
            run->held_back = 1;
            run->h = h * (error < 1e30 ? growth(steering(error)) : 0.1);
            if (run->t + run->h * 0.25 <= run->t || run->h < 1e-290) return error < 1e30 ? STEP_TOO_SMALL : NOT_FINITE;
            continue;
        }
        const double t_new = last ? t_stop : run->t + h, t_before = last ? t_stop * (1 - SAME_TIME) : INFINITY;
        if (run->row < run->rows && (double)run->row * run->step <= t_new)
            write_rows(run, p, c, piece, work, h, t_new, t_before, k, x_new);
        note_events(run, p, c, piece, h, k, x_new);
#if MAY_HOLD
        if (HELD) take_samples(run, p, c, piece, timing, h, last ? t_before : t_new * (1 - SAME_TIME), k, x_new);
#endif
        if (run->largest) {
            for (int i = 0; i < N; i++) keep_larger(run->largest + i, x_new[i]);
            carry_errors(run, p, c, work);
            for (int i = 0; i < N; i++) run->carried[i] += k[STAGES - 1][i];
#if MAY_OBSERVE
            for (int q = 0; q < FORCES; q++) {
                keep_larger(run->largest + N + q, F[q]);
                keep_larger(run->largest + N + FORCES + q, F_error[q]);
            }
            if (run->force_tolerance) observed(p, c, work, run->x, F, F_error, F_terms);
            for (int q = 0; run->force_tolerance && q < FORCES; q++) keep_larger(run->largest + N + 3 * FORCES + q, F_terms[q]);
#endif
        }
        run->accepted++;
        if (h > run->h_largest) run->h_largest = h;
        if (h < run->h_smallest && !last) run->h_smallest = h;
        const double root = steering(error);
        double factor = run->last_h > 0 ? predictive_growth(root, h, run->last_root, run->last_h) : growth(root);
        if (run->held_back) factor = smaller(factor, 1.0);
        run->held_back = 0;
        run->last_h = h;
        run->last_root = remembered(root);
        if (after_output) run->output_h = last ? larger(run->output_h, h * factor) : h * factor;
        after_output = 0;
        run->h = last ? larger(run->h, h * factor) : h * factor;
        for (int i = 0; i < N; i++) run->x[i] = x_new[i];
        run->t = t_new;
        fresh = 0;
        if (last) {
            pass(run, p, c, 0);
            while (run->row < run->rows && (double)run->row * run->step <= t_new * (1 + SAME_TIME)) put_row(run, run->x);
        }
    }
    return DONE;
}

/* The same, and whether it gets on; call again to go on. Apart, for what stands in the loop above changes its rounding. */
EXPORT int stribeck_advance(Run *run)
{
    int64_t left = run->attempts_left;
    for (;;) {
        const int64_t some = left < LOOK - run->since ? left : LOOK - run->since;
        run->attempts_left = some;
        const int status = advance(run);
        const int64_t used = run->attempts_left > 0 ? some - run->attempts_left : some;
        run->since += used;
        run->attempts_left = left -= used;
        if (status != MORE) return status;
        if (run->since >= LOOK) {
            const double way = run->t - run->t_looked;
            if (run->wild > MOST_WILD) return NOT_FINITE;
            if (way >= 0 && way < LEAST_WAY * run->t_end) return STALLED;
            run->t_looked = run->t;
            run->since = run->wild = 0;
        }
        if (left <= 0) return MORE;
    }
}
