/* Checks {{ P }}.c against values computed by stribeck: exit status 0 when all agree.
 * cc -std=c99 {{ P }}.c {{ P }}_test.c -lm && ./a.out */
#include <math.h>
#include <stdio.h>

#include "{{ P }}.h"

typedef {{ P }}_real real;
#define R(x) ((real)(x))
#ifdef {{ P | upper }}_FLOAT
#define EPSILON 1.1920929e-7
#else
#define EPSILON 2.220446049250313e-16
#endif

/* The path ({{ path | map(attribute="name") | join(", ") }}), what is measured ({{ inputs | map(attribute="name") | join(", ") }}),
 * the state{% if kept %} ({% for c, x in kept %}{{ c.name }}{{ ", " if not loop.last }}{% endfor %}){% else %} (none){% endif %} and dt;
 * then each output ({{ outputs | map(attribute="name") | join(", ") }}) and each state afterwards, followed by what its rounding is
 * measured by. */
static const double rows[][{{ rows[0] | length }}] = {
{% for row in rows %}
    { {{ row | join(", ") }} },
{% endfor %}
};

{% include "checks.c" %}

int main(void)
{
    {{ P }}_parameters p;
    {{ P }}_state s;
    {{ P }}_path path;
    {{ P }}_measured m;
    {{ P }}_output o;
    {{ P }}_defaults(&p);
    must("check", {{ P }}_check(&p), {{ P }}_OK);
    {{ P }}_reset(&s);
    for (unsigned i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        const double *x = rows[i];
{% for c in path %}
        path.{{ c.name }} = R(x[{{ loop.index0 }}]);
{% endfor %}
{% for c in inputs %}
        m.{{ c.name }} = R(x[{{ loop.index0 + 4 }}]);
{% endfor %}
{% for c, start in kept %}
        s.{{ c.name }} = R(x[{{ loop.index0 + 9 }}]);
{% endfor %}
{% set n = 9 + kept | length %}
        must("track", {{ P }}_track(&p, &s, &path, &m, R(x[{{ n }}]), &o), {{ P }}_OK);
{% for c in outputs %}
        check("{{ c.name }}", (double)o.{{ c.name }}, x[{{ n + 1 + 2 * loop.index0 }}], 4 * EPSILON * x[{{ n + 2 + 2 * loop.index0 }}]);
{% endfor %}
{% for c, start in kept %}
        check("{{ c.name }}", (double)s.{{ c.name }}, x[{{ n + 11 + 2 * loop.index0 }}], 4 * EPSILON * x[{{ n + 12 + 2 * loop.index0 }}]);
{% endfor %}
    }
    {{ P }}_reset(&s);
    must("on the path", {{ P }}_step(&p, &s, R(0), &m, R(1e-3), &o), {{ P }}_OK);
    must("t", {{ P }}_step(&p, &s, R(NAN), &m, R(1e-3), &o), {{ P }}_NOT_FINITE);
    must("dt", {{ P }}_step(&p, &s, R(0), &m, R(0), &o), {{ P }}_BAD_STEP);
    m.p_1 = R(INFINITY);
    must("p_1", {{ P }}_step(&p, &s, R(0), &m, R(1e-3), &o), {{ P }}_NOT_FINITE);
    printf(failures ? "%d checks failed\n" : "all checks passed\n", failures);
    return failures != 0;
}
