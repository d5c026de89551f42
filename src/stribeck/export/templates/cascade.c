/* {{ about[0] }}
 * {{ about[-1] }} What it does and how to use it: {{ P }}.h. */
#include "{{ P }}.h"

#include <math.h>

#ifdef __FAST_MATH__
#error "-ffast-math takes nan and inf for impossible: the checks of this file need them"
#endif

{% include "real.c" %}
{% if cascade.uses("sign") %}

static real sign_of(real x) { return R((x > 0) - (x < 0)); }
{% endif %}
{% if kept %}

{% include "phi_1.c" %}
{% endif %}

/* ---- the equations ---- */

/* The output, and the rates of the states with their slopes d rate/d state. */
static void control(const parameters *p, const {{ P }}_state *x, const {{ P }}_path *d,
    const {{ P }}_measured *m, {{ P }}_output *o{% if kept %}, real *rate, real *slope{% endif %})
{
{% if not kept %}
    (void)x;
{% endif %}
{{ cascade.lines("sample") }}
}
{% if cascade.pieces %}

/* The path piece by piece: from start on, a polynomial in t - start. */
static const struct {
    real {% for name in cascade.pieces[0] %}{{ name }}{{ ", " if not loop.last }}{% endfor %};
} pieces[] = {
{% for piece in cascade.pieces %}
    { {% for x in piece.values() %}R({{ repr(x) }}){{ ", " if not loop.last }}{% endfor %} },
{% endfor %}
};
{% endif %}

static void path_of(const parameters *p, real t, {{ P }}_path *d)
{
{% if cascade.pieces %}
    unsigned i = {{ cascade.pieces | length - 1 }};
    while (i > 0 && t < pieces[i].start) --i;
    (void)p;
{{ cascade.lines("path") }}
{% else %}
{{ cascade.lines("path") }}
{% endif %}
}

/* ---- what the header declares ---- */

void {{ P }}_defaults(parameters *p)
{
{% for group, constants in cascade.constants.items() %}
{% for name, (c, value) in constants.items() %}
    p->{{ group }}.{{ name }} = R({{ repr(value) }}); /* {{ (c.unit or "1") | plain }} */
{% endfor %}
{% endfor %}
}

int {{ P }}_check(const parameters *p)
{
{% for group, constants in cascade.constants.items() %}
{% for name, (c, value) in constants.items() %}
{% set at = "p->" + group + "." + name %}
    if (!isfinite({{ at }}){% if c.above is not none %} || !({{ at }} > R({{ repr(c.above + 0.0) }})){% elif c.at_least is not none %} || !({{ at }} >= R({{ repr(c.at_least + 0.0) }})){% endif %}) return {{ P }}_BAD_{{ group }}_{{ name }};
{% endfor %}
{% endfor %}
{% for key, allowed, condition in cascade.relations %}
    if (!({{ condition }})) return {{ P }}_BAD_{{ key }}; /* must be {{ allowed }} */
{% endfor %}
    return {{ P }}_OK;
}

void {{ P }}_reset({{ P }}_state *s)
{
{% for column, start in kept %}
    s->{{ column.name }} = {{ "%g" | format(start) }};
{% else %}
    s->{{ unused.name }} = 0;
{% endfor %}
}

static int finite_path(const {{ P }}_path *d)
{
    return {% for c in path %}isfinite(d->{{ c.name }}){{ " && " if not loop.last }}{% endfor %};
}

static int finite_state(const {{ P }}_state *x)
{
    return {% for c, start in kept or [(unused, 0)] %}isfinite(x->{{ c.name }}){{ " && " if not loop.last }}{% endfor %};
}

int {{ P }}_path_at(const parameters *p, real t, {{ P }}_path *path)
{
    {{ P }}_path d;
    if (!isfinite(t)) return {{ P }}_NOT_FINITE;
    path_of(p, t, &d);
    if (!finite_path(&d)) return {{ P }}_NOT_FINITE;
    *path = d;
    return {{ P }}_OK;
}

int {{ P }}_track(const parameters *p, {{ P }}_state *s, const {{ P }}_path *path, const {{ P }}_measured *m, real dt,
    {{ P }}_output *output)
{
    {{ P }}_output o;
    {{ P }}_state next = *s;
{% if kept %}
    real rate[{{ kept | length }}], slope[{{ kept | length }}];
{% endif %}
    if (!(dt > 0) || !isfinite(dt)) return {{ P }}_BAD_STEP;
    if (!finite_path(path) || !finite_state(s)) return {{ P }}_NOT_FINITE;
    if ({% for c in inputs %}!isfinite(m->{{ c.name }}){{ " || " if not loop.last }}{% endfor %}) return {{ P }}_NOT_FINITE;
    control(p, s, path, m, &o{% if kept %}, rate, slope{% endif %});
{% for c, start in kept %}
    next.{{ c.name }} += dt * phi_1(slope[{{ loop.index0 }}] * dt) * rate[{{ loop.index0 }}];
{% endfor %}
    if ({% for c in outputs %}!isfinite(o.{{ c.name }}) || {% endfor %}!finite_state(&next)) return {{ P }}_NOT_FINITE;
    *s = next;
    *output = o;
    return {{ P }}_OK;
}

int {{ P }}_step(const parameters *p, {{ P }}_state *s, real t, const {{ P }}_measured *m, real dt, {{ P }}_output *output)
{
    {{ P }}_path d;
    const int status = {{ P }}_path_at(p, t, &d);
    return status == {{ P }}_OK ? {{ P }}_track(p, s, &d, m, dt, output) : status;
}
