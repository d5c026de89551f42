{## An FMU for co-simulation of which a communication step is a sample; ``input``: the type of what it takes. #}
/* {{ about[0] }}
 * {{ about[-1] }} The controller is in {{ P }}.c; here it meets FMI {{ fmi }}.0. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi{{ fmi }}.h"
#include "{{ P }}.c"

#define STATES 0 /* that are continuous */
#define UNUSED(x) (void)(x)

/* All that an instance is; nothing else is kept anywhere. */
typedef struct {
    parameters p;
    {{ P }}_state s;
    {{ P }}_{{ input }} in;
    {{ P }}_output out;
    double x[STATES + 1], time, tolerance;
    int initialized;
} Model;

typedef struct {
    double rate[STATES + 1];
} Evaluation;

static void start(Model *m)
{
    memset(m, 0, sizeof *m);
    {{ P }}_defaults(&m->p);
    {{ P }}_reset(&m->s);
{% for variable in variables if variable.causality == "input" %}
    {{ variable.c }} = {{ repr(variable.start) }};
{% endfor %}
}

/* There is nothing continuous. */
static void evaluate(const Model *m, Evaluation *e)
{
    UNUSED(m);
    e->rate[0] = 0;
}

static int partial(const Model *m, unsigned unknown, unsigned known, double *value)
{
    UNUSED(m); UNUSED(unknown); UNUSED(known);
    *value = 0;
    return 0;
}

/* Value of a variable; 0 where there is none of this reference. */
static int get(const Model *m, unsigned reference, double *value)
{
{% include "fmu_values.c" %}
