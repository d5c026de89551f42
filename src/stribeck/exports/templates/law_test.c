{% include "test_head.c" %}

/* v, z, dz/dt, the sum of its absolute terms, F, the sum of its absolute terms, steady force */
static const double points[][7] = {
{% for row in cases.points %}
    { {{ row | join(", ") }} },
{% endfor %}
};
{% if law.has_z %}

/* v, z, dt, z after dt, the size of z */
static const double steps[][5] = {
{% for row in cases.steps %}
    { {{ row | join(", ") }} },
{% endfor %}
};
{% endif %}

{% include "checks.c" %}

int main(void)
{
    {{ P }}_parameters p;
    {{ P }}_state s;
    real x = 0;
{% if inputs %}
    const {{ P }}_load load = { {% for x in cases.load[0] %}{{ "" if loop.first else ", " }}R({{ x }}){% endfor %} };
{% endif %}
    {{ P }}_defaults(&p);
    must("check", {{ P }}_check(&p), {{ P }}_OK);
    for (unsigned i = 0; i < sizeof points / sizeof points[0]; ++i) {
        const double *row = points[i];
        must("rate", {{ P }}_rate({{ call.arguments("&p", "&load") }}, R(row[0]), R(row[1]), &x), {{ P }}_OK);
        check("rate", (double)x, row[2], 4 * EPSILON * row[3]);
        must("force", {{ P }}_force({{ call.arguments("&p", "&load") }}, R(row[0]), R(row[1]), &x), {{ P }}_OK);
        check("force", (double)x, row[4], 4 * EPSILON * row[5]);
        must("steady force", {{ P }}_steady_force({{ call.arguments("&p", "&load") }}, R(row[0]), &x), {{ P }}_OK);
        check("steady force", (double)x, row[6], 64 * EPSILON * fabs(row[6]));
    }
{% if law.has_z %}
    for (unsigned i = 0; i < sizeof steps / sizeof steps[0]; ++i) {
        const double *row = steps[i];
        s.z = R(row[1]);
        must("step", {{ P }}_step({{ call.arguments("&p", "&load") }}, &s, R(row[0]), R(row[2]), &x), {{ P }}_OK);
        check("step", (double)s.z, row[3], {{ "1e3 * EPSILON" if eq.linear else "2e-3" }} * row[4]);
    }
{% endif %}
    {{ P }}_reset(&s);
    must("nan", {{ P }}_step({{ call.arguments("&p", "&load") }}, &s, R(NAN), R(1e-3), &x), {{ P }}_NOT_FINITE);
    must("inf", {{ P }}_force({{ call.arguments("&p", "&load") }}, R(INFINITY), R(0), &x), {{ P }}_NOT_FINITE);
    must("dt", {{ P }}_step({{ call.arguments("&p", "&load") }}, &s, R(0), R(0), &x), {{ P }}_BAD_STEP);
{% if with_body %}
    {
        /* held at rest by less than friction can bear, the body must not run away, whatever the step */
        {{ P }}_body body = { R(0), R(0), R(0) };
        must("mass", {{ P }}_body_step({{ call.arguments("&p", "&load") }}, &body, R(0), R(0), R(1e-3), &x), {{ P }}_BAD_MASS);
        for (int i = 0; i < 100; ++i) {
            const real v = body.v;
            must("body step", {{ P }}_body_step({{ call.arguments("&p", "&load") }}, &body, R(1), R(0.1), R(1e-3), &x), {{ P }}_OK);
            check("force balance", (double)((body.v - v) / R(1e-3) + x), 0.1, 1e3 * EPSILON * (fabs((double)body.v) / 1e-3 + 1));
        }
    }
{% endif %}
    printf(failures ? "%d checks failed\n" : "all checks passed\n", failures);
    return failures != 0;
}
