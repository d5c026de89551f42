{## Rows of numbers to check by, and the begin of the program that goes through them; ``takes``: what a step takes. #}
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
{% for each in takes %}
    {{ P }}_{{ each }};
{% endfor %}
    {{ P }}_output o;
    {{ P }}_defaults(&p);
    must("check", {{ P }}_check(&p), {{ P }}_OK);
    {{ P }}_reset(&s);
    for (unsigned i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        const double *x = rows[i];
