/* ---- The method: the same for every system, and for one trajectory as for several in the lanes of a vector. ---------

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
#if defined(__GNUC__)
#define ALWAYS_INLINE __attribute__((always_inline))
#else
#define ALWAYS_INLINE
#endif
static const double GAMMA = 0.21193756319429014;
static const double NODE[STAGES] = {
    0, 0.6358126895828704, 0.4095798393397535, 0.9769306725060716, 0.4288403609558664, 1, 1, 1};
static const double TIME[STAGES] = {
    0.21193756319429014, -0.42387512638858027, -0.3384627126235924, 1.8046452872882734, 2.325825639765069, 0, 0, 0};
static const double A[STAGES - 2][STAGES] = {
    {0},
    {3.0},
    {2.849394379747939, 0.45842242204463923},
    {-6.954028509809101, 2.489845061869568, -10.358996098473584},
    {2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641},
    {-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946}}; /* of the last two: the row before, and 1 for the stage before */
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

/* The errors of the steps so far, carried on by the linearised equations: e(t + h) = R(h J) e(t), with J in the middle of h and
   R(z) = (1 + (1 - 2 g) z)/(1 - g z)^2, g = 1 - 1/sqrt(2): of order 2 and L-stable. With a = e/(1 - g z) and b = a/(1 - g z),
   R e = b + sqrt(2) (b - a). */
static const double CARRY_GAMMA = 0.29289321881345254;
static const double CARRY[2] = {-1.4142135623730951, 2.414213562373095}; /* of a and b */
static const int CARRIED_STEPS = 2;                                      /* half as often they cost 3 %, at every step 9 % */
UNUSED static const double ROUNDING = 2.220446049250313e-16;             /* an error of this share comes with each time */

static const double LEAST_SHARE = 1e-3; /* as _LEAST_PEAK in simulation/promise.py: a motion of less is solved again */
static const double LEAST_SIZE = 1e-9;  /* as _LEAST_SIZE there; with the share, 1e-12 of the natural scales: rounding */

/* Mean square of values, each in units of its tolerance for magnitudes between |x0| and |x1|. */
static inline real scaled_square(const real *atol, real rtol, const real *x0, const real *x1, const real *values)
{
    real sum = splat(0);
    for (int i = 0; i < N; i++) {
        const real scale = atol[i] + rtol * larger(abs_of(x0[i]), abs_of(x1[i]));
        const real ratio = values[i] / scale;
        sum += ratio * ratio;
    }
    return sum * (1.0 / N);
}

/* The absolute tolerances for the motion so far, which has come to x: an error grows as the motion does. Of each state they
   follow the peak, up to its tolerance in a motion of the machine's natural scales (full), and at least a thousandth of what
   the largest state has. A fixed one is the user's. size: the largest state's share of its natural scale. */
static inline void follow(const real *full, const real *fixed, real rtol, const real *x, real *size, real *atol)
{
    for (int i = 0; i < N; i++) *size = larger(*size, smaller(rtol * abs_of(x[i]) / full[i], splat(1)));
    for (int i = 0; i < N; i++) {
        const real moving = larger(rtol * abs_of(x[i]), LEAST_SHARE * *size * full[i]);
        atol[i] = larger(larger(atol[i], fixed[i]), smaller(full[i], moving));
    }
}

/* A first step after a start or a jump (Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, II.4). */
static inline real first_step(const real *atol, real rtol, const Parameters *p, const Coefficients *c,
                              const Segment *piece, real t, const real *x, real room)
{
    real zero[N], f0[N], f1[N], x1[N];
    for (int i = 0; i < N; i++) zero[i] = splat(0);
    rates(p, c, piece, t, x, f0);
    const real d0 = sqrt_of(scaled_square(atol, rtol, x, x, x)), d1 = sqrt_of(scaled_square(atol, rtol, x, zero, f0));
    const real h0 = smaller(choose((d0 < 1e-5) | (d1 < 1e-5), splat(1e-6), 0.01 * d0 / d1), room);
    for (int i = 0; i < N; i++) x1[i] = x[i] + h0 * f0[i];
    rates(p, c, piece, t + h0, x1, f1);
    for (int i = 0; i < N; i++) f1[i] -= f0[i];
    const real d = larger(d1, sqrt_of(scaled_square(atol, rtol, x, zero, f1)) / h0);
    const real h1 = choose(d <= 1e-15, larger(splat(1e-6), h0 * 1e-3), pow_of(0.01 / d, splat(0.2)));
    const real h = smaller(smaller(100 * h0, h1), room);
    return choose((h > 0) & (h < 1e300), h, smaller(splat(1e-6), room));
}

/* Coefficients of the dense output x(t + s h) = (1-s) x0 + s (x1 + (1-s) (d0 + s (d1 + s d2))). */
static inline void dense(real k[STAGES][N], int i, real d[3])
{
    UNROLL for (int m = 0; m < 3; m++)
    {
        real sum = splat(0);
        UNROLL for (int s = 0; s < STAGES; s++) sum += DENSE[m][s] * k[s][i];
        d[m] = sum;
    }
}

static inline double interpolate(double s, double x0, double x1, double d0, double d1, double d2)
{
    return (1 - s) * x0 + s * (x1 + (1 - s) * (d0 + s * (d1 + s * d2)));
}

/* Times that differ by less, as a share, are one: k times the period, a breakpoint. */
UNUSED static const double SAME_TIME = 1e-12;

/* A trajectory that so many attempts take no further than this share of its end would need 1e12 of them: it stalls. One
   that goes along the edge of its equations is not finite in so many of them. */
enum { LOOK = 1000000, MOST_WILD = LOOK / 10 };
UNUSED static const double LEAST_WAY = 1e-6;

/* Why a trajectory restarts at a breakpoint with a step of unknown length: the signal jumps, or its slope does; or a
   sampled controller's output does. A long step over a corner would damp the fast motion it sets off, and nothing would
   tell. The first three stand in waveforms/pieces.py too. */
enum { SMOOTH = 0, JUMP = 1, CORNER = 2, OUTPUT = 3 };
static const double CORNER_EASE = 16; /* a corner allows a longer first step than a jump */

#if MAY_WATCH
/* A step that takes a watched quantity past both its thresholds would go over what lies between, such as a narrow Stribeck
   peak, unseen. The share of it after which the first such quantity is 0; 1 if there is none. */
UNUSED static inline real share_to_zero(const real *thresholds, const real *w0, const real *w1)
{
    real share = splat(1);
    for (int j = 0; j < WATCHES; j++) {
        const real limit = thresholds[j];
        const mask over = ((w0[j] > limit) & (w1[j] < -limit)) | ((w0[j] < -limit) & (w1[j] > limit));
        share = choose(over & (limit > 0), smaller(share, w0[j] / (w0[j] - w1[j])), share);
    }
    return share;
}
#endif

/* What the step length is steered by: the squared error of a step to the power -1/10, the error to the power -1/5. */
static inline real steering(real square) { return inverse_tenth_root(larger(square, splat(1e-20))); }

/* Factor for the next step, within [0.2, 5]. */
static inline real growth(real root) { return smaller(splat(5.0), larger(splat(0.2), 0.9 * root)); }

/* The same with the step before in view: errors that grow from step to step go on growing (Gustafsson's control). */
static inline real predictive_growth(real root, real h, real last_root, real last_h)
{
    const real factor = growth(root);
    return smaller(factor, larger(splat(0.2), factor * ((root * h) / (last_root * last_h))));
}

/* The step's root as the next one is to see it: no error counts as less than 1e-2 of the tolerance. */
static inline real remembered(real root) { return smaller(root, splat(2.5118864315095801)); }
