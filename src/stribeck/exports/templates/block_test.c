{% include "test_head.c" %}

/* The inputs ({{ b.inputs | map(attribute="name") | join(", ") }}) and the state ({{ b.states | map(attribute="name") | join(", ") or "none" }}); then each output
 * ({{ b.outputs | map(attribute="name") | join(", ") }}) and each state afterwards, followed by what its rounding is measured by. */
{% set takes = ["input in"] %}
{% include "test_rows.c" %}
{% for c in b.inputs %}
        in.{{ c.name }} = R(x[{{ loop.index0 }}]);
{% endfor %}
{% set n = b.inputs | length %}
{% for c in b.states %}
        s.{{ c.name }} = R(x[{{ n + loop.index0 }}]);
{% endfor %}
{% set n = n + b.states | length %}
        must("step", {{ P }}_step(&p, &s, &in, &o), {{ P }}_OK);
{% for c in b.outputs %}
        check("{{ c.name }}", (double)o.{{ c.name }}, x[{{ n + 2 * loop.index0 }}], 16 * EPSILON * x[{{ n + 1 + 2 * loop.index0 }}]);
{% endfor %}
{% for c in b.states %}
        check("{{ c.name }}", (double)s.{{ c.name }}, x[{{ n + 2 * (b.outputs | length) + 2 * loop.index0 }}], 16 * EPSILON * x[{{ n + 2 * (b.outputs | length) + 1 + 2 * loop.index0 }}]);
{% endfor %}
    }
    {{ P }}_reset(&s);
{% if path_lines %}
    must("path", {{ P }}_path_at(&p, R(0.25), &in), {{ P }}_OK);
    must("t", {{ P }}_path_at(&p, R(NAN), &in), {{ P }}_NOT_FINITE);
{% endif %}
    must("first", {{ P }}_step(&p, &s, &in, &o), {{ P }}_OK);
    in.{{ b.inputs[-1].name }} = R(INFINITY);
    must("inf", {{ P }}_step(&p, &s, &in, &o), {{ P }}_NOT_FINITE);
    printf(failures ? "%d checks failed\n" : "all checks passed\n", failures);
    return failures != 0;
}
