/* What a fit's solvers share: measured numbers between two samples, and how a solution ends. */

enum { DONE = 0, TOO_MANY_STEPS = -1, NOT_FINITE = -2 };

/* A parabola between two samples: its ends, and how far its mean exceeds theirs. */
typedef struct { double first, last, bend; } Arc;

/* Its value at the share s of the time between the samples, and its derivative by s. */
static inline double at(const Arc *a, double s) { return a->first + s * (a->last - a->first + 6 * a->bend * (1 - s)); }
static inline double slope_at(const Arc *a, double s) { return a->last - a->first + 6 * a->bend * (1 - 2 * s); }
