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
#if !defined(GROUPS)
#define GROUPS (N * LANES > 128 ? 1 : 3) /* vectors that a thread advances in turns, where their numbers stay near */
#endif
typedef double real __attribute__((vector_size(LANES * 8)));
typedef int64_t mask __attribute__((vector_size(LANES * 8)));
UNUSED static inline real splat(double x) { return x - (real){0}; }
/* What GCC does not find by itself, in the processor's own words. */
#if defined(__GNUC__) && !defined(__clang__) && defined(__AVX512F__) && LANES == 8
typedef long long words __attribute__((vector_size(64)));
UNUSED static inline real larger(real a, real b) { return __builtin_ia32_maxpd512_mask(a, b, a, -1, 4); } /* -1: every lane */
UNUSED static inline real smaller(real a, real b) { return __builtin_ia32_minpd512_mask(a, b, a, -1, 4); }
UNUSED static inline unsigned lanes_in(mask m) { return __builtin_ia32_ptestmq512((words)m, (words)m, -1); }
#define CHOOSES_BY_BITS
#elif defined(__GNUC__) && !defined(__clang__) && defined(__AVX2__) && LANES == 4
UNUSED static inline real choose(mask condition, real a, real b) { return __builtin_ia32_blendvpd256(b, a, (real)condition); }
UNUSED static inline real larger(real a, real b) { return __builtin_ia32_maxpd256(a, b); }
UNUSED static inline real smaller(real a, real b) { return __builtin_ia32_minpd256(a, b); }
UNUSED static inline unsigned lanes_in(mask m) { return (unsigned)__builtin_ia32_movmskpd256((real)m); }
#else
#define CHOOSES_BY_BITS
#define COMPARES
#endif
#if defined(CHOOSES_BY_BITS)
UNUSED static inline real choose(mask condition, real a, real b)
{
    return (real)(((mask)a & condition) | ((mask)b & ~condition));
}
#endif
#if defined(COMPARES)
/* b where one of them is no number */
UNUSED static inline real larger(real a, real b) { return choose(a > b, a, b); }
UNUSED static inline real smaller(real a, real b) { return choose(a < b, a, b); }
/* which lanes are in a set: a bit for each */
UNUSED static inline unsigned lanes_in(mask m)
{
    unsigned bits = 0;
    for (int lane = 0; lane < LANES; lane++) bits |= (unsigned)(m[lane] & 1) << lane;
    return bits;
}
#endif
UNUSED static inline int first_lane(unsigned bits) { return __builtin_ctz(bits); }
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

/* exp by x = n log 2 + r, |r| <= log(2)/2, and a polynomial for e^r, which tools/polynomials.py finds: within 2 units in
   the last place for x in [-700, 700] (tests/simulation/test_lanes.py); below -700, where the result is less than 1e-304,
   it is 0. */
UNUSED static inline real exp_of(real x)
{
    const mask vanishes = x < -700;
    x = smaller(splat(700), larger(splat(-700), x));
    const double magic = 6755399441055744.0; /* 1.5 * 2^52: adding it rounds to a whole number */
    const real shifted = x * 1.4426950408889634 + magic, n = shifted - magic;
    const real r = (x - n * 6.93147180369123816490e-01) - n * 1.90821492927058770002e-10;
    const real r2 = r * r, r4 = r2 * r2;
    const real low = (0.5000000000000001 + r * 0.16666666666666669) + r2 * (0.04166666666662413 + r * 0.008333333333330062);
    const real middle = (0.0013888888917213717 + r * 0.00019841269863053618) + r2 * (2.4801521295954376e-05 + r * 2.7557268459997064e-06);
    const real high = 2.7620088445409746e-07 + r * 2.510038549551032e-08;
    const real e = 1 + (r + r2 * (low + r4 * (middle + r4 * high)));
    return choose(vanishes, splat(0), (real)((mask)e + ((mask)shifted << 52)));
}

/* atan by two reductions to |y| <= tan(pi/8), and a polynomial in y^2, which tools/polynomials.py finds: within 2 units in
   the last place (tests/simulation/test_lanes.py). */
UNUSED static inline real atan_of(real x)
{
    const mask sign = (mask)x & INT64_MIN;
    const real a = abs_of(x);
    const mask big = a > 2.41421356237309504880, middle = a > 0.41421356237309504880;
    const real numerator = choose(big, splat(-1), choose(middle, a - 1, a));
    const real denominator = choose(big, a, choose(middle, a + 1, splat(1)));
    const real base = choose(big, splat(1.57079632679489661923), choose(middle, splat(0.78539816339744830962), splat(0)));
    const real y = numerator / denominator, q = y * y, q2 = q * q, q4 = q2 * q2;
    const real low = (-0.3333333333333333 + q * 0.19999999999995516) + q2 * (-0.14285714284665682 + q * 0.11111111015187018);
    const real mid = (-0.0909090457530649 + q * 0.07692183125376892) + q2 * (-0.06664510525508936 + q * 0.05858140904866328);
    const real high = (-0.050854078345894844 + q * 0.03923044778479309) + q2 * -0.019175404711104935;
    const real rest = choose(big, splat(6.123233995736766e-17), choose(middle, splat(3.061616997868383e-17), splat(0)));
    return (real)((mask)(base + (y + (y * (q * (low + q4 * (mid + q4 * high))) + rest))) | sign); /* rest: base's rounding */
}

/* x^(-1/10) for x in [1e-20, 1e300], within 1 percent, which is all that a step length needs: the exponent and a straight
   line for the logarithm of the mantissa; 2^r by a cubic. */
UNUSED static inline real inverse_tenth_root(real x)
{
    const double magic = 6755399441055744.0; /* as in exp_of */
    const double whole = 4503599627370496.0; /* 2^52: the bits of a whole number below it, put into its last ones */
    const real bits = (real)((((mask)x >> 12) & 0xfffffffffffff) | (mask)splat(whole)) - whole;
    const real y = (bits * (1.0 / 1099511627776.0) - 1022.9570) * -0.1;
    const real shifted = y + magic, r = y - (shifted - magic);
    const real e = 1 + r * (0.69314718 + r * (0.24022651 + r * 0.055504109));
    return (real)((mask)e + ((mask)shifted << 52));
}
