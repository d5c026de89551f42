/* {{ about[0] }}
 * {{ about[-1] }} What it does and how to use it: {{ P }}.h. */
#include "{{ P }}.h"

#include <math.h>

#ifdef __FAST_MATH__
#error "-ffast-math takes nan and inf for impossible: the checks of this file need them"
#endif

{% include "real.c" %}
{% if sign %}

static real sign_of(real x) { return R((x > 0) - (x < 0)); }
{% endif %}
{% if portable %}

#ifdef {{ P | upper }}_FLOAT
#define same_exp expf
#define same_tanh tanhf
#define same_atan atanf
#define same_sin sinf
#define same_cos cosf
#else
#if defined(__GNUC__)
#define UNUSED __attribute__((unused))
#else
#define UNUSED
#endif
#define STRICT
#define STRICT_BODY
{{ portable }}#endif
{% endif %}

/* ---- the equations ---- */

/* The output, and what is kept for the next sample. */
static void sample(const parameters *p, const {{ P }}_state *x, const {{ P }}_input *in, {{ P }}_output *o, {{ P }}_state *next)
{
{% if not b.states %}
    (void)x;
    (void)next;
{% endif %}
{{ step_lines }}
}
{% if path_lines %}
{% if b.pieces %}

/* The signal piece by piece: from begin on. */
static const struct {
    real begin{% for name in b.piece_fields %}, {{ name }}{% endfor %};
} pieces[] = {
{% for piece in b.pieces %}
    { {% for x in piece %}R({{ repr(x) }}){{ ", " if not loop.last }}{% endfor %} },
{% endfor %}
};
{% endif %}

static void path_of(const parameters *p, real t, {{ P }}_input *in)
{
{% if b.pieces %}
    unsigned i = {{ b.pieces | length - 1 }};
    while (i > 0 && t * (1 + R(1e-12)) < pieces[i].begin) --i;
    (void)p;
{% endif %}
{{ path_lines }}
}
{% endif %}

/* ---- what the header declares ---- */

void {{ P }}_defaults(parameters *p)
{
{% for name, (c, value, path) in b.constants.items() %}
    p->{{ name }} = R({{ repr(value) }}); /* {{ (c.unit or "1") | plain }} */
{% endfor %}
}

int {{ P }}_check(const parameters *p)
{
{% for name, (c, value, path) in b.constants.items() %}
    if (!isfinite(p->{{ name }}){% if c.above is not none %} || !(p->{{ name }} > R({{ repr(c.above + 0.0) }})){% elif c.at_least is not none %} || !(p->{{ name }} >= R({{ repr(c.at_least + 0.0) }})){% endif %}) return {{ P }}_BAD_{{ name }};
{% endfor %}
{% for key, allowed, condition in b.relations %}
    if (!({{ condition }})) return {{ P }}_BAD_{{ key }}; /* must be {{ allowed }} */
{% endfor %}
    return {{ P }}_OK;
}

void {{ P }}_reset({{ P }}_state *s)
{
{% for c in b.states %}
    s->{{ c.name }} = 0;
{% else %}
    s->none = 0;
{% endfor %}
}

static int finite_state(const {{ P }}_state *x)
{
    return {% for c in b.states %}isfinite(x->{{ c.name }}){{ " && " if not loop.last }}{% else %}x->none == 0{% endfor %};
}
{% if path_lines %}

int {{ P }}_path_at(const parameters *p, real t, {{ P }}_input *input)
{
    {{ P }}_input in = *input;
    if (!isfinite(t)) return {{ P }}_NOT_FINITE;
    path_of(p, t, &in);
    if ({% for c in b.path_columns %}!isfinite(in.{{ c.name }}){{ " || " if not loop.last }}{% endfor %}) return {{ P }}_NOT_FINITE;
    *input = in;
    return {{ P }}_OK;
}
{% endif %}

int {{ P }}_step(const parameters *p, {{ P }}_state *s, const {{ P }}_input *input, {{ P }}_output *output)
{
    {{ P }}_output o;
    {{ P }}_state next = *s;
    if ({% for c in b.inputs %}!isfinite(input->{{ c.name }}) || {% endfor %}!finite_state(s)) return {{ P }}_NOT_FINITE;
    sample(p, s, input, &o, &next);
    if ({% for c in b.outputs %}!isfinite(o.{{ c.name }}) || {% endfor %}!finite_state(&next)) return {{ P }}_NOT_FINITE;
    *s = next;
    *output = o;
    return {{ P }}_OK;
}
