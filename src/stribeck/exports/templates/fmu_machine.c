/* {{ about[0] }}
 * {{ about[-1] }} The machine is in {{ P }}.c; here it meets FMI {{ fmi }}.0. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi{{ fmi }}.h"
#include "{{ P }}.c"

#undef UNUSED
#define UNUSED(x) (void)(x)
#define STATES {{ P | upper }}_STATES

/* All that an instance is; nothing else is kept anywhere. */
typedef struct {
    {{ P }}_machine s;
    double o[{{ P | upper }}_COLUMNS], rate[STATES], time, tolerance;
    int initialized, known; /* known: o and rate are of the present state */
} Model;

typedef struct {
    double rate[STATES];
} Evaluation;

static void start(Model *m)
{
    memset(m, 0, sizeof *m);
    {{ P }}_start(&m->s);
}

/* Model exchange: the importer integrates the states, and stops where something happens. */
#define X(m) ((m)->s.x)
#define TOUCHED(m) ((m)->known = 0, {{ P }}_at(&(m)->s, (m)->time))

static void evaluate(const Model *m, Evaluation *e) { {{ P }}_rates(&m->s, e->rate); }

/* What happens now; when something happens next. Whether a state changed. */
static int update(Model *m, double *next)
{
    double before[STATES];
    memcpy(before, m->s.x, sizeof before);
    m->known = 0;
    *next = {{ P }}_happen(&m->s, m->time);
    return memcmp(before, m->s.x, sizeof before) != 0;
}

static int partial(const Model *m, unsigned unknown, unsigned known, double *value)
{
    UNUSED(m); UNUSED(unknown); UNUSED(known); /* the description promises none */
    *value = 0;
    return 0;
}

/* Value of a variable; 0 where there is none of this reference. */
static int get(Model *m, unsigned reference, double *value)
{
    if (!m->known) {
        {{ P }}_columns(&m->s, m->o);
        {{ P }}_rates(&m->s, m->rate);
    }
    m->known = 1;
{% include "fmu_values.c" %}

#define set(m, reference, value) ((m)->known = 0, set(m, reference, value))

/* What is wrong with the constants, or NULL. */
static const char *wrong(const Model *m) { return {{ P }}_wrong(&m->s); }

/* The machine goes on by dt: NULL, or what went wrong. */
static const char *advance_model(Model *m, double dt)
{
    const double now = {{ P }}_time(&m->s);
    if (!(dt > 0) || !isfinite(dt)) return "the step must be a finite number > 0";
    if (fabs(m->time - now) > 1e-9 * (fabs(now) + dt)) return "communication points must follow each other, from t = 0 on";
    if (m->tolerance > 0) {{ P }}_tolerance(&m->s, m->tolerance);
    m->known = 0;
    switch ({{ P }}_advance(&m->s, m->time + dt)) {
    case {{ P | upper }}_DONE: return NULL;
    case {{ P | upper }}_MORE: return "the tolerance needs more steps than can be made";
    case {{ P | upper }}_STEP_TOO_SMALL: return "the step that the tolerance needs is below what floating point resolves";
    case {{ P | upper }}_STALLED: return "the steps that the tolerance needs became so short that the end is 1e12 of them away";
    default: return "the state or the result is not finite";
    }
}
