{% include "test_head.c" %}

/* The path ({{ path | map(attribute="name") | join(", ") }}), what is measured ({{ inputs | map(attribute="name") | join(", ") }}),
 * the state{% if kept %} ({% for c, x in kept %}{{ c.name }}{{ ", " if not loop.last }}{% endfor %}){% else %} (none){% endif %} and dt;
 * then each output ({{ outputs | map(attribute="name") | join(", ") }}) and each state afterwards, followed by what its rounding is
 * measured by. */
{% set takes = ["path path", "measured m"] %}
{% include "test_rows.c" %}
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
