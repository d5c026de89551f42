/* Functions from +, -, *, / alone: the same bits wherever numbers round as IEEE 754 says, so that a controller computes
   on its processor what it computed in the simulation. Errors, in units of the last place: 1 for exp, sin and cos (for
   |x| < 1000), 3 for atan, 6 for tanh. */

/* e^x: x = k ln 2 + r with |r| <= ln 2/2, and the series of e^r. */
UNUSED STRICT static double same_exp(double x)
{
    STRICT_BODY
    static const double c[] = { /* 1/n! */
        1.1470745597729725e-11, 1.6059043836821613e-10, 2.08767569878681e-09, 2.505210838544172e-08,
        2.755731922398589e-07, 2.7557319223985893e-06, 2.48015873015873e-05, 0.0001984126984126984,
        0.001388888888888889, 0.008333333333333333, 0.041666666666666664, 0.16666666666666666,
        0.5, 1.0, 1.0,
    };
    double k, r, sum = c[0];
    int n;
    if (!(x > -745.2)) return x <= -745.2 ? 0 : x;
    if (x > 709.8) return HUGE_VAL;
    k = floor(x * 1.4426950408889634 + 0.5);
    r = (x - k * 0.6931471804855391) - k * 7.440617110012397e-11; /* ln 2 in two parts, the first with few bits */
    for (n = 1; n < 15; n++) sum = c[n] + r * sum;
    return ldexp(sum, (int)k);
}

/* tanh x = (e^2x - 1)/(e^2x + 1), with the series of e^2x - 1 where the difference would lose digits. */
UNUSED STRICT static double same_tanh(double x)
{
    STRICT_BODY
    const double size = x < 0 ? -x : x;
    double sum = 1, t;
    int n;
    if (!(size <= 20)) return x != x ? x : x < 0 ? -1 : 1;
    if (size < 0.25) {
        for (n = 16; n > 1; n--) sum = 1 + 2 * x * sum / n;
        t = 2 * x * sum;
        return t / (t + 2);
    }
    t = 1 - 2 / (same_exp(2 * size) + 1);
    return x < 0 ? -t : t;
}

/* atan x: by atan c + atan((x - c)/(1 + c x)) with c = 0, 1/2 or 1, and beyond 1 by pi/2 - atan(1/x). */
UNUSED STRICT static double same_atan(double x)
{
    STRICT_BODY
    const double size = x < 0 ? -x : x, a = size > 1 ? 1 / size : size;
    double base = 0, t = a, sum = 0;
    int n;
    if (x != x) return x;
    if (a > 0.75) base = 0.78539816339744831, t = (a - 1) / (1 + a);
    else if (a > 0.25) base = 0.46364760900080612, t = (a - 0.5) / (1 + 0.5 * a);
    for (n = 27; n > 0; n -= 2) sum = 1.0 / n - t * t * sum;
    sum = base + t * sum;
    if (size > 1) sum = 1.5707963267948966 - (sum - 6.123233995736766e-17);
    return x < 0 ? -sum : sum;
}

/* sin(x + quarter pi/2): x less whole quarters of a turn, and the series. */
UNUSED STRICT static double same_quarter(double x, int quarter)
{
    STRICT_BODY
    const double k = floor(x * 0.63661977236758134 + 0.5);
    const double r = ((x - k * 1.5707963267341256) - k * 6.077100506303966e-11) - k * 2.0222662487959506e-21;
    const int q = (int)(k - 4 * floor(k / 4)) + quarter;
    double sum = 1;
    int n;
    if (q & 1) {
        for (n = 20; n > 0; n -= 2) sum = 1 - r * r * sum / (n * (n - 1));
    } else {
        for (n = 21; n > 1; n -= 2) sum = 1 - r * r * sum / (n * (n - 1));
        sum *= r;
    }
    return q & 2 ? -sum : sum;
}
UNUSED STRICT static double same_sin(double x) { return same_quarter(x, 0); }
UNUSED STRICT static double same_cos(double x) { return same_quarter(x, 1); }
