/* Numbers and operations for LANES trajectories at once, each in its own lane of the widest vectors there are. */
#if !defined(LANES)
#if defined(__AVX512F__)
#define LANES 8
#elif defined(__AVX__)
#define LANES 4
#else
#define LANES 2
#endif
#endif
typedef double real __attribute__((vector_size(LANES * 8)));
typedef int64_t mask __attribute__((vector_size(LANES * 8)));
UNUSED static inline real splat(double x) { return x - (real){0}; }
UNUSED static inline real choose(mask condition, real a, real b)
{
    return (real)(((mask)a & condition) | ((mask)b & ~condition));
}
UNUSED static inline int any(mask m)
{
    int64_t all = 0;
    for (int lane = 0; lane < LANES; lane++) all |= m[lane];
    return all != 0;
}
UNUSED static inline real abs_of(real x) { return (real)((mask)x & INT64_MAX); }
UNUSED static inline real sign_of(real x) { return choose(x > 0, splat(1), choose(x < 0, splat(-1), splat(0))); }

/* Operations that laws need rarely, one lane after the other. */
#define BY_LANE(name, function) \
    UNUSED static inline real name(real x) \
    { \
        for (int lane = 0; lane < LANES; lane++) x[lane] = function(x[lane]); \
        return x; \
    }
BY_LANE(sqrt_of, sqrt)
BY_LANE(log_of, log)
BY_LANE(sin_of, sin)
BY_LANE(cos_of, cos)
BY_LANE(tanh_of, tanh)
BY_LANE(floor_of, floor)
UNUSED static inline real pow_of(real x, real y)
{
    for (int lane = 0; lane < LANES; lane++) x[lane] = pow(x[lane], y[lane]);
    return x;
}

/* exp by x = n log 2 + r, |r| <= log(2)/2, and the series of degree 13 for e^r: within 2 units in the last place for
   x in [-700, 700] (tests/simulation/test_lanes.py); below -700, where the result is less than 1e-304, it is 0. */
UNUSED static inline real exp_of(real x)
{
    const mask vanishes = x < -700;
    x = choose(vanishes | (x > 700), splat(700), x);
    const double magic = 6755399441055744.0; /* 1.5 * 2^52: adding it rounds to a whole number */
    const real shifted = x * 1.4426950408889634 + magic, n = shifted - magic;
    const real r = (x - n * 6.93147180369123816490e-01) - n * 1.90821492927058770002e-10;
    const real r2 = r * r, r4 = r2 * r2, r8 = r4 * r4;
    const real low = r2 * (1.0 / 2 + r * (1.0 / 6)) + r4 * ((1.0 / 24 + r * (1.0 / 120)) + r2 * (1.0 / 720 + r * (1.0 / 5040)));
    const real high = (1.0 / 40320 + r * (1.0 / 362880)) + r2 * (1.0 / 3628800 + r * (1.0 / 39916800)) + r4 * (1.0 / 479001600 + r * (1.0 / 6227020800.0));
    const real e = 1 + (r + (low + r8 * high));
    return choose(vanishes, splat(0), (real)((mask)e + ((mask)shifted << 52)));
}

/* atan by the reductions and the rational function of Cephes (S. L. Moshier, Methods and Programs for Mathematical
   Functions, 1989): within 2 units in the last place (tests/simulation/test_lanes.py). */
UNUSED static inline real atan_of(real x)
{
    const mask sign = (mask)x & INT64_MIN;
    const real a = abs_of(x);
    const mask big = a > 2.41421356237309504880, middle = a > 0.66;
    const real numerator = choose(big, splat(-1), choose(middle, a - 1, a));
    const real denominator = choose(big, a, choose(middle, a + 1, splat(1)));
    const real base = choose(big, splat(1.57079632679489661923), choose(middle, splat(0.78539816339744830962), splat(0)));
    const real y = numerator / denominator, q = y * y;
    const real top = (((-8.750608600031904122785e-1 * q - 1.615753718733365076637e1) * q - 7.500855792314704667340e1) * q
                      - 1.228866684490136173410e2) * q - 6.485021904942025371773e1;
    const real bottom = ((((q + 2.485846490142306297962e1) * q + 1.650270098316988542046e2) * q
                          + 4.328810604912902668951e2) * q + 4.853903996359136964868e2) * q + 1.945506571482613964425e2;
    return (real)((mask)(base + (y + y * (q * top / bottom))) | sign);
}

/* x^(-1/10) for x in [1e-20, 1e300], within 1 percent, which is all that a step length needs: the exponent and a straight
   line for the logarithm of the mantissa; 2^r by a cubic. */
UNUSED static inline real inverse_tenth_root(real x)
{
    const double magic = 6755399441055744.0; /* as in exp_of */
    const real y = (__builtin_convertvector((mask)x, real) * (1.0 / 4503599627370496.0) - 1022.9570) * -0.1;
    const real shifted = y + magic, r = y - (shifted - magic);
    const real e = 1 + r * (0.69314718 + r * (0.24022651 + r * 0.055504109));
    return (real)((mask)e + ((mask)shifted << 52));
}
