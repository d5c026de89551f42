/* ---- The runtime for any system, built to WebAssembly once, with the package (tools/make_runtime.py): what known.c and a
   system's own C say when it is compiled stands here in memory, or is imported (codegen/emitted.py).                  ---- */

typedef struct {
    int32_t n, piece, held, shown, watches, watched, curved, moved, forces;
    double *k; /* what attempt gives of each stage */
    int32_t watched_states[64], is_curved[64];
} Shape;
EXPORT Shape shape; /* filled by simulation/wasm.py and the explorer's page */
#define N shape.n
#define PIECE shape.piece
#define HELD shape.held
#define SHOWN shape.shown
#define WATCHES shape.watches
#define WATCHED shape.watched
#define CURVED shape.curved
#define MOVED shape.moved
#define FORCES shape.forces
#define WATCHED_STATES shape.watched_states
#define IS_CURVED shape.is_curved
#define MAY_WATCH 1
#define MAY_CURVE 1
#define MAY_HOLD 1
#define MAY_SHOW 1
#define MAY_MOVE 1
#define MAY_OBSERVE 1

/* Constants, coefficients, the linearisation and the stages lie where the system's functions look for them: a pointer less
   is a register more, and the fifth pointer of a call waits for its way through memory. */
typedef real Work;
typedef struct { real none; } Parameters, Coefficients, Segment, Memory; /* their fields: codegen/emitted.py */
#define OF_SYSTEM(name) __attribute__((import_module("system"), import_name(#name)))
#define AT const Segment *piece, real t, const real *x
OF_SYSTEM(prepare) void prepare_system(const Parameters *p);
OF_SYSTEM(rates) void rates_of_system(AT, real *dx);
OF_SYSTEM(linearise) void linearise_system(AT);
OF_SYSTEM(attempt) real attempt_of_system(AT, real h, real *x_new, const real *atol, real rtol);
OF_SYSTEM(observe) void observe_system(const real *e, real *F, real *F_error, real *F_terms);
OF_SYSTEM(carry) void carry_of_system(real h, real *e);
OF_SYSTEM(watch) void watch_system(AT, real *w);
OF_SYSTEM(watch_dense) void watch_dense_of_system(const real *dx, real *dw);
OF_SYSTEM(moved_energy) real moved_energy_of_system(AT);
OF_SYSTEM(sample) void sample_system(int which, AT, real noise, Memory *m, real *u);
OF_SYSTEM(find_timing) void find_timing_of_system(real *timing);
#define prepare(p, c) prepare_system(p)
#define rates(p, c, piece, t, x, dx) rates_of_system(piece, t, x, dx)
#define linearise(p, c, piece, t, x, work) linearise_system(piece, t, x)
#define attempt(p, c, piece, t, x, h, work, k, x_new, atol, rtol) attempt_of_system(piece, t, x, h, x_new, atol, rtol)
#define observed(p, c, work, e, F, F_error, F_terms) observe_system(e, F, F_error, F_terms)
#define carry(p, c, work, h, e) carry_of_system(h, e)
#define all_dense(k, d) for (int i = 0; i < N; i++) dense(k, i, (d)[i])
#define within_step(s, x, x_new, d, row) \
    for (int i = 0; i < N; i++) (row)[i] = interpolate(s, (x)[i], (x_new)[i], (d)[i][0], (d)[i][1], (d)[i][2])
#define watch(p, c, piece, t, x, w) watch_system(piece, t, x, w)
#define watch_dense(p, c, dx, dw) watch_dense_of_system(dx, dw)
#define moved_energy(p, c, piece, t, x) moved_energy_of_system(piece, t, x)
#define sample(which, p, c, piece, t, x, noise, m, u) sample_system(which, piece, t, x, noise, m, u)
#define find_timing(p, timing) find_timing_of_system(timing)

#define MAY_CROSS(...) (WATCHES > 0)
#define PRESENT(name) \
    double name##_numbers[PIECE + HELD + 1]; \
    present(run, name##_numbers); \
    const Segment *name = (const Segment *)name##_numbers;
#define WORKPLACE(run) \
    const Parameters *p = (const Parameters *)run->parameters; \
    Coefficients *c = 0; \
    double *work = 0, (*k)[N] = (double(*)[N])shape.k;

/* What the code of a system calls. */
#define CALLED(name) EXPORT real call_##name(real x) { return name##_of(x); }
CALLED(exp) CALLED(log) CALLED(sin) CALLED(cos) CALLED(atan) CALLED(tanh)
EXPORT real call_near_atan(real x) { return atan(x); }
EXPORT real call_pow(real x, real y) { return pow_of(x, y); }
#define SAME(name) EXPORT real call_same_##name(real x) { return same_##name(x); }
SAME(exp) SAME(tanh) SAME(atan) SAME(sin) SAME(cos)
