{% set input = "input" %}
{% include "fmu_sampled.c" %}

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
