/* ---- The runtime for any system, built to WebAssembly once, with the package (tools/make_runtime.py): what known.c and a
   system's own C say when it is compiled stands here in memory, or is imported (codegen/emitted.py).                  ---- */

typedef struct {
    int32_t n, piece, held, shown, watches, watched, curved, moved, forces;
    double *coefficients, *work, *k; /* room: of prepare, of linearise, and for the stages */
    int32_t watched_states[64], is_curved[64];
} Shape;
EXPORT Shape shape; /* filled by simulation/wasm.py */
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

typedef real Work;
typedef struct { real none; } Parameters, Coefficients, Segment, Memory; /* their fields: codegen/emitted.py */
#define OF_SYSTEM(name) __attribute__((import_module("system"), import_name(#name)))
#define AT const Parameters *p, const Coefficients *c, const Segment *piece, real t, const real *x
OF_SYSTEM(prepare) void prepare(const Parameters *p, Coefficients *c);
OF_SYSTEM(rates) void rates(AT, real *dx);
OF_SYSTEM(linearise) void linearise(AT, real *work);
OF_SYSTEM(attempt) real attempt_of_system(AT, real h, real *work, real *k, real *x_new, const real *atol, real rtol);
#define attempt(p, c, piece, t, x, h, work, k, x_new, atol, rtol) \
    attempt_of_system(p, c, piece, t, x, h, work, &(k)[0][0], x_new, atol, rtol)
OF_SYSTEM(observe) void observed(const Parameters *p, const Coefficients *c, const real *work, const real *e, real *F,
                                 real *F_error, real *F_terms);
OF_SYSTEM(may_cross) int may_cross(AT, real h, const real *x_new, const real *k, const double *thresholds);
OF_SYSTEM(watch) void watch(AT, real *w);
OF_SYSTEM(watch_dense) void watch_dense(const Parameters *p, const Coefficients *c, const real *dx, real *dw);
OF_SYSTEM(moved_energy) real moved_energy(AT);
OF_SYSTEM(sample) void sample(int which, AT, real noise, Memory *m, real *u);
OF_SYSTEM(find_timing) void find_timing(const Parameters *p, real *timing);

#define MAY_CROSS(p, c, piece, t, x, h, x_new, k, thresholds) \
    (WATCHES && may_cross(p, c, piece, t, x, h, x_new, &(k)[0][0], thresholds))
#define PRESENT(name) \
    double name##_numbers[PIECE + HELD + 1]; \
    present(run, name##_numbers); \
    const Segment *name = (const Segment *)name##_numbers;
#define WORKPLACE(run) \
    const Parameters *p = (const Parameters *)run->parameters; \
    Coefficients *c = (Coefficients *)shape.coefficients; \
    double *work = shape.work, (*k)[N] = (double(*)[N])shape.k;

/* What the code of a system calls. */
#define CALLED(name) EXPORT real call_##name(real x) { return name##_of(x); }
CALLED(exp) CALLED(log) CALLED(sin) CALLED(cos) CALLED(atan) CALLED(tanh)
EXPORT real call_near_atan(real x) { return atan(x); }
EXPORT real call_pow(real x, real y) { return pow_of(x, y); }
#define SAME(name) EXPORT real call_same_##name(real x) { return same_##name(x); }
SAME(exp) SAME(tanh) SAME(atan) SAME(sin) SAME(cos)
