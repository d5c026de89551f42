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
    {{ P }}_input in;
    {{ P }}_output out;
    double x[STATES + 1], time, tolerance;
    int initialised;
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
    switch (reference) {
{% for variable in variables %}
    case {{ variable.reference }}: *value = {{ variable.c }}; return 1; /* {{ variable.name }} */
{% endfor %}
    default: return 0;
    }
}

{% include "fmu_set.c" %}

/* What is wrong with the constants, or NULL. */
static const char *wrong(const Model *m)
{
    switch ({{ P }}_check(&m->p)) {
    case {{ P }}_OK: return NULL;
{% for name, (c, value, path) in b.constants.items() %}
    case {{ P }}_BAD_{{ name }}: return "{{ name }} must be {{ c.allowed }}{% for key, allowed, condition in b.relations if key == name %}, and {{ allowed }}{% endfor %}";
{% endfor %}
    default: return "the constants are not allowed";
    }
}

/* A sample at the begin of the communication step, whose output is held over it: NULL, or what went wrong. */
static const char *advance_model(Model *m, double dt)
{
{% if "period" in b.constants %}
    if (!(dt > 0) || !isfinite(dt)) return "the step must be a finite number > 0";
    m->p.period = dt;
{% else %}
    UNUSED(dt);
{% endif %}
    return {{ P }}_step(&m->p, &m->s, &m->in, &m->out) == {{ P }}_OK ? NULL
        : "an input, the state or the result is not finite";
}
