/* ---- Events: where a watched quantity passes its threshold within a step. --------------------------------------------- */

enum { MOST_EVENTS = 16 }; /* of one step */

#if MAY_WATCH
/* Where in (s0, s1] the quartic with these Bernstein coefficients, of which one change of sign, passes through zero:
   Newton's method, and bisection where that leaves the interval. */
static double only_root(const double b[5], double s0, double s1)
{
    const int rises = b[4] >= 0;
    double low = 0, high = 1, u = b[0] / (b[0] - b[4]);
    for (int i = 1; (high - low) * (s1 - s0) >= 1e-14; i++) {
        double w[5];
        for (int q = 0; q < 5; q++) w[q] = b[q];
        for (int row = 1; row < 4; row++)
            for (int q = 0; q < 5 - row; q++) w[q] += u * (w[q + 1] - w[q]);
        const double value = w[0] + u * (w[1] - w[0]), next = u - value / (4 * (w[1] - w[0]));
        if ((value >= 0) == rises)
            high = u;
        else
            low = u;
        if (fabs(next - u) * (s1 - s0) < 1e-15) return s0 + u * (s1 - s0); /* as near as rounding lets it be */
        u = next > low && next < high && i % 4 ? next : 0.5 * (low + high); /* a triple root is not halved by Newton */
    }
    return s0 + high * (s1 - s0);
}

/* Find every s in (s0, s1] where the quartic with Bernstein coefficients b passes through zero, in order; b's first and
   last values lie at s0 and s1. A polynomial stays between its coefficients, so an interval without a change of sign
   among them holds no root, and one with a single change holds exactly one (Descartes). Without ``found``, where they
   are is not asked. */
static int crossings(const double b[5], double noise, double s0, double s1, int depth, double *found, int8_t *rises,
                     int count)
{
    int changes = 0, flat = 1;
    for (int i = 0; i < 4; i++) changes += (b[i] >= 0) != (b[i + 1] >= 0);
    for (int i = 0; i < 5; i++) flat &= fabs(b[i]) <= noise; /* rounding has signs of its own */
    if (changes == 0 || count >= MOST_EVENTS / 2) return count;
    if (changes == 1 || flat || depth > 50) {
        if ((b[0] >= 0) != (b[4] >= 0)) {
            if (found) found[count] = flat || changes > 1 ? s1 : only_root(b, s0, s1);
            rises[count++] = b[4] >= 0;
        }
        return count;
    }
    double left[5], right[5], w[5];
    for (int i = 0; i < 5; i++) w[i] = b[i];
    for (int row = 0; row < 5; row++) { /* de Casteljau at the middle */
        left[row] = w[0];
        right[4 - row] = w[4 - row];
        for (int i = 0; i < 4 - row; i++) w[i] = 0.5 * (w[i] + w[i + 1]);
    }
    const double middle = 0.5 * (s0 + s1);
    count = crossings(left, noise, s0, middle, depth + 1, found, rises, count);
    return crossings(right, noise, middle, s1, depth + 1, found, rises, count);
}

/* What happened: bit 0 tells whether the magnitude fell, bit 1 whether the value was at -threshold. */
enum { FELL = 1, AT_MINUS = 2 };

/* The Bernstein coefficients of a quartic from its ends and the coefficients of its dense output. */
static inline void bernstein_of_dense(double v0, double v1, double d0, double d1, double d2, double b[5])
{
    b[0] = v0;
    b[1] = v0 + 0.25 * (v1 - v0) + 0.25 * d0;
    b[2] = 0.5 * (v0 + v1) + d0 / 3 + d1 / 6;
    b[3] = v0 + 0.75 * (v1 - v0) + 0.25 * (d0 + d1 + d2);
    b[4] = v1;
}

/* The same of the quartic through five values at equal distances. */
UNUSED static inline void bernstein_of_values(const double f[5], double b[5])
{
    b[0] = f[0];
    b[1] = (-13 * f[0] + 48 * f[1] - 36 * f[2] + 16 * f[3] - 3 * f[4]) / 12;
    b[2] = (13 * f[0] - 64 * f[1] + 120 * f[2] - 64 * f[3] + 13 * f[4]) / 18;
    b[3] = (-3 * f[0] + 16 * f[1] - 36 * f[2] + 48 * f[3] - 13 * f[4]) / 12;
    b[4] = f[4];
}

/* Where a quartic passes +threshold and -threshold, as shares of the step in order, and what happens there; how many.
   Without ``s``, only what happens, in no order. */
static int events_within(double threshold, const double b[5], double *s, int8_t *what)
{
    double lowest = b[0], highest = b[0], largest = threshold, shifted[5];
    for (int i = 0; i < 5; i++) {
        lowest = b[i] < lowest ? b[i] : lowest;
        highest = b[i] > highest ? b[i] : highest;
        largest = fabs(b[i]) > largest ? fabs(b[i]) : largest;
    }
    const double noise = 1e-14 * largest;
    if (!(highest - lowest < 1e100)) return 0; /* a trajectory that is about to fail */
    if ((lowest > -threshold && highest < threshold) || lowest >= threshold || highest <= -threshold) return 0;
    for (int i = 0; i < 5; i++) shifted[i] = b[i] - threshold;
    int count = crossings(shifted, noise, 0, 1, 0, s, what, 0);
    const int upper = count;
    for (int i = 0; i < 5; i++) shifted[i] = -b[i] - threshold;
    count += crossings(shifted, noise, 0, 1, 0, s ? s + upper : s, what + upper, 0);
    for (int i = 0; i < count; i++) what[i] = (int8_t)((i < upper ? 0 : AT_MINUS) | !what[i]);
    for (int i = 1; s && i < count; i++) { /* two sorted lists into one */
        const double si = s[i];
        const int8_t wi = what[i];
        int at = i;
        for (; at > 0 && s[at - 1] > si; at--) {
            s[at] = s[at - 1];
            what[at] = what[at - 1];
        }
        s[at] = si;
        what[at] = wi;
    }
    return count;
}
#endif
