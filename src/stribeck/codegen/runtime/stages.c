/* ---- An attempt at a step, stage by stage, of a system that is compiled as C. In WebAssembly it is straight-line code
   (codegen/emitted.py).                                                                                               */

/* What the stages of an attempt at a step share. */
typedef struct {
    Jacobian jac;
    Factors fac;
    real f0[N], df_dt[N], h, inv_h, shift, inv_shift;
} Attempt;

/* Begin one of length h; f0, df_dt and jac are known. */
static inline void begin_attempt(const Parameters *p, const Coefficients *c, real h, Attempt *a)
{
    a->h = h;
    a->inv_h = 1 / h;
    a->shift = a->inv_h * (1 / GAMMA);
    a->inv_shift = h * GAMMA;
    factorise(p, c, &a->jac, a->shift, a->inv_shift, &a->fac);
}

/* Stage s. The last two begin where the one before them ended. */
ALWAYS_INLINE static inline void stage(int s, const Parameters *p, const Coefficients *c, const Segment *piece, real t,
                                       const real *x, const Attempt *a, real k[STAGES][N], real *x_new)
{
    real right[N], at[N]; /* at: kept in registers; what later stages need of it is stored */
    if (s == 0) {
        for (int i = 0; i < N; i++) right[i] = a->f0[i];
    } else {
        for (int i = 0; i < N; i++) {
            at[i] = s > STAGES - 3 ? x_new[i] + k[s - 1][i] : x[i];
            if (s <= STAGES - 3)
                UNROLL for (int j = 0; j < s; j++) at[i] += A[s][j] * k[j][i];
            if (s >= STAGES - 3) x_new[i] = at[i];
        }
        rates(p, c, piece, t + NODE[s] * a->h, at, right);
        for (int i = 0; i < N; i++) {
            real sum = splat(0);
            UNROLL for (int j = 0; j < s; j++) sum += C[s][j] * k[j][i];
            right[i] += sum * a->inv_h;
        }
    }
    if (TIME[s] != 0)
        for (int i = 0; i < N; i++)
            if (BY_TIME[i]) right[i] += TIME[s] * a->h * a->df_dt[i];
    solve(p, c, &a->jac, a->shift, a->inv_shift, &a->fac, right, k[s]);
}

/* After the last stage: the new state, and its squared error against the tolerances. */
static inline real end_attempt(const real *atol, real rtol, const real *x, real k[STAGES][N], real *x_new)
{
    for (int i = 0; i < N; i++) x_new[i] += k[STAGES - 1][i];
    return scaled_square(atol, rtol, x, x_new, k[STAGES - 1]);
}

/* The errors e of the states after a time h: see CARRY in method.c. */
static inline void carry_for(const Parameters *p, const Coefficients *c, const Jacobian *jac, real h, real *e)
{
    const real inv_shift = h * CARRY_GAMMA, shift = 1 / inv_shift;
    real right[N], a[N], b[N];
    Factors fac;
    factorise(p, c, jac, shift, inv_shift, &fac);
    for (int i = 0; i < N; i++) right[i] = shift * e[i];
    solve(p, c, jac, shift, inv_shift, &fac, right, a);
    for (int i = 0; i < N; i++) right[i] = shift * a[i];
    solve(p, c, jac, shift, inv_shift, &fac, right, b);
    for (int i = 0; i < N; i++) e[i] = CARRY[0] * a[i] + CARRY[1] * b[i];
}
