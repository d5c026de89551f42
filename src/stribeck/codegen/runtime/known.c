/* ---- One system's own C: its sizes are known when it is compiled. any.c is the counterpart for WebAssembly. ----------- */

#define MAY_CROSS(...) 1 /* note_events finds out by itself */
#define PRESENT(name) \
    Segment name##_now; \
    present(run, (double *)&name##_now); \
    const Segment *name = &name##_now;
#define WORKPLACE(run) \
    const Parameters parameters = *(const Parameters *)run->parameters, *p = &parameters; \
    Coefficients coefficients, *c = &coefficients; \
    Attempt now = {0}, *work = &now; \
    double k[STAGES][N];

/* The rates and their derivatives at the beginning of a step. */
ALWAYS_INLINE static inline void linearise(const Parameters *p, const Coefficients *c, const Segment *piece, double t,
                                           const double *x, Attempt *work)
{
    rates(p, c, piece, t, x, work->f0);
    jacobian(p, c, piece, t, x, &work->jac, work->df_dt);
}

/* A step of length h from x: the stages k, the new state, and its squared error against the tolerances. */
ALWAYS_INLINE static inline double attempt(const Parameters *p, const Coefficients *c, const Segment *piece, double t,
                                           const double *x, double h, Attempt *work, double k[STAGES][N], double *x_new,
                                           const double *atol, double rtol)
{
    begin_attempt(p, c, h, work);
    UNROLL for (int s = 0; s < STAGES; s++) stage(s, p, c, piece, t, x, work, k, x_new);
    return end_attempt(atol, rtol, x, k, x_new);
}

/* The friction forces at the beginning of a step; what errors e of the states change them by, and the sizes of its terms. */
typedef Attempt Work;
UNUSED static inline void observed(const Parameters *p, const Coefficients *c, const Work *work, const double *e, double *F,
                                   double *F_error, double *F_terms)
{
    observe(p, c, &work->jac, e, F, F_error, F_terms);
}

/* The same as carry_for(). Not inlined: it comes once in several steps, which it would slow down. */
static NOINLINE void carry(const Parameters *p, const Coefficients *c, const Work *work, double h, double *e)
{
    carry_for(p, c, &work->jac, h, e);
}

/* The dense output's coefficients of every state, and the states after the share s of a step. */
static inline void all_dense(double k[STAGES][N], double d[N][3])
{
    for (int i = 0; i < N; i++) dense(k, i, d[i]);
}
static inline void within_step(double s, const double *x, const double *x_new, double d[N][3], double *row)
{
    for (int i = 0; i < N; i++) row[i] = interpolate(s, x[i], x_new[i], d[i][0], d[i][1], d[i][2]);
}
