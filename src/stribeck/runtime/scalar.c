/* Numbers and operations for one trajectory. */
typedef double real;
typedef int mask;
UNUSED static inline real splat(double x) { return x; }
UNUSED static inline real choose(mask condition, real a, real b) { return condition ? a : b; }
UNUSED static inline real larger(real a, real b) { return a > b ? a : b; }
UNUSED static inline real smaller(real a, real b) { return a < b ? a : b; }
UNUSED static inline real abs_of(real x) { return fabs(x); }
UNUSED static inline real sign_of(real x) { return (x > 0) - (x < 0); }
UNUSED static inline real sqrt_of(real x) { return sqrt(x); }
UNUSED static inline real log_of(real x) { return log(x); }
UNUSED static inline real sin_of(real x) { return sin(x); }
UNUSED static inline real cos_of(real x) { return cos(x); }
UNUSED static inline real tanh_of(real x) { return tanh(x); }
UNUSED static inline real floor_of(real x) { return floor(x); }
UNUSED static inline real pow_of(real x, real y) { return pow(x, y); }

/* exp, without the slow path of underflow: below -745.2 the result is 0. */
UNUSED static inline real exp_of(real x) { return x < -745.2 ? 0.0 : exp(x); }

/* atan; for |x| >= 32, where a body slips, five terms of the asymptotic series are exact to rounding. */
UNUSED static inline real atan_of(real x)
{
    if (!(fabs(x) >= 32)) return atan(x);
    const double r = 1 / x, q = r * r;
    const double tail = r * (1 - q * (1.0 / 3 - q * (1.0 / 5 - q * (1.0 / 7 - q * (1.0 / 9)))));
    return copysign(1.5707963267948966, x) - tail;
}

/* x^(-1/10), to float precision, which is all that a step length needs. */
static inline real inverse_tenth_root(real x) { return (double)powf((float)x, -0.1f); }
