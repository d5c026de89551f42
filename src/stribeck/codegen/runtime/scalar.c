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

#if defined(__wasm__) /* whose libraries have no fast one; elsewhere libm's is as fast */
/* 2^(j/64) */
static const double POWERS[64] = {
    1.0, 1.0108892860517005, 1.0218971486541166, 1.0330248790212284,
    1.0442737824274138, 1.0556451783605572, 1.0671404006768237, 1.0787607977571199,
    1.0905077326652577, 1.102382583307841, 1.1143867425958924, 1.1265216186082418,
    1.1387886347566916, 1.1511892299529827, 1.1637248587775775, 1.1763969916502812,
    1.189207115002721, 1.202156731452703, 1.215247359980469, 1.22848053610687,
    1.241857812073484, 1.255380757024691, 1.2690509571917332, 1.2828700160787783,
    1.2968395546510096, 1.3109612115247644, 1.3252366431597413, 1.339667524053303,
    1.3542555469368927, 1.3690024229745905, 1.383909881963832, 1.3989796725383112,
    1.4142135623730951, 1.42961333839197, 1.4451808069770467, 1.460917794180647,
    1.4768261459394993, 1.4929077282912648, 1.5091644275934228, 1.5255981507445384,
    1.5422108254079407, 1.559004400237837, 1.5759808451078865, 1.593142151342267,
    1.6104903319492543, 1.6280274218573478, 1.645755478153965, 1.6636765803267364,
    1.681792830507429, 1.7001063537185235, 1.718619298122478, 1.7373338352737062,
    1.7562521603732995, 1.7753764925265212, 1.7947090750031072, 1.8142521755003989,
    1.8340080864093424, 1.8539791250833855, 1.8741676341103, 1.8945759815869656,
    1.9152065613971474, 1.9360617934922943, 1.9571441241754002, 1.978456026387951,
};

/* exp by x = n log(2)/64 + r, |r| <= log(2)/128: a power of 2 from the table, and five terms of the series of e^r - 1:
   within 2 units in the last place. */
UNUSED static inline real exp_of(real x)
{
    if (!(fabs(x) <= 700)) return x < -745.2 ? 0.0 : exp(x);
    const double magic = 6755399441055744.0; /* 1.5 * 2^52: adding it rounds to a whole number */
    const union { double number; int64_t bits; } shifted = {x * 92.33248261689366 + magic};
    const double n = shifted.number - magic, r = (x - n * 0.010830424695996044) - n * 2.5310172166650877e-13, r2 = r * r;
    union { double number; int64_t bits; } power = {POWERS[shifted.bits & 63]};
    power.bits += (int64_t)((uint64_t)(shifted.bits >> 6) << 52);
    const double rest = r + r2 * ((0.5 + r * (1.0 / 6)) + r2 * (1.0 / 24 + r * (1.0 / 120)));
    return power.number + power.number * rest;
}
#else
/* exp, without the slow path of underflow: below -745.2 the result is 0. */
UNUSED static inline real exp_of(real x) { return x < -745.2 ? 0.0 : exp(x); }
#endif

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
