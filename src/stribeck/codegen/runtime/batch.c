/* ---- A batch of trajectories: attempts at steps of all lanes, and what becomes of each. ------------------------------- */

/* Steps of lanes that start anew or come out of a breakpoint. */
static void restart(Lanes *l)
{
    prepare(&l->p, &l->c);
    const real h = first_step(l->atol_now, l->rtol, &l->p, &l->c, &l->piece, l->t, l->x, l->t_stop - l->t);
    for (int lane = 0; lane < LANES; lane++)
        if (l->restart[lane]) {
            const int output = l->restart[lane] == OUTPUT;
            double wanted = h[lane] * (l->restart[lane] == CORNER ? CORNER_EASE : 1);
            if (output && l->output_h[lane] > 0) wanted = l->output_h[lane];
            l->h[lane] = wanted < l->h[lane] ? wanted : l->h[lane];
            l->last_h[lane] = 0;
            l->held[lane] = 0;
            l->restart[lane] = 0;
            l->after_output[lane] = output;
        }
}

/* What happened to single lanes in a step: rows to write, samples, breakpoints, failures. Sets of lanes are bits. */
static void attend(const Batch *b, Lanes *l, unsigned attention, unsigned rows, unsigned last, unsigned failed, mask good,
                   real h, real t_new, real error, real k[STAGES][N], const real *x_new)
{
    real d[N][3];
    if (rows)
        for (int n = 0; n < N; n++) dense(k, n, d[n]);
#if FORCES > 0
    if (rows) {
        const mask within = good & (l->row_t < t_new); /* no lane's numbers depend on its neighbours' rows */
        real last[N], F[FORCES], F_last[FORCES], size[FORCES];
        for (int n = 0; n < N; n++) last[n] = 27.0 / 256 * d[n][2]; /* s^3 (1 - s) is at most 27/256 */
        observe(&l->p, &l->c, &l->now.jac, last, F, F_last, size);
        for (int q = 0; q < FORCES; q++) {
            real *largest = l->largest + N + 2 * FORCES + q;
            *largest = choose(within, larger(abs_of(F_last[q]), *largest), *largest);
        }
    }
#endif
    for (; attention; attention &= attention - 1) {
        const int lane = first_lane(attention);
        const unsigned bit = 1u << lane;
        if (failed & bit) {
            const int64_t tried = l->accepted[lane] + l->rejected[lane];
            const int looked = tried > l->look_at[lane], wild = looked ? l->wild[lane] > MOST_WILD : !(error[lane] < 1e30);
            const int why = wild ? NOT_FINITE : looked ? STALLED : STEP_TOO_SMALL;
            finish(b, l, lane, tried < b->most_attempts ? why : GAVE_UP);
            l->anew |= l->restart[lane];
            continue;
        }
        const double t_before = last & bit ? l->t_stop[lane] * (1 - SAME_TIME) : INFINITY;
        if (rows & bit) write_rows(b, l, lane, h[lane], t_new[lane], t_before, d, x_new);
#if HELD > 0
        if (good[lane])
            take_samples(b, l, lane, h[lane], last & bit ? t_before : t_new[lane] * (1 - SAME_TIME), k, x_new);
#else
        (void)good;
#endif
        if (last & bit) {
            for (int n = 0; n < N; n++) l->x[n][lane] = x_new[n][lane];
            l->t[lane] = t_new[lane];
            pass(b, l, lane, 0);
            put_present_rows(b, l, lane, t_new[lane] * (1 + SAME_TIME));
            if (l->t[lane] >= b->t_end) finish(b, l, lane, DONE);
            l->anew |= l->restart[lane];
        }
    }
}

#if WATCHES > 0
/* Where a watched quantity may pass its threshold in a step; w holds its given ends and gets, between them, the coefficients
   of its dense output, or its values at equal distances where it is no linear function of the states. */
static mask look_out(const Lanes *l, real h, real k[STAGES][N], const real *x_new, real w[5][WATCHES])
{
    real d[3][N];
    mask events = l->accepted & 0;
    for (int i = 0; i < WATCHED; i++) {
        real of_state[3];
        dense(k, WATCHED_STATES[i], of_state);
        for (int m = 0; m < 3; m++) d[m][WATCHED_STATES[i]] = of_state[m];
    }
    for (int m = 0; m < 3; m++) watch_dense(&l->p, &l->c, d[m], w[m + 1]);
#if CURVED > 0
    for (int q = 1; q < 4; q++) {
        real x[N], inside[WATCHES];
        const double s = 0.25 * q;
        for (int n = 0; n < N; n++) x[n] = l->x[n];
        for (int i = 0; i < WATCHED; i++) {
            const int n = WATCHED_STATES[i];
            x[n] = (1 - s) * l->x[n] + s * (x_new[n] + (1 - s) * (d[0][n] + s * (d[1][n] + s * d[2][n])));
        }
        watch(&l->p, &l->c, &l->piece, l->t + s * h, x, inside);
        for (int j = 0; j < WATCHES; j++)
            if (IS_CURVED[j]) w[q][j] = inside[j];
    }
#else
    (void)h, (void)x_new;
#endif
    for (int j = 0; j < WATCHES; j++) {
        real low = smaller(w[0][j], w[4][j]), high = larger(w[0][j], w[4][j]);
        if (IS_CURVED[j]) { /* a quartic strays from the values that it passes by a share of their range */
            for (int q = 1; q < 4; q++) {
                low = smaller(low, w[q][j]);
                high = larger(high, w[q][j]);
            }
            const real stray = high - low;
            low -= stray;
            high += stray;
        } else { /* it strays from its chord by at most this */
            const real stray = 0.25 * (abs_of(w[1][j]) + abs_of(w[2][j]) + abs_of(w[3][j]));
            low -= stray;
            high += stray;
        }
        const real threshold = l->threshold[j];
        events |= ((low <= threshold) & (high >= threshold)) | ((low <= -threshold) & (high >= -threshold));
    }
    return events;
}

/* Count what happened in a step. */
static void count_events(const Batch *b, const Lanes *l, mask events, const real w[5][WATCHES])
{
    for (int lane = 0; lane < LANES; lane++)
        for (int j = 0; events[lane] && j < WATCHES; j++) {
            double q[5];
            int8_t what[MOST_EVENTS];
            if (!(l->threshold[j][lane] > 0)) continue;
            if (IS_CURVED[j]) {
                const double f[5] = {w[0][j][lane], w[1][j][lane], w[2][j][lane], w[3][j][lane], w[4][j][lane]};
                bernstein_of_values(f, q);
            } else
                bernstein_of_dense(w[0][j][lane], w[4][j][lane], w[1][j][lane], w[2][j][lane], w[3][j][lane], q);
            const int count = events_within(l->threshold[j][lane], q, NULL, what);
            for (int e = 0; e < count; e++) count_event(b, l, lane, j, what[e]);
        }
}
#endif

/* Of lanes that have tried often: those that get no further, or have no attempts left. */
static mask stuck(const Batch *b, Lanes *l, mask looks)
{
    for (int lane = 0; lane < LANES; lane++) {
        if (!looks[lane] || l->look_at[lane] >= b->most_attempts) continue;
        if (l->t[lane] - l->t_looked[lane] < LEAST_WAY * b->t_end || l->wild[lane] > MOST_WILD) continue;
        l->t_looked[lane] = l->t[lane];
        l->wild[lane] = 0;
        l->look_at[lane] += b->most_attempts - l->look_at[lane] < LOOK ? b->most_attempts - l->look_at[lane] : LOOK;
        looks[lane] = 0;
    }
    return looks;
}

/* Begin an attempt at a step of each lane. */
static inline void begin(Lanes *l)
{
    follow(l->atol, l->fixed_atol, l->rtol, l->x, &l->size, l->atol_now);
    if (l->anew) restart(l);
    l->anew = 0;
    rates(&l->p, &l->c, &l->piece, l->t, l->x, l->now.f0);
    jacobian(&l->p, &l->c, &l->piece, l->t, l->x, &l->now.jac, l->now.df_dt);
    const real wanted = smaller(l->h, l->h_limit);
    l->last = l->t + wanted * 1.000001 >= l->t_stop;
    const real h = choose(l->last, l->t_stop - l->t, wanted);
    l->t_new = choose(l->last, l->t_stop, l->t + h);
    begin_attempt(&l->p, &l->c, h, &l->now);
}

/* See carry_errors() in run.c; of the lanes whose step was good. */
static inline void carry_errors(Lanes *l, mask good)
{
    const real half = l->t - l->carried_to;
    l->carried_steps -= good & (half > 0);
    const mask now = l->carried_steps >= CARRIED_STEPS;
    if (HELD || !lanes_in(now)) return;
    l->carried_steps = l->carried_steps & ~now;
    real e[N], *largest = l->largest + N + 4 * FORCES;
    for (int n = 0; n < N; n++) e[n] = l->carried[n];
    carry_for(&l->p, &l->c, &l->now.jac, choose(now, 2 * half, splat(1)), e);
    for (int n = 0; n < N; n++) {
        const real rounding = ROUNDING * abs_of(l->x[n]);
        l->carried[n] = choose(now, choose(e[n] < 0, e[n] - rounding, e[n] + rounding), l->carried[n]);
        largest[n] = choose(abs_of(l->carried[n]) <= largest[n], largest[n], abs_of(l->carried[n])); /* nan is kept, too */
    }
    l->carried_to = choose(now, l->t + half, l->carried_to);
#if FORCES > 0
    real F[FORCES], F_error[FORCES], F_terms[FORCES];
    observe(&l->p, &l->c, &l->now.jac, l->carried, F, F_error, F_terms);
    for (int q = 0; q < FORCES; q++) largest[N + q] = choose(now, larger(abs_of(F_error[q]), largest[N + q]), largest[N + q]);
#endif
}

/* After its stages: accept or reject, each lane for itself, and choose the next step. */
static inline void end(const Batch *b, Lanes *l)
{
    real(*k)[N] = l->k;
    const real *x_new = l->x_new, h = l->now.h, t_new = l->t_new;
    const mask last = l->last;
    real error = end_attempt(l->atol_now, l->rtol, l->x, l->k, l->x_new);
#if FORCES > 0
    real F[FORCES], F_error[FORCES], F_terms[FORCES];
    observe(&l->p, &l->c, &l->now.jac, k[STAGES - 1], F, F_error, F_terms);
    for (int q = 0; b->force_tolerance && q < FORCES; q++) {
        const real ratio = F_error[q] / l->force_tolerance[q], square = ratio * ratio;
        error = choose((square > error) | (square != square), square, error);
    }
#endif
    real share = splat(1);
#if WATCHES > 0
    real w[5][WATCHES];
    watch(&l->p, &l->c, &l->piece, l->t, l->x, w[0]);
    watch(&l->p, &l->c, &l->piece, t_new, x_new, w[4]);
    share = share_to_zero(l->threshold, w[0], w[4]);
    share = choose(l->t + share * h * 0.25 > l->t, share, splat(1));
#endif
    const mask over = (error <= 1) & (share < 1), good = (error <= 1) & ~over, finite = error < 1e30;
    const real root = steering(error), plain = growth(root);
    real factor = choose(l->last_h > 0, predictive_growth(root, h, l->last_root, l->last_h), plain);
    factor = choose(l->held & (factor > 1), splat(1), factor);
    const real grown = h * choose(good, factor, choose(over, share, choose(finite, plain, splat(0.1))));
    const real next_h = choose(good & last, larger(l->h, grown), grown);
    const mask rows = good & (t_new >= l->row_t), ends = good & last;
    const mask tried = l->accepted + l->rejected;
    mask failed = ~good & ((l->t + next_h * 0.25 <= l->t) | (next_h < 1e-290));
    const mask looks = tried >= l->look_at;
    if (lanes_in(looks)) failed |= stuck(b, l, looks);
#if WATCHES > 0 /* apart from the rest, which comes often: this branch hardly ever does, and the other need not wait for it */
    const mask events = good & ~failed & look_out(l, h, k, x_new, w);
    if (lanes_in(events)) count_events(b, l, events, (const real(*)[WATCHES])w);
#endif
    carry_errors(l, good);
    for (int n = 0; n < N; n++) l->carried[n] = choose(good, l->carried[n] + k[STAGES - 1][n], l->carried[n]);
    for (int n = 0; n < N; n++) l->largest[n] = choose(good, larger(abs_of(x_new[n]), l->largest[n]), l->largest[n]);
#if FORCES > 0
    for (int q = 0; q < FORCES; q++) {
        real *peak = l->largest + N + q, *err = peak + FORCES;
        *peak = choose(good, larger(abs_of(F[q]), *peak), *peak);
        *err = choose(good, larger(abs_of(F_error[q]), *err), *err);
    }
    if (b->force_tolerance) observe(&l->p, &l->c, &l->now.jac, l->x, F, F_error, F_terms);
    for (int q = 0; b->force_tolerance && q < FORCES; q++) {
        real *terms = l->largest + N + 3 * FORCES + q;
        *terms = choose(good, larger(F_terms[q], *terms), *terms);
    }
#endif
    l->accepted -= good; /* true is -1 */
    l->rejected -= ~good;
    l->wild -= ~finite;
    l->h = next_h;
    l->held = ~good;
    l->last_h = choose(good, h, l->last_h);
    l->last_root = choose(good, remembered(root), l->last_root);
    const unsigned row_bits = lanes_in(rows), end_bits = lanes_in(ends), failed_bits = lanes_in(failed);
    unsigned attention = row_bits | end_bits | failed_bits;
#if HELD > 0
    for (int lane = 0; lane < LANES; lane++) {
        if (good[lane] && l->after_output[lane]) {
            const double begun = last[lane] && l->output_h[lane] > grown[lane] ? l->output_h[lane] : grown[lane];
            l->output_h[lane] = begun;
            l->after_output[lane] = 0;
        }
        for (int m = 0; m < HELD; m++)
            if (good[lane] && (double)l->sampled[m][lane] * l->timing[m][lane] <= t_new[lane])
                attention |= 1u << lane;
    }
#endif
    if (attention) attend(b, l, attention, row_bits, end_bits, failed_bits, good, h, t_new, error, k, x_new);
    const mask moves = good & ~ends & ~failed; /* the others were moved, or given another trajectory, above */
    for (int n = 0; n < N; n++) l->x[n] = choose(moves, x_new[n], l->x[n]);
    l->t = choose(moves, t_new, l->t);
}

/* Solve trajectories of the batch until none is left; several threads may do so at once. The stages of several vectors
   take turns, so that one computes while another waits for its numbers. */
EXPORT void stribeck_solve_batch(const Batch *b)
{
    Lanes lanes[GROUPS] = {{.alive = 0}}, *live[GROUPS];
    int groups = b->groups < GROUPS ? (int)b->groups : GROUPS;
    for (int g = 0; g < GROUPS; g++) live[g] = &lanes[g];
    for (int g = 0; g < groups; g++) {
        Lanes *l = live[g];
        for (int lane = 0; lane < LANES; lane++) l->index[lane] = -1;
        for (int lane = 0; lane < LANES; lane++) refill(b, l, lane);
        l->anew = 1;
    }
    while (!__atomic_load_n(&b->turn[2], __ATOMIC_RELAXED)) {
        for (int g = groups; g-- > 0;)
            if (live[g]->alive == 0) live[g] = live[--groups];
        if (groups == 0) break;
        for (int g = 0; g < groups; g++) begin(live[g]);
        UNROLL for (int s = 0; s < STAGES; s++)
            for (int g = 0; g < groups; g++) {
                Lanes *l = live[g];
                stage(s, &l->p, &l->c, &l->piece, l->t, l->x, &l->now, l->k, l->x_new);
            }
        for (int g = 0; g < groups; g++) end(b, live[g]);
    }
}
