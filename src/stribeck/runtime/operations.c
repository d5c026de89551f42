/* Operations of the equations that math.h lacks, or that need not wait for it. */
#if defined(__GNUC__)
#define UNUSED __attribute__((unused))
#else
#define UNUSED
#endif
UNUSED static inline double sign_of(double x) { return (x > 0) - (x < 0); }

/* exp, without the slow path of underflow: below -745.2 the result is 0. */
UNUSED static inline double exp_of(double x) { return x < -745.2 ? 0.0 : exp(x); }

/* atan; for |x| >= 32, where a body slips, five terms of the asymptotic series are exact to rounding. */
UNUSED static inline double atan_of(double x)
{
    if (!(fabs(x) >= 32)) return atan(x);
    const double r = 1 / x, q = r * r;
    const double tail = r * (1 - q * (1.0 / 3 - q * (1.0 / 5 - q * (1.0 / 7 - q * (1.0 / 9)))));
    return copysign(1.5707963267948966, x) - tail;
}
