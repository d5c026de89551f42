/* ---- Many trajectories in the lanes of vectors: each with its own time and step, its lane refilled when it is done. - */

/* What Python and C share: simulation/layout.py reads the fields from here. Arrays of several numbers a trajectory hold
   them one trajectory after the other. */
typedef struct {
    const double *parameters;     /* the fields of Parameters */
    const double *atol, *fixed_atol; /* absolute tolerances of the states: see run.c */
    const double *x0;             /* the state at t = 0 */
    const double *thresholds;     /* of the watched quantities, 0 for none */
    const double *h_limit, *rtol;
    const double *force_tolerance; /* how far a step may err in each friction force; NULL: as the states' tolerances say */
    double *largest;              /* MEASURES numbers of each trajectory: its largest states, ... (see run.c) */
    const double *noise;          /* standard normal numbers, noise_room for each sampled controller */
    double *queue;                /* outputs of sampled controllers that do not act yet: queue_room for each */
    const int64_t *piece_first, *piece_end; /* where a trajectory's pieces begin and end in the arrays below */
    const double *piece_start, *piece_rows;
    double *out;                  /* rows of states and held outputs */
    const int8_t *piece_restart;
    int64_t *rows_reached, *status, *accepted, *rejected;
    int64_t *happened;            /* how often each event came: four of every watched quantity */
    double *t_reached;
    int64_t *turn;                /* shared by all threads: the next trajectory, how many are finished, whether to stop */
    double t_end, step;
    int64_t count, rows, most_attempts, queue_room, noise_room;
    int64_t rows_are_steps;       /* whether each row ends a step, so that none is interpolated */
    int64_t groups;               /* how many vectors a thread may take, at most GROUPS */
} Batch;

enum { DONE = 0, GAVE_UP = 1, STEP_TOO_SMALL = -1, NOT_FINITE = -2, STALLED = -4 };

enum { MEASURES = 2 * N + 5 * FORCES }; /* as in run.c */

EXPORT int64_t stribeck_batch_size(void) { return (int64_t)sizeof(Batch); }
EXPORT int64_t stribeck_lanes(void) { return LANES; }

typedef struct {
    Parameters p;
    Coefficients c;
    Segment piece;
#if HELD > 0
    real timing[2 * HELD];
    Memory memory;
    int64_t sampled[HELD][LANES], acted[HELD][LANES];
#endif
#if WATCHES > 0
    real threshold[WATCHES];               /* nan where nothing is looked out for */
#endif
    real largest[MEASURES], force_tolerance[FORCES + 1];
    real rtol, atol[N], fixed_atol[N], atol_now[N], size; /* see follow() */
    real carried[N], carried_to;       /* see carry_errors() in run.c */
    mask carried_steps;
    real x[N], t, h, h_limit, t_stop, last_h, last_root;
    real row_t;                        /* the time of the next row */
    real output_h;                     /* the step to begin with after an output; 0: not known yet */
    mask accepted, rejected, held;     /* counts; held: the last attempt was rejected */
    mask look_at, wild;                /* attempts after which it is looked whether the lane gets on; those not finite */
    double t_looked[LANES];            /* where it was at the last look */
    int64_t index[LANES], piece_at[LANES], row[LANES]; /* index -1: no trajectory left for this lane */
    int restart[LANES], after_output[LANES];
    int64_t alive;
    Attempt now;                       /* the attempt at a step under way, until when it goes, whether to t_stop */
    real k[STAGES][N], x_new[N], t_new;
    mask last;
    int anew;                          /* whether a lane restarts */
} Lanes;

static int64_t of_lane(const Batch *b, const Lanes *l, int lane)
{
    return l->index[lane] < 0 ? b->count - 1 : l->index[lane];
}

/* Put a row of numbers into a lane of a struct of vectors, or one lane's numbers into another struct. */
static inline void put_lane(void *vectors, int lane, const double *numbers, int count)
{
    double *to = (double *)vectors;
    for (int m = 0; m < count; m++) to[m * LANES + lane] = numbers[m];
}
UNUSED static inline void copy_lane(void *vectors, int lane, const void *others, int count)
{
    double *to = (double *)vectors;
    const double *from = (const double *)others;
    for (int m = 0; m < count; m++) to[m * LANES + lane] = from[m * LANES + lane];
}

/* Until when a lane may step. */
static void find_stop(const Batch *b, Lanes *l, int lane)
{
    const int64_t i = of_lane(b, l, lane), q = l->piece_at[lane];
    const int more = q + 1 < b->piece_end[i] && b->piece_start[q + 1] < b->t_end;
    double stop = more ? b->piece_start[q + 1] : b->t_end;
#if HELD > 0
    for (int m = 0; m < HELD; m++) {
        const double next = (double)l->acted[m][lane] * l->timing[m][lane] + l->timing[HELD + m][lane];
        stop = next < stop ? next : stop;
    }
#endif
    if (b->rows_are_steps && l->index[lane] >= 0) {
        int64_t r = l->row[lane];
        while ((double)r * b->step <= l->t[lane] * (1 + SAME_TIME)) r++;
        if (r < b->rows && (double)r * b->step < stop) stop = (double)r * b->step;
    }
    l->t_stop[lane] = stop;
}

static void put_row(const Batch *b, Lanes *l, int lane, const double *x)
{
    double *row = b->out + (l->index[lane] * b->rows + l->row[lane]++) * (N + HELD);
    for (int n = 0; n < N; n++) row[n] = x[n];
    for (int m = 0; m < HELD; m++) row[N + m] = ((const double *)&l->piece)[(PIECE + m) * LANES + lane];
}

static void put_present_rows(const Batch *b, Lanes *l, int lane, double until)
{
    l->row_t[lane] = INFINITY;
    if (l->index[lane] < 0) return;
    double x[N];
    for (int n = 0; n < N; n++) x[n] = l->x[n][lane];
    while (l->row[lane] < b->rows && (double)l->row[lane] * b->step <= until) put_row(b, l, lane, x);
    if (l->row[lane] < b->rows) l->row_t[lane] = (double)l->row[lane] * b->step;
}

UNUSED static void count_event(const Batch *b, const Lanes *l, int lane, int which, int what)
{
    if (l->index[lane] >= 0) b->happened[(l->index[lane] * WATCHES + which) * 4 + what]++;
}

#if HELD > 0
/* The samples of a lane before t_before within its step of length h, or at its present state where h is 0. */
static void take_samples(const Batch *b, Lanes *l, int lane, double h, double t_before, real k[STAGES][N],
                         const real *x_new)
{
    const int64_t i = of_lane(b, l, lane);
    for (int m = 0; m < HELD; m++)
        for (double t; (t = (double)l->sampled[m][lane] * l->timing[m][lane]) < t_before;) {
            real x[N], u;
            double s = h > 0 ? (t - l->t[lane]) / h : 0;
            s = s > 0 ? s : 0;
            for (int n = 0; n < N; n++) {
                x[n] = l->x[n];
                if (h > 0) {
                    double d[3] = {0, 0, 0};
                    for (int q = 0; q < 3; q++)
                        for (int e = 0; e < STAGES; e++) d[q] += DENSE[q][e] * k[e][n][lane];
                    x[n][lane] = interpolate(s, l->x[n][lane], x_new[n][lane], d[0], d[1], d[2]);
                }
            }
            const int64_t q = l->sampled[m][lane]++;
            const double noise = q < b->noise_room ? b->noise[m * b->noise_room + q] : 0;
            Memory after = l->memory;
            sample(m, &l->p, &l->c, &l->piece, splat(t), x, splat(noise), &after, &u);
            copy_lane(&l->memory, lane, &after, (int)(sizeof(Memory) / sizeof(real)));
            b->queue[(i * HELD + m) * b->queue_room + q % b->queue_room] = u[lane];
        }
}

/* The outputs of a lane that are due begin to act; whether one changed. */
static int act(const Batch *b, Lanes *l, int lane)
{
    const int64_t i = of_lane(b, l, lane);
    double *held = (double *)&l->piece + PIECE * LANES + lane;
    int changed = 0;
    for (int m = 0; m < HELD; m++)
        while (l->acted[m][lane] < l->sampled[m][lane]
               && (double)l->acted[m][lane] * l->timing[m][lane] + l->timing[HELD + m][lane]
                      <= l->t[lane] * (1 + SAME_TIME)) {
            const int64_t q = l->acted[m][lane]++;
            const double u = b->queue[(i * HELD + m) * b->queue_room + q % b->queue_room];
            changed |= u != held[m * LANES];
            held[m * LANES] = u;
        }
    return changed;
}
#endif

/* Go on to the pieces of a lane that have begun, and to the outputs of its controllers; note what jumps there. */
static void pass(const Batch *b, Lanes *l, int lane, int first)
{
    const int64_t i = of_lane(b, l, lane), before = l->piece_at[lane];
    const double now = l->t[lane] * (1 + SAME_TIME);
    const Segment old = l->piece;
    while (l->piece_at[lane] + 1 < b->piece_end[i] && b->piece_start[l->piece_at[lane] + 1] <= now) {
        const int why = b->piece_restart[++l->piece_at[lane]];
        if (why == JUMP || !l->restart[lane]) l->restart[lane] = why;
    }
    put_lane(&l->piece, lane, b->piece_rows + l->piece_at[lane] * PIECE, PIECE);
#if HELD > 0
    take_samples(b, l, lane, 0, now + (now > 0 ? 0 : 1e-300), NULL, NULL);
    if (act(b, l, lane) && !l->restart[lane]) l->restart[lane] = OUTPUT;
#endif
    find_stop(b, l, lane);
    (void)before, (void)old;
    if (first) return;
#if MOVED >= 0
    if (l->piece_at[lane] != before) {
        const real more = moved_energy(&l->p, &l->c, &l->piece, l->t, l->x) - moved_energy(&l->p, &l->c, &old, l->t, l->x);
        l->x[MOVED][lane] += more[lane];
    }
#endif
#if WATCHES > 0
    if (l->restart[lane] != JUMP && l->restart[lane] != OUTPUT) return;
    real w0[WATCHES], w1[WATCHES];
    watch(&l->p, &l->c, &old, l->t, l->x, w0);
    watch(&l->p, &l->c, &l->piece, l->t, l->x, w1);
    for (int j = 0; j < WATCHES; j++) {
        const double threshold = l->threshold[j][lane], a = w0[j][lane], z = w1[j][lane];
        if (!(threshold > 0)) continue;
        if ((a >= threshold) != (z >= threshold)) count_event(b, l, lane, j, !(z >= threshold));
        if ((-a >= threshold) != (-z >= threshold)) count_event(b, l, lane, j, AT_MINUS | !(-z >= threshold));
    }
#endif
}

/* Put the next trajectory into a lane; a lane for which none is left repeats the last one, unheard. */
static void refill(const Batch *b, Lanes *l, int lane)
{
    const int64_t next = __atomic_fetch_add(&b->turn[0], 1, __ATOMIC_RELAXED);
    const int none = next >= b->count;
    const int64_t i = none ? b->count - 1 : next;
    const int width = (int)(sizeof(Parameters) / sizeof(real));
    l->alive += !none - (l->index[lane] >= 0);
    l->index[lane] = none ? -1 : i;
    put_lane(&l->p, lane, b->parameters + i * width, width);
    put_lane(l->atol, lane, b->atol + i * N, N);
    put_lane(l->fixed_atol, lane, b->fixed_atol + i * N, N);
    for (int n = 0; n < N; n++) l->atol_now[n][lane] = 0;
    for (int n = 0; n < N; n++) l->carried[n][lane] = 0;
    l->carried_to[lane] = l->carried_steps[lane] = 0;
    l->rtol[lane] = b->rtol[i];
    l->size[lane] = LEAST_SIZE;
    if (b->force_tolerance) put_lane(l->force_tolerance, lane, b->force_tolerance + i * FORCES, FORCES);
    for (int m = 0; m < MEASURES; m++) l->largest[m][lane] = 0;
    put_lane(l->x, lane, b->x0 + i * N, N);
    l->t[lane] = 0;
    l->h[lane] = 1e300;
    l->h_limit[lane] = b->h_limit[i];
    l->last_h[lane] = l->output_h[lane] = 0;
    l->last_root[lane] = 1;
    l->accepted[lane] = l->rejected[lane] = l->held[lane] = 0;
    l->look_at[lane] = b->most_attempts < LOOK ? b->most_attempts : LOOK;
    l->t_looked[lane] = 0;
    l->wild[lane] = 0;
    l->row[lane] = 0;
    l->piece_at[lane] = b->piece_first[i];
    put_lane(&l->piece, lane, b->piece_rows + l->piece_at[lane] * PIECE, PIECE);
#if WATCHES > 0
    for (int j = 0; j < WATCHES; j++) {
        const double threshold = b->thresholds[i * WATCHES + j];
        l->threshold[j][lane] = !none && threshold > 0 ? threshold : NAN;
    }
#endif
#if HELD > 0
    const double zero[HELD] = {0}, empty[sizeof(Memory) / sizeof(real)] = {0};
    put_lane((real *)&l->piece + PIECE, lane, zero, HELD);
    put_lane(&l->memory, lane, empty, (int)(sizeof(Memory) / sizeof(real)));
    find_timing(&l->p, l->timing);
    prepare(&l->p, &l->c);
    for (int m = 0; m < HELD; m++) l->sampled[m][lane] = l->acted[m][lane] = 0;
    if (none) /* its outputs would go where those of the last trajectory wait */
        for (int m = 0; m < HELD; m++) l->sampled[m][lane] = l->acted[m][lane] = INT64_MAX / 4;
#endif
    pass(b, l, lane, 1);
    put_present_rows(b, l, lane, 0);
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
        for (int m = 0; m < MEASURES; m++) b->largest[i * MEASURES + m] = l->largest[m][lane];
        __atomic_fetch_add(&b->turn[1], 1, __ATOMIC_RELAXED);
    }
    refill(b, l, lane);
}

/* The rows within a lane's step that come before t_before or at t_new; d: of its dense output. */
static void write_rows(const Batch *b, Lanes *l, int lane, double h, double t_new, double t_before, real d[N][3],
                       const real *x_new)
{
    double t = l->row_t[lane];
    for (; l->row[lane] < b->rows && (t = (double)l->row[lane] * b->step) <= t_new && t < t_before;) {
        const double s = (t - l->t[lane]) / h;
        double x[N];
        for (int n = 0; n < N; n++)
            x[n] = interpolate(s, l->x[n][lane], x_new[n][lane], d[n][0][lane], d[n][1][lane], d[n][2][lane]);
        put_row(b, l, lane, x);
    }
    l->row_t[lane] = l->row[lane] < b->rows ? t : INFINITY;
}
