/*
{% for line in about | wrapped %}
 *{{ " " + line if line else "" }}
{% endfor %}
 *
 * Call {{ P }}_step once a sample{% if period %} (every {{ repr(period) }} s){% endif %} with what is asked for and measured then, and put the output out.
 * Double precision computes what Stribeck's simulation computes at its samples, to the bit, where sums stay in the order
 * written and are not fused (-std=c99, or -ffp-contract=off; -ffast-math is refused).
 * One sample takes at most {{ b.operations() }}.
 *
 * Every function returns {{ P }}_OK or an error; on an error nothing that it points to is changed: put the drive
 * where it is safe then. There is no allocation, no input or output, no global state. For single precision compile
 * everything with -D{{ P | upper }}_FLOAT{% if b.states | selectattr("name", "equalto", "last") | list %}; a position then has 24 bits, and the speed is a difference of two{% endif %}.
 */
{% include "real.h" %}

/* Constants; {{ P }}_defaults fills them in, {{ P }}_check tells whether they are allowed. */
typedef struct {
{% for name, (c, value, path) in b.constants.items() %}
    {{ P }}_real {{ name }}; /* {{ (c.unit or "1") | plain }}: {{ c.meaning | plain }}, {{ c.allowed }} ({{ path }}) */
{% endfor %}
} {{ P }}_parameters;

/* What is kept from sample to sample. */
typedef struct {
{% for c in b.states %}
    {{ P }}_real {{ c.name }}; /* {{ c.unit | plain }}: {{ c.meaning | plain }} */
{% else %}
    {{ P }}_real none; /* nothing: it stays 0 */
{% endfor %}
} {{ P }}_state;

/* What a sample is given. */
typedef struct {
{% for c in b.inputs %}
    {{ P }}_real {{ c.name }}; /* {{ c.unit | plain }}: {{ c.meaning | plain }} */
{% endfor %}
} {{ P }}_input;

/* What it computes. */
typedef struct {
{% for c in b.outputs %}
    {{ P }}_real {{ c.name }}; /* {{ c.unit | plain }}: {{ c.meaning | plain }} */
{% endfor %}
} {{ P }}_output;

enum {
    {{ P }}_OK = 0,
    {{ P }}_NOT_FINITE, /* an argument, the state or the result is inf or nan */
{% for name, (c, value, path) in b.constants.items() %}
    {{ P }}_BAD_{{ name }}, /* {{ name }} must be {{ c.allowed }} */
{% endfor %}
};

/* The constants that were exported. */
void {{ P }}_defaults({{ P }}_parameters *p);

/* {{ P }}_OK, or which constant is not allowed. Call it once: the other functions take what they are given. */
int {{ P }}_check(const {{ P }}_parameters *p);

/* The state before the first sample. */
void {{ P }}_reset({{ P }}_state *s);
{% if path_lines %}

/* The file's own signal at the time t (s): {{ b.path_columns | map(attribute="name") | join(", ") }} of the input. */
int {{ P }}_path_at(const {{ P }}_parameters *p, {{ P }}_real t, {{ P }}_input *input);
{% endif %}

/* One sample. */
int {{ P }}_step(const {{ P }}_parameters *p, {{ P }}_state *s, const {{ P }}_input *input, {{ P }}_output *output);

#ifdef __cplusplus
}
#endif
#endif
