{% set input = "measured" %}
{% include "fmu_sampled.c" %}

/* What is wrong with the constants, or NULL. */
static const char *wrong(const Model *m)
{
    switch ({{ P }}_check(&m->p)) {
    case {{ P }}_OK: return NULL;
{% for group, constants in cascade.constants.items() %}
{% for name, (c, value) in constants.items() %}
    case {{ P }}_BAD_{{ group }}_{{ name }}: return "{{ group }}.{{ name }} must be {{ c.allowed }}{% for key, allowed, condition in cascade.relations if key == group + "_" + name %}, and {{ allowed }}{% endfor %}";
{% endfor %}
{% endfor %}
    default: return "the constants are not allowed";
    }
}

/* A sample at the begin of the communication step, whose voltage is held over it: NULL, or what went wrong. */
static const char *advance_model(Model *m, double dt)
{
    switch ({{ P }}_step(&m->p, &m->s, m->time, &m->in, dt, &m->out)) {
    case {{ P }}_OK: return NULL;
    case {{ P }}_BAD_STEP: return "the step must be a finite number > 0";
    default: return "a measurement, the state or the result is not finite";
    }
}
