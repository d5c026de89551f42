/* {{ about[0] }}
 * {{ about[-1] }} The equations and their steps are in {{ P }}.c; here they meet FMI {{ fmi }}.0. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi{{ fmi }}.h"
#include "{{ P }}.c"

#define STATES {{ states | length }}
#define UNUSED(x) (void)(x)
#define FINEST 1e-10 /* tolerance: below it rounding would steer the steps */
#define MOST_ATTEMPTS 300000 /* of one communication step */

/* All that an instance is; nothing else is kept anywhere. */
typedef struct {
    parameters p;
{% if inputs %}
    {{ P }}_load load;
{% endif %}
    double mass, input, x[STATES + 1], time, tolerance, h;
    int initialized;
} Model;

typedef struct {
    double force, rate[STATES + 1];
} Evaluation;

static void start(Model *m)
{
    memset(m, 0, sizeof *m);
    {{ P }}_defaults(&m->p);
    m->mass = {{ repr(mass) }};
    m->input = 0;
{% for name in inputs %}
    m->load.{{ name }} = {{ repr(law.values[name]) }};
{% endfor %}
    m->tolerance = 1e-6;
{% for state in states %}
    m->x[{{ loop.index0 }}] = {{ repr(state.start) }};
{% endfor %}
}

{% if inputs %}
/* The constants with the present load. */
static given at_load(const Model *m) { given g; g.p = m->p; g.load = m->load; return g; }

{% endif %}
static double velocity(const Model *m) { return {{ "m->x[1]" if body else "m->input" }}; }

static double deflection(const Model *m) { {{ "" if law.has_z else "UNUSED(m); " }}return {{ ("m->x[2]" if body else "m->x[0]") if law.has_z else "0" }}; }
{% if body %}

static double acceleration(double mass, double u, double F) { return ({{ net_force.value }}) / mass; }
static double acceleration_by_u(double mass) { return {{ net_force.by_u }} / mass; }
static double acceleration_by_F(double mass) { return {{ net_force.by_F }} / mass; }
{% endif %}

static void evaluate(const Model *m, Evaluation *e)
{
{% if inputs %}
    const given now = at_load(m);
{% endif %}
    const double v = velocity(m), z = deflection(m), dz_dt = rate_of({{ now }}, v, z);
    e->force = force_of({{ now }}, v, z, dz_dt);
{% if body %}
    e->rate[0] = v;
    e->rate[1] = acceleration(m->mass, m->input, e->force);
{% endif %}
{% if law.has_z %}
    e->rate[{{ states | length - 1 }}] = dz_dt;
{% endif %}
}

/* Value of a variable; 0 where there is none of this reference. */
static int get(const Model *m, unsigned reference, double *value)
{
    Evaluation e;
    evaluate(m, &e);
{% include "fmu_values.c" %}

/* d unknown / d known for outputs and derivatives of states by inputs and states; 0 where there is none. */
static int partial(const Model *m, unsigned unknown, unsigned known, double *value)
{
    Slopes l;
{% if inputs %}
    const given now = at_load(m);
{% endif %}
    slopes({{ now }}, velocity(m), deflection(m), &l);
    *value = 0;
{% for unknown, known, c in partials %}
    if (unknown == {{ unknown }} && known == {{ known }}) { *value = {{ c }}; return 1; }
{% endfor %}
    return {% for u in unknowns %}{{ "" if loop.first else " || " }}(unknown == {{ u }}){% endfor %} ? ({% for k in knowns %}{{ "" if loop.first else " || " }}known == {{ k }}{% endfor %}) : 0;
}

/* What is wrong with the input or the constants, or NULL. */
static const char *wrong(const Model *m)
{
    if (!isfinite(m->input){% for name in inputs %} || !isfinite(m->load.{{ name }}){% endfor %}) return "the input is not finite";
{% if body %}
    if (!(m->mass > 0) || !isfinite(m->mass)) return "mass must be a finite number > 0";
{% endif %}
    switch ({{ P }}_check(&m->p)) {
    case {{ P }}_OK: return NULL;
{% for name, (c, value) in constants.items() %}
    case {{ P }}_BAD_{{ name }}: return "{{ name }} must be {{ c.allowed }}{% for key, allowed, condition in relations if key == name %}, and {{ allowed }}{% endfor %}";
{% endfor %}
    default: return "the constants are not allowed";
    }
}

/* The states after a communication step with the input held: NULL, or what went wrong. */
static const char *advance_model(Model *m, double dt)
{
    double F;
    if (!(dt > 0) || !isfinite(dt)) return "the step must be a finite number > 0";
{% if not body %}
    {{ P }}_state s;
    s.z = deflection(m);
    if ({{ P }}_step({{ call.arguments("&m->p", "&m->load") }}, &s, m->input, dt, &F) != {{ P }}_OK) return "the state or the force is not finite";
{% if law.has_z %}
    m->x[0] = s.z;
{% endif %}
{% else %}
    /* the implicit step once, and twice of half the length: their difference steers the length, and is taken out */
{% if inputs %}
    const given now = at_load(m);
{% endif %}
    Model next = *m; /* which is kept when all of the communication step is done */
    double left = dt, h = m->h > 0 ? m->h : dt;
    const double tolerance = m->tolerance > FINEST ? m->tolerance : FINEST;
    for (long attempts = 0; left > 0; ++attempts) {
        {{ P }}_body whole, half;
        double error, scale, factor;
        if (attempts >= MOST_ATTEMPTS) return "the tolerance needs more steps than can be made: take a shorter communication step, or a larger tolerance";
        if (h > left) h = left;
        whole.y = next.x[0]; whole.v = next.x[1]; whole.z = deflection(&next);
        half = whole;
        if ({{ P }}_body_step({{ call.arguments("&m->p", "&m->load") }}, &whole, m->mass, m->input, h, &F) != {{ P }}_OK
            || {{ P }}_body_step({{ call.arguments("&m->p", "&m->load") }}, &half, m->mass, m->input, h / 2, &F) != {{ P }}_OK
            || {{ P }}_body_step({{ call.arguments("&m->p", "&m->load") }}, &half, m->mass, m->input, h / 2, &F) != {{ P }}_OK)
            return "the body's step found no solution: a state is not finite, or the parameters are extreme";
        scale = tolerance * ({{ repr(length) }} + fabs(half.y));
        error = fabs(half.y - whole.y) / scale;
        scale = tolerance * ({{ repr(speed) }} + fabs(half.v));
        if (fabs(half.v - whole.v) / scale > error) error = fabs(half.v - whole.v) / scale;
        scale = tolerance * {{ repr(length) }};
        if (fabs(half.z - whole.z) / scale > error) error = fabs(half.z - whole.z) / scale;
        factor = error > 0 ? 0.9 / sqrt(error) : 4;
        if (error <= 1 || h <= 1e-12 * dt) {
            next.x[0] = 2 * half.y - whole.y;
            next.x[1] = 2 * half.v - whole.v;
{% if law.has_z %}
            next.x[2] = {{ "within(" ~ now ~ ", 2 * half.z - whole.z, next.x[2])" if eq.bounded else "2 * half.z - whole.z" }};
{% endif %}
            left -= h;
        }
        h *= factor > 4 ? 4 : factor < 0.2 ? 0.2 : factor;
        if (h < dt || next.h > 0) next.h = h;
    }
    *m = next;
{% endif %}
    return NULL;
}
